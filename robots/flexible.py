"""Links that are superelements: where they stand, and their joints at interfaces."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from .. import superelement
from ..files.arrays import Array
from ..superelement import Superelement
from .bodies import ModelBody
from .description import Joint, Robot
from .document import tidy
from .errors import RobotError
from .options import FlexibleLink
from .poses import Pose
from .tree import Tree

# Of a superelement and its link, relative: beyond it both are told.
MAX_MASS_DIFFERENCE = 0.05
# Of an interface from its joint, relative to the superelement: that of meshes, not of mistakes.
MAX_JOINT_DISTANCE = 0.01


def flexible_body(
    robot: Robot,
    tree: Tree,
    links: Sequence[str],
    given: FlexibleLink,
    joints: Sequence[Joint],
    name: str,
) -> ModelBody:
    """A superelement in place of a link, with its axes those of the link.

    joints: all that end at the link. `RobotError` for joints without an interface, and for
    interfaces that are not where their joints are.
    """
    link = links[0]

    def error(message: str) -> RobotError:
        return RobotError(f"{robot.path}: flexible link {link!r}: {message}")

    try:
        element = superelement.read(given.file, recovery=False)
    except superelement.SuperelementError as failure:
        raise error(str(failure)) from failure
    places = _places(element, given, joints, error)
    axes = tree.pose[link]
    anchors = {joint.name: anchor(tree, joint) for joint in joints}
    first = joints[0].name
    # The axes are those of the link, so one interface on its joint fixes the center of mass.
    pose = Pose(axes.R, anchors[first] - axes.R @ places[first])
    size = max(float(np.linalg.norm(place)) for place in places.values())
    for joint, place in places.items():
        off = float(np.linalg.norm(pose.of(place) - anchors[joint]))
        if off > MAX_JOINT_DISTANCE * size:
            expected = _listed(axes.seen(anchors[joint]), size)
            found = _listed(axes.seen(pose.of(place)), size)
            raise error(
                f"interface {given.interfaces[joint]!r}: expected at joint {joint!r}, {expected} m "
                f"in the axes of the link, found at {found} m with {given.interfaces[first]!r} at "
                f"joint {first!r}: draw the mesh in these axes"
            )
    return ModelBody(name, pose, links, superelement=element, file=given.file)


def anchor(tree: Tree, joint: Joint) -> Array:
    """A point of the axis of a joint, in space."""
    return tree.pose[joint.child].of(joint.anchor)


def mass_difference(robot: Robot, body: ModelBody) -> str:
    """How the mass of a superelement differs from that of its links, "" where it does not."""
    expected = sum(robot.links[link].mass for link in body.links)
    if abs(body.mass - expected) <= MAX_MASS_DIFFERENCE * expected:
        return ""
    return (
        f"flexible link {body.links[0]!r}: its superelement has {body.mass:.6g} kg, "
        f"the link {expected:.6g} kg"
    )


def _places(
    element: Superelement,
    given: FlexibleLink,
    joints: Sequence[Joint],
    error: Callable[[str], RobotError],
) -> Mapping[str, Array]:
    """Where the interface of each joint is, from the center of mass, in body axes."""
    interfaces = {each.name: each.X for each in element.interfaces}
    known = [joint.name for joint in joints]
    if unknown := [name for name in given.interfaces if name not in known]:
        raise error(f"no joint {unknown[0]!r}; there are: {', '.join(known) or 'none'}")
    if missing := [name for name in known if name not in given.interfaces]:
        raise error(f"expected an interface of each joint, {missing[0]}=NAME, found none")
    for joint, name in given.interfaces.items():
        if name not in interfaces:
            has = ", ".join(interfaces) or "none"
            raise error(f"joint {joint!r}: {given.file} has no interface {name!r}; it has: {has}")
    if not joints:
        raise error("no joint ends at it")
    return {joint: interfaces[name] for joint, name in given.interfaces.items()}


def _listed(values: Array, size: float) -> str:
    # Rotations leave 1e-17 of a zero, which nobody needs to read.
    return f"[{', '.join(f'{value:.6g}' for value in tidy(values, 10.0 * size))}]"
