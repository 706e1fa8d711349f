"""Joints of a model, and what acts on their coordinates: stops, motors, couplers."""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from .bodies import ModelBody
from .description import Actuator, Joint, Mimic, Robot
from .document import Section, tidy
from .flexible import anchor
from .options import STOP_FREQUENCY, STOP_RESTITUTION, FlexibleLink, ImportOptions
from .poses import Pose
from .tree import Tree

# Joints of a description by those of model files; a floating one is none.
MODEL_TYPES = {
    "fixed": "fixed",
    "revolute": "revolute",
    "prismatic": "prismatic",
    "planar": "planar",
    "spherical": "spherical",
}
TYPES_WITH_AXIS = "revolute", "prismatic", "planar"


@dataclass(frozen=True)
class NamedJoint:
    """A joint with its name in the model, the bodies that it joins, and where it starts."""

    joint: Joint
    name: str
    parent: ModelBody
    child: ModelBody
    start: float

    @property
    def coordinate(self) -> str:
        """Its coordinate; "" where it has not exactly one."""
        return self.joint.coordinate or ""

    def section(self, tree: Tree, flexible: Mapping[str, FlexibleLink]) -> Section:
        """Its table in the model file; frames are attached to both bodies."""
        joint = self.joint
        values: dict[str, Any] = {
            "name": self.name,
            "type": MODEL_TYPES[joint.type],
            "between": [self._frame(body, tree, flexible) for body in (self.parent, self.child)],
        }
        if joint.type in TYPES_WITH_AXIS:
            values["axis"] = tidy(tree.pose[joint.child].R @ joint.axis, 1.0)
        if self.start != 0.0:
            values["reference_coordinates"] = {self.coordinate: self.start}
        if friction := _friction(joint):
            values["friction"] = friction
        return Section("[[joints]]", values)

    def _frame(self, body: ModelBody, tree: Tree, flexible: Mapping[str, FlexibleLink]) -> str:
        joint, place = self.joint, anchor(tree, self.joint)
        if body.superelement is not None:
            return f"{body.name}.{flexible[body.links[0]].interfaces[joint.name]}"
        # Two fixed frames must agree in their axes, and those of a superelement are its link's.
        axes = tree.pose[joint.child].R if joint.type == "fixed" else body.pose.R
        return body.attach(joint.name, Pose(axes, place))


def _friction(joint: Joint) -> dict[str, float]:
    """The friction of a joint of the model: viscous, and by a constant torque or force."""
    # Only joints with one coordinate have friction in a model; of others it is told.
    if joint.coordinate is None:
        return {}
    friction = {"viscous": joint.damping} if joint.damping else {}
    if joint.friction:
        friction["torque" if joint.coordinate == "angle" else "force"] = joint.friction
    return friction


def stop(
    joint: NamedJoint, limits: tuple[float, float], robot: Robot, tree: Tree, options: ImportOptions
) -> Section:
    """The limits of a joint as a stop."""
    stiffness = options.stop_stiffness
    remark = ""
    if stiffness is None:
        inertia, unit = largest_inertia(joint.joint, robot, tree)
        # Three digits: the number is a guess, and is to look like one.
        stiffness = float(f"{STOP_FREQUENCY**2 * inertia:.3g}")
        remark = f"{STOP_FREQUENCY:g} rad/s with at most {inertia:.3g} {unit}; the robot has none"
    values = {
        "name": f"{joint.name} limits",
        "joint": joint.name,
        "coordinate": joint.coordinate,
        "range": list(limits),
        "stiffness": stiffness,
        "restitution": STOP_RESTITUTION,
    }
    return Section("[[stops]]", values, {"stiffness": remark})


def largest_inertia(joint: Joint, robot: Robot, tree: Tree) -> tuple[float, str]:
    """The inertia behind a joint with all links stretched out from it, and its unit.

    A bound: sum m (|way to the center|)^2 + the largest principal inertia, or the mass of a slide.
    """
    links = tree.beyond(joint.child)
    masses = {link: robot.links[link].mass for link in links}
    if joint.type == "prismatic":
        return sum(masses.values()) + joint.armature, "kg"
    way = {joint.child: 0.0}
    total = joint.armature
    # Links come after their parents, so the way to the parent is known.
    for link in links:
        if link not in way:
            way[link] = way[tree.incoming[link].parent] + _length(tree.incoming[link])
        inertial = robot.links[link].inertial
        if inertial is not None:
            reach = way[link] + float(np.linalg.norm(inertial.center))
            total += masses[link] * reach**2 + float(np.linalg.eigvalsh(inertial.inertia)[2])
    return total, "kg m^2"


def _length(joint: Joint) -> float:
    """How far a joint takes its child away, at most."""
    travel = 0.0
    if joint.type == "prismatic" and joint.limits is not None:
        travel = max((abs(limit) for limit in joint.limits if math.isfinite(limit)), default=0.0)
    return float(np.linalg.norm(joint.origin.p)) + travel


def servos(joints: Iterable[NamedJoint], options: ImportOptions) -> Iterator[Actuator]:
    """A servo at each joint that has one coordinate and mimics none, by the gains of the user."""
    for each in joints:
        joint = each.joint
        gains = options.servos.get(joint.name, options.servo)
        if joint.coordinate is None or joint.mimic is not None or gains is None:
            continue
        limit = None if joint.effort is None else (-joint.effort, joint.effort)
        yield Actuator(
            joint.name,
            joint.name,
            "reference",
            stiffness=gains[0],
            damping=gains[1],
            limit=limit,
            # The speed of a motor lowers its limit: without one there is none to lower.
            speed=joint.velocity if limit else None,
        )


def motor(actuator: Actuator, joint: NamedJoint, name: str, port: str) -> Section:
    """The motor of an actuator; port: the name of its input."""
    values: dict[str, Any] = {"name": name, "joint": joint.name, "coordinate": joint.coordinate}
    if actuator.follows == "torque":
        values["torque" if joint.coordinate == "angle" else "force"] = {"input": port}
    elif actuator.follows == "reference":
        # Without a controller it holds the pose in which the robot starts.
        values["reference"] = {"input": port, "value": joint.start}
    else:
        values["reference_rate"] = {"input": port}
    # A file says only what is not the default.
    values |= {"stiffness": actuator.stiffness} if actuator.stiffness else {}
    values |= {"damping": actuator.damping} if actuator.damping else {}
    if actuator.limit is not None:
        lower, upper = actuator.limit
        values["limit"] = upper if lower == -upper else [lower, upper]
    values |= {"speed": actuator.speed} if actuator.speed is not None else {}
    return Section("[[motors]]", values)


def spring(joint: NamedJoint) -> Section:
    """The spring of a joint about its rest, as a motor without an input."""
    values = {
        "name": f"{joint.name} spring",
        "joint": joint.name,
        "coordinate": joint.coordinate,
        "reference": joint.joint.rest,
        "stiffness": joint.joint.stiffness,
    }
    return Section("[[motors]]", values)


def coupler(joint: NamedJoint, mimic: Mimic, leader: NamedJoint) -> Section:
    """A joint that mimics another one: q - multiplier q_leader = offset."""
    values = {
        "name": f"{joint.name} mimic",
        "type": "linear",
        "joints": [joint.name, leader.name],
        "ratios": [1.0, -mimic.multiplier],
        "offset": mimic.offset,
    }
    return Section("[[couplers]]", values)
