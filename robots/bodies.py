"""Bodies of a model: rigid ones of one or more links, and superelements in place of links."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ..files.arrays import Array
from ..solver.model.bodies import INERTIA_TOLERANCE
from ..superelement import Superelement
from .description import Inertial, Robot
from .document import Section, table_head, tidy, without_noise
from .errors import RobotError
from .inertia import as_of_a_body, composite, in_space, require_physical, require_positive
from .names import Names
from .poses import AT_ORIGIN, Pose, rotation_vector
from .tree import ON_GROUND, Tree

# Of the ground in model files, which no body may have.
GROUND_NAME = "ground"


@dataclass
class ModelBody:
    """A body of the model, or the ground.

    pose: of its axes, at its center of mass, in space; inertial: about that center, in these axes,
    None of the ground and of a superelement; links: of the robot, the first one names it.
    """

    name: str
    pose: Pose
    links: Sequence[str]
    inertial: Inertial | None = None
    superelement: Superelement | None = None
    file: Path | None = None
    frames: dict[str, Pose] = field(default_factory=dict)
    names: Names = field(default_factory=Names)
    shape: Mapping[str, Any] | None = None
    above: list[str] = field(default_factory=list)

    @property
    def mass(self) -> float:
        if self.superelement is not None:
            return float(self.superelement.mass)
        return 0.0 if self.inertial is None else self.inertial.mass

    @property
    def size(self) -> float:
        """How large the coordinates are from which those in body axes are computed [m]."""
        return max(1.0, float(np.abs(self.pose.p).max()))

    def attach(self, wanted: str, pose: Pose) -> str:
        """A frame at a pose in space, as joints name it: BODY.FRAME."""
        name = self.names.new(wanted)
        self.frames[name] = self.pose.relative(pose)
        return f"{self.name}.{name}"

    def section(self, superelement: str = "") -> Section:
        """Its table; superelement: the path of its file, as the model names it."""
        values: dict[str, Any] = {}
        if self.superelement is not None:
            values["superelement"] = superelement
        if self.inertial is not None:
            values["mass"] = self.inertial.mass
            values["inertia"] = _inertia(self.inertial.inertia)
        if self.name != GROUND_NAME:
            values["position"] = tidy(self.pose.p)
            turn = rotation_vector(self.pose.R)
            values |= {"rotation": tidy(turn, 1.0)} if turn.any() else {}
        size = self.size
        for name, pose in self.frames.items():
            values[f"frames.{name}"] = _frame(pose, size)
        # Last, for a shape says nothing of the motion.
        values |= {"shape": self.shape} if self.shape else {}
        is_ground = self.name == GROUND_NAME
        head = table_head(GROUND_NAME) if is_ground else table_head("bodies", self.name)
        return Section(head, values, above=self.above)


def _inertia(J: Array) -> Array:
    """The three principal inertias where they are along the body axes, or the whole matrix."""
    kept = without_noise(J)
    principal = np.diagonal(kept)
    return principal if (kept == np.diag(principal)).all() else kept


def _frame(pose: Pose, size: float) -> dict[str, Any]:
    turn = tidy(rotation_vector(pose.R), 1.0)
    rotation = {"rotation": turn} if turn.any() else {}
    return {"position": tidy(pose.p, size)} | rotation


def ground(tree: Tree, owner: Mapping[str, str]) -> ModelBody:
    """The ground, with the links that are fixed to it."""
    links = [link for link in tree.links if owner[link] == ON_GROUND]
    return ModelBody(GROUND_NAME, AT_ORIGIN, links)


def rigid_body(robot: Robot, tree: Tree, links: Sequence[str], name: str) -> ModelBody:
    """Links that are fixed to one another as one body; its axes are those of the first.

    `RobotError` for a body without mass or with an inertia that no body has.
    """
    first = links[0]
    error = partial(_error, robot, first)
    axes = tree.pose[first]
    inertials = {link: one for link in links if (one := robot.links[link].inertial) is not None}
    for link, inertial in inertials.items():
        # One of them that is impossible would hide among the others.
        require_physical(inertial, partial(_error, robot, link))
    # Of the first link the relative pose is the identity but for rounding: its numbers stay.
    poses = {link: axes.relative(tree.pose[link]) for link in links} | {first: AT_ORIGIN}
    parts = [in_space(each, poses[link]) for link, each in inertials.items()]
    if not sum(part.mass for part in parts):
        raise error("moves without a mass: give it an <inertial>, or make its joint fixed")
    whole = composite(parts)
    require_positive(whole.inertia, error)
    J, said = as_of_a_body(whole.inertia, INERTIA_TOLERANCE)
    pose = Pose(axes.R, axes.of(whole.center))
    above = [said] if said else []
    if len(parts) > 1:
        masses = " + ".join(f"{robot.links[link].mass:g}" for link in links)
        above.append(f"{', '.join(links)}: {masses} kg, one body by fixed joints")
    return ModelBody(name, pose, links, Inertial(whole.mass, np.zeros(3), J), above=above)


def _error(robot: Robot, link: str, message: str) -> RobotError:
    return RobotError(f"{robot.path}: link {link!r}: {message}")
