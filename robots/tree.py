"""The tree of a robot: its root, the poses of its links, and which links are one body."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from .description import Joint, Robot
from .errors import RobotError
from .poses import AT_ORIGIN, Pose, by_rotation_vector

ON_GROUND = ""
"""what the links of a fixed base belong to; no link has this name, as one may have "ground\""""


@dataclass(frozen=True)
class Tree:
    """The links of a robot from its root outwards.

    incoming: the joint to the parent of each link but the root, in an order in which parents come
    first; pose: of each link in space, at the start.
    """

    root: str
    incoming: Mapping[str, Joint]
    pose: Mapping[str, Pose]

    @property
    def links(self) -> Sequence[str]:
        return (self.root, *self.incoming)

    def beyond(self, link: str) -> list[str]:
        """A link and all that hang on it."""
        found = {link: None}
        for child, joint in self.incoming.items():
            if joint.parent in found:
                found[child] = None
        return list(found)


def tree_of(robot: Robot, starts: Mapping[str, float]) -> Tree:
    """The tree of a robot; `RobotError` names links that are in none.

    starts: coordinates by joint [rad, m]; others are at their references.
    """
    incoming = _incoming(robot)
    roots = [link for link in robot.links if link not in incoming]
    if len(roots) > 1:
        raise _error(robot, f"expected one root link, found {_names(roots)}")
    if not roots:
        raise _error(robot, f"links form a loop, without a root: {_names(incoming)}")
    (root,) = roots
    children: dict[str, list[Joint]] = {}
    for joint in robot.joints:
        children.setdefault(joint.parent, []).append(joint)
    ordered: dict[str, Joint] = {}
    pose = {root: AT_ORIGIN}
    # A list, not recursion: chains of thousands of links are read too.
    waiting = [root]
    while waiting:
        link = waiting.pop(0)
        for joint in children.get(link, ()):
            ordered[joint.child] = joint
            motion = starts.get(joint.name, joint.reference) - joint.reference
            pose[joint.child] = pose[link] @ joint.origin @ moved(joint, motion)
            waiting.append(joint.child)
    if apart := [link for link in incoming if link not in ordered]:
        raise _error(robot, f"links form a loop, apart from root {root!r}: {_names(apart)}")
    return Tree(root, ordered, pose)


def moved(joint: Joint, motion: float) -> Pose:
    """Where a child is whose joint has moved from its reference, in the axes that it had there."""
    if joint.coordinate is None or motion == 0.0:
        return AT_ORIGIN
    if joint.type == "prismatic":
        return Pose(AT_ORIGIN.R, motion * joint.axis)
    R = by_rotation_vector(motion * joint.axis)
    # The axis through the anchor stays where it is.
    return Pose(R, joint.anchor - R @ joint.anchor)


def _incoming(robot: Robot) -> dict[str, Joint]:
    """The joint in which each link is the child."""
    incoming: dict[str, Joint] = {}
    for joint in robot.joints:
        for role, link in (("parent", joint.parent), ("child", joint.child)):
            if link not in robot.links:
                raise _error(robot, f"joint {joint.name!r}: {role}: no link {link!r}")
        # A loop of one link, which would have no root either.
        if joint.parent == joint.child:
            raise _error(robot, f"joint {joint.name!r}: parent and child are {joint.child!r}")
        if (other := incoming.get(joint.child)) is not None:
            raise _error(
                robot,
                f"link {joint.child!r} has two parents, by joints {other.name!r} and "
                f"{joint.name!r}: loops are not read, close them by a joint of the model file",
            )
        incoming[joint.child] = joint
    return incoming


def owners_of(robot: Robot, tree: Tree, flexible: Collection[str], free: bool) -> dict[str, str]:
    """The body that each link belongs to, named by its first link, or `ON_GROUND`.

    Links on fixed joints belong to the body of their parent. A flexible link is a body of its own,
    and so is what has mass on a fixed joint of it; free: whether the root is a body.
    """
    # Parents come first in the tree, so their owners are known.
    owner = {tree.root: tree.root if free else ON_GROUND}
    for link, joint in tree.incoming.items():
        parent = owner[joint.parent]
        apart = link in flexible or (parent in flexible and _fixed_mass(robot, tree, link))
        owner[link] = link if joint.type != "fixed" or apart else parent
    return owner


def _fixed_mass(robot: Robot, tree: Tree, link: str) -> float:
    """The mass of a link and of all that is fixed to it."""
    fixed = [link]
    for child, joint in tree.incoming.items():
        if joint.type == "fixed" and joint.parent in fixed:
            fixed.append(child)
    return sum(robot.links[each].mass for each in fixed)


def _error(robot: Robot, message: str) -> RobotError:
    return RobotError(f"{robot.path}: {message}")


# Links that a message lists; the others are counted.
MAX_LISTED = 6


def _names(links: Collection[str]) -> str:
    listed = ", ".join(map(repr, list(links)[:MAX_LISTED]))
    more = len(links) - MAX_LISTED
    return f"{listed} and {more} more" if more > 0 else listed
