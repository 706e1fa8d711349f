"""The rows of couplings: constraints, and coordinates with laws, seen from the frames at the start.

A coupling acts between two frames, or on the coordinates of joints, by some rows. Each row is one
of the kinds of solver/step/rows.py, which compute its coordinate from the two frames.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from ..arrays import Array
from ..laws.law import ForceLaw
from ..signals.signal import Signal, SmoothSignal
from ..step.rotations import rotation_matrix


class _Frame(Protocol):
    @property
    def position(self) -> Array: ...
    @property
    def rotation(self) -> Array: ...


@dataclass(frozen=True, eq=False)
class Pose:
    """Position x (3,) in space and rotation R (3, 3) to space."""

    x: Array
    R: Array

    def carry(self, frame: _Frame) -> "Pose":
        """The pose in space of a frame of the body that has this pose."""
        return Pose(self.x + self.R @ frame.position, self.R @ rotation_matrix(frame.rotation))


@dataclass(frozen=True, eq=False)
class Sides:
    """The two frames of a coupling: numbers and poses at the start."""

    frame_a: int
    frame_b: int
    pose_a: Pose
    pose_b: Pose
    fixed_a: bool = False
    """frame A is fixed in space"""

    def swapped(self) -> "Sides":
        # `fixed_a` is dropped: once swapped, frame A is that of the body.
        return Sides(self.frame_b, self.frame_a, self.pose_b, self.pose_a)

    def carried(self, basis: Array) -> tuple[Array, Array]:
        """Axes in space at the start, in the axes of frames A and B."""
        return self.pose_a.R.T @ basis, self.pose_b.R.T @ basis

    def gap(self, basis: Array) -> Array:
        """r_B - r_A at the start along axes in space."""
        gap: Array = basis.T @ (self.pose_b.x - self.pose_a.x)
        return gap


class Servo(Protocol):
    """The gains and limits of a motor that drives a coordinate towards a reference."""

    @property
    def stiffness(self) -> float: ...
    @property
    def damping(self) -> float: ...
    @property
    def integral(self) -> float: ...
    @property
    def limit(self) -> tuple[float, float] | None: ...
    @property
    def speed(self) -> float | None: ...
    @property
    def tracking(self) -> float: ...
    @property
    def signals(self) -> tuple[Signal, Signal, Signal]: ...


@dataclass(frozen=True, eq=False)
class OverSpin:
    """What a spin adds to stiffness and damping of a row, linear between its speeds.

    speeds (n,) increasing [rad/s]; stiffness, damping (n, 2): against the first two rows of the
    coupling, whose third has the spin as its rate.
    """

    speeds: Array
    stiffness: Array
    damping: Array


@dataclass(frozen=True, eq=False)
class Row:
    """One row between frames A and B, by their numbers, with its drive or its law."""

    kind: int
    frame_a: int
    frame_b: int
    a: Array = field(default_factory=lambda: np.zeros(3))
    a_turned: Array = field(default_factory=lambda: np.zeros(3))
    b: Array = field(default_factory=lambda: np.zeros(3))
    drive: SmoothSignal | None = None
    start: float = 0.0
    rest: float = 0.0
    stiffness: Array | None = None
    damping: Array | None = None
    over_spin: OverSpin | None = None
    laws: tuple[ForceLaw, ...] = ()
    swapped: bool = False
    """frame A is the second that the coupling names"""
    shape: int = 0
    parameters: Sequence[float] = ()
    """of the shape of a contact"""
    size: float = math.inf
    """of a contact's ball and shape"""
    normal: tuple[float, int] = (0.0, 0)
    """weight and group in the normal force of friction"""
    has_friction: bool = False
    motor: Servo | None = None
    zero: float = 0.0
    """what the coordinate is measured from"""
    axis: tuple[SmoothSignal, ...] = ()
    """the components of a, of a row of an attitude"""
    reference: float | None = None
    """the coordinate where the bodies are placed, of a driven one unless it is the drive's start"""
    terms: tuple["Term", ...] = ()

    @property
    def drives(self) -> tuple[SmoothSignal, ...]:
        return self.axis if self.drive is None else (self.drive,)

    @property
    def compliant(self) -> bool:
        """Whether the row obeys a force law, and is not a constraint."""
        follows_law = self.stiffness is not None or bool(self.laws) or self.motor is not None
        return follows_law or self.has_friction


@dataclass(frozen=True, eq=False)
class Term:
    """The coordinate of another row that joins a constraint, times a ratio."""

    row: Row
    ratio: float
    same_frames: bool = False
    """between the frames of the coupling itself"""
