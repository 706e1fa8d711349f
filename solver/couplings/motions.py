"""Prescribed motions of a frame: a displacement or a rotation that follows a signal."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..arrays import Array
from ..errors import ModelError
from ..schema.entry import Entry, entry
from ..schema.values import NO_ARRAY, Direction, FrameName, Name, NumbersByName
from ..signals.composed import OptionalParts
from ..signals.curves import Input
from ..signals.drives import (
    ANGULAR_RATES,
    LINEAR_RATES,
    DriveKeys,
    IntegratedDrive,
    angle_at_rate,
    drive_of,
    given_drive,
    refusal,
)
from ..signals.orientations import OrientationDrive
from ..signals.signal import AnySignal, DrivingSignal, SmoothSignal, is_any, is_smooth
from ..step.rows import Rotation, Translation
from .coupling import GROUND, Coupling
from .joint import ABOUT_E3, basis_about, driven_angle
from .rows import Row, Sides

# Relative to the values at `PROBE_TIMES`: sums of sines that cancel at t = 0 leave rounding.
NEGLIGIBLE_START = 1e-12
# [s], from microseconds to a second: the scale of a signal whose duration is unknown
PROBE_TIMES = tuple(10.0**k for k in range(-6, 1))


class PrescribedMotion(Entry, Coupling):
    """A motion of the frame `on` against space, where the frame starts."""

    label = "motion {name!r}"
    group: ClassVar[str] = "motions"
    dimension: ClassVar[str] = "joint"
    keys: ClassVar[DriveKeys]

    if TYPE_CHECKING:  # fields of its kinds

        @property
        def on(self) -> str: ...

    @property
    def type(self) -> str:
        return self.keys.coordinate

    @property
    def described(self) -> str:
        return self.owner

    @property
    def between(self) -> tuple[str, str]:
        return GROUND, self.on

    def turned_at(self, velocity: Array, moves: Callable[[Any], bool]) -> "PrescribedMotion":
        """This motion at a steady angular velocity (3,) in space [rad/s].

        It is unchanged unless its drive turns about an axis and moves with time.
        """
        return self

    def bound(self, joints: Mapping[str, Any]) -> Coupling:
        if self.on.partition(".")[0] == GROUND:
            raise self.error(f"expected a frame of a body, got {self.on!r}")
        return self


@entry()
class PrescribedDisplacement(PrescribedMotion):
    """A displacement along a direction that follows a signal.

        direction . (r(t) - r(0)) = displacement(t) [m],    displacement(0) = 0

    for the origin r of the frame `on`. One constraint: the frame moves freely across `direction`.
    Three of them prescribe a path.

    Parameters
    ----------
    name : str
    on : str
        The frame, see `Joint`.
    direction : (3,)
        In space.
    displacement, velocity, acceleration : signal [m, m/s, m/s^2]
        One of the three.
    start : mapping of float
        {"displacement_rate": ...} [m/s] with an acceleration.

    Examples
    --------
    >>> from duhamel.solver import Harmonic
    >>> PrescribedDisplacement("x", "base", [1, 0, 0], acceleration=Harmonic(9.81, 20.0)).on
    'base'
    """

    keys: ClassVar[DriveKeys] = DriveKeys("displacement", *LINEAR_RATES)
    unit: ClassVar[str] = "m"

    name: Name
    on: FrameName
    direction: Direction
    displacement: DrivingSignal | None = None
    velocity: AnySignal | None = None
    acceleration: AnySignal | None = None
    start: NumbersByName = field(default_factory=dict)

    def validate(self) -> None:
        _check(self)

    @property
    def drive(self) -> SmoothSignal:
        return _drive(self)

    @property
    def axis_in_space(self) -> Array | None:
        return self.direction

    def rows(self, sides: Sequence[Sides]) -> list[Row]:
        """A translation along the direction."""
        (own,) = sides
        # Frame A is the ground at the start of frame B: the direction stays fixed in space.
        along = own.pose_a.R.T @ self.direction
        return [Row(Translation.number, own.frame_a, own.frame_b, along, drive=self.drive)]


@entry()
class PrescribedRotation(PrescribedMotion):
    """A rotation about an axis that follows a signal.

        D(t) = exp(angle(t) axis~) D(0),    angle(0) = 0 [rad]

    for the axes D of the frame `on`, in space. Three constraints: the whole orientation is
    prescribed, and the axis keeps its direction.

    Parameters
    ----------
    name : str
    on : str
        The frame, see `Joint`.
    axis : (3,)
        In space.
    angle, angular_velocity, angular_acceleration : signal [rad, rad/s, rad/s^2]
        One of the three.
    start : mapping of float
        {"angle_rate": ...} [rad/s] with an acceleration.

    Examples
    --------
    >>> from duhamel.solver import Constant
    >>> PrescribedRotation("table", "disk", [0, 0, 1], angular_velocity=Constant(2.0)).on
    'disk'
    """

    keys: ClassVar[DriveKeys] = DriveKeys("angle", *ANGULAR_RATES)
    unit: ClassVar[str] = "rad"

    name: Name
    on: FrameName
    axis: Direction
    angle: DrivingSignal | None = None
    angular_velocity: AnySignal | None = None
    angular_acceleration: AnySignal | None = None
    start: NumbersByName = field(default_factory=dict)

    def validate(self) -> None:
        _check(self)

    @property
    def drive(self) -> SmoothSignal:
        return _drive(self)

    @property
    def axis_in_space(self) -> Array | None:
        return self.axis

    def rows(self, sides: Sequence[Sides]) -> list[Row]:
        """The axis is kept, as by a revolute joint, and the angle about it driven."""
        (own,) = sides
        A, B = own.frame_a, own.frame_b
        in_a, in_b = own.carried(basis_about(self.axis, own.pose_a.R))
        rows = [Row(Rotation.number, A, B, in_a[:, i], b=in_b[:, j]) for i, j in ABOUT_E3]
        return [*rows, driven_angle(A, B, in_a, in_b, self.drive)]

    def turned_at(self, velocity: Array, moves: Callable[[Any], bool]) -> PrescribedMotion:
        if not moves(self.drive):
            return self
        along = float(self.axis @ velocity) / float(np.linalg.norm(self.axis))
        return replace(self, start={}, **angle_at_rate(self.angle, along))

    def given_angles(self) -> Iterator[tuple[str, Any]]:
        if self.angle is not None:
            yield "angle", self.angle


@entry()
class PrescribedOrientation(PrescribedMotion):
    """Rotations about all three axes of space that follow signals, each of up to 1 rad.

        D(t) = R_z(angles[2]) R_y(angles[1]) R_x(angles[0]) D(0),    angles(0) = 0 [rad]

    for the axes D of the frame `on`. Three constraints. For small angles the rates are those of the
    frame about x, y and z.

    Parameters
    ----------
    name : str
    on : str
        The frame, see `Joint`.
    angles, angular_velocities, angular_accelerations : sequence of 3 signals
        One of the three: the angles [rad], their rates or the rates of those.

    Examples
    --------
    >>> from duhamel.solver import Constant, Harmonic
    >>> still = Constant(0.0)
    >>> PrescribedOrientation("deck", "ship", [Harmonic(0.1, 0.2), still, still]).on
    'ship'
    """

    keys: ClassVar[DriveKeys] = DriveKeys("angles", "angular_velocities", "angular_accelerations")

    name: Name
    on: FrameName
    angles: OptionalParts = NO_ARRAY
    angular_velocities: OptionalParts = NO_ARRAY
    angular_accelerations: OptionalParts = NO_ARRAY
    start: ClassVar[Mapping[str, float]] = {}

    def validate(self) -> None:
        for name, angle in zip("xyz", self.drives, strict=True):
            if not isinstance(angle, IntegratedDrive):
                _check_from_rest(f"{self.owner}: angles: {name}", angle)

    @property
    def drives(self) -> tuple[SmoothSignal, SmoothSignal, SmoothSignal]:
        """The angles about x, y and z."""
        key, signals = given_drive(self, self.keys)
        if not signals or len(signals) != 3:
            found = f"{len(signals)} {key}" if signals else "none"
            raise self.error(f"expected three signals, {', '.join(self.keys)}, found {found}")
        x, y, z = (self._angle(key, signal) for signal in signals)
        return x, y, z

    def rows(self, sides: Sequence[Sides]) -> list[Row]:
        """One for each of the three axes, see solver/signals/orientations.py."""
        (own,) = sides
        in_a, in_b = own.carried(np.eye(3))
        A, B, angles = own.frame_a, own.frame_b, self.drives
        return [
            Row(
                Rotation.number,
                A,
                B,
                in_a[:, (j + 1) % 3],
                -in_a[:, j],
                in_b[:, j],
                drive=OrientationDrive(angles, j, self.owner),
            )
            for j in (1, 2, 0)
        ]

    def _angle(self, key: str, signal: Any) -> SmoothSignal:
        order = self.keys.index(key)
        reason = refusal(signal, order) if order else ""
        if order == 0 and is_any(signal, Input):
            reason = "an input has no place among them: drive joints in a row by it"
        elif order == 0 and not is_smooth(signal):
            reason = f"expected smooth signals, found {type(signal).__name__.lower()}"
        if reason:
            raise self.error(f"{key}: {reason}")
        if order:
            return IntegratedDrive(signal, order, error=self.error)
        driving: SmoothSignal = signal
        return driving


def _drive(motion: PrescribedDisplacement | PrescribedRotation) -> SmoothSignal:
    drive = drive_of(motion, motion.keys)
    if drive is None:
        raise motion.error(f"expected one of {', '.join(motion.keys)}, found none")
    return drive


def _check(motion: PrescribedDisplacement | PrescribedRotation) -> None:
    drive, keys = _drive(motion), motion.keys
    if not isinstance(drive, IntegratedDrive):
        _check_from_rest(f"{motion.owner}: {keys.coordinate}", drive)
    takes = (keys.rate,) if isinstance(drive, IntegratedDrive) and drive.order == 2 else ()
    for name in motion.start:
        if name not in takes:
            known = f"takes {keys.rate} with {keys.acceleration} alone"
            raise motion.error(f"start: {known}, got {name!r}")


def _check_from_rest(name: str, signal: SmoothSignal) -> None:
    # An offset would be a jump from the place of the frame at the first step.
    if (start := signal(0.0)) != 0.0 and abs(start) > NEGLIGIBLE_START * max(
        map(abs, map(signal, PROBE_TIMES))
    ):
        raise ModelError(
            f"{name}: expected 0 at t = 0, got {start:.6g}: it is measured from where the frame "
            f"starts; add an offset of {-start:.6g}"
        )
