"""A robot as its file describes it, whatever the format: links, joints between them, actuators."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np

from ..files.arrays import Array, IntArray
from .poses import AT_ORIGIN, Pose

JointType = Literal["fixed", "revolute", "prismatic", "planar", "spherical", "floating"]
# The coordinate of each type that has one alone, as model files name it.
COORDINATE_NAMES: dict[str, str] = {"revolute": "angle", "prismatic": "distance"}


@dataclass(frozen=True)
class Inertial:
    """The mass [kg] of a body, its center (3,) [m], and the inertia (3, 3) about it [kg m^2].

    Center and inertia are in the same axes, those of a link or of space.
    """

    mass: float
    center: Array
    inertia: Array


@dataclass(frozen=True)
class Geometry:
    """A figure about its own origin, along its own axes.

    kind: box, cylinder, sphere or mesh; size: edges (3,), radius and length along z (2,), or
    radius (1,) [m]; of a mesh file the factors (3,) of its coordinates. file: what the robot calls
    the mesh. facets: points (p, 3) and triangles (t, 3), of a mesh that is in no file.
    """

    kind: Literal["box", "cylinder", "sphere", "mesh"]
    size: Array
    file: str = ""
    facets: tuple[Array, IntArray] | None = None


@dataclass(frozen=True)
class Visual:
    """A figure that a picture shows, at a pose in the axes of its link."""

    pose: Pose
    geometry: Geometry


@dataclass(frozen=True)
class Link:
    """A rigid part; without an inertial it has no mass."""

    name: str
    inertial: Inertial | None = None
    visuals: tuple[Visual, ...] = ()

    @property
    def mass(self) -> float:
        return 0.0 if self.inertial is None else self.inertial.mass


@dataclass(frozen=True)
class Mimic:
    """A coordinate that follows another one: q = multiplier q_joint + offset."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True)
class Joint:
    """A joint between a parent and a child link.

    origin: the child in the axes of the parent, where the coordinate has its reference; axis and
    anchor (3,): direction and a point of the axis in the axes of the child. Numbers that are None
    or 0 are not given. Lengths in m, angles in rad, forces and torques in N and N m.
    """

    name: str
    type: JointType
    parent: str
    child: str
    origin: Pose = AT_ORIGIN
    axis: Array = field(default_factory=lambda: np.array([1.0, 0.0, 0.0]))
    anchor: Array = field(default_factory=lambda: np.zeros(3))
    reference: float = 0.0
    limits: tuple[float, float] | None = None
    effort: float | None = None
    velocity: float | None = None
    damping: float = 0.0
    friction: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0
    """the coordinate at which its spring has no force"""
    armature: float = 0.0
    mimic: Mimic | None = None

    @property
    def coordinate(self) -> str | None:
        """Its coordinate by the name in model files; None where it has not exactly one."""
        return COORDINATE_NAMES.get(self.type)


@dataclass(frozen=True)
class Actuator:
    """What moves a joint by an input: a torque or force, or a servo.

        v = torque + stiffness (reference - c) + damping (reference_rate - c')

    within `limit`. follows: what the input is of these; the others are 0.
    """

    name: str
    joint: str
    follows: Literal["torque", "reference", "rate"]
    stiffness: float = 0.0
    damping: float = 0.0
    limit: tuple[float, float] | None = None
    speed: float | None = None


@dataclass(frozen=True)
class Robot:
    """All links and joints of a file, in its order.

    left_out: what the file has and no model takes, in words; as often as it has it.
    """

    name: str
    path: Path
    links: Mapping[str, Link]
    joints: tuple[Joint, ...]
    actuators: tuple[Actuator, ...] = ()
    gravity: Array = field(default_factory=lambda: np.array([0.0, 0.0, -9.81]))
    left_out: tuple[str, ...] = ()
