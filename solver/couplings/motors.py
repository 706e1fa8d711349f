"""Motors: a torque or a force on a joint coordinate, by a signal or by a servo."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar

import numpy as np

from ...inputs import expected
from ..arrays import Array
from ..schema.entry import Entry, FieldSpec, entry
from ..schema.values import Infinite, JointName, Name, NotNegative, Positive, PositiveTime, limits
from ..signals.curves import Constant, Input
from ..signals.signal import AnySignal, Pointwise, Signal, derivatives_of, is_smooth, values_of
from .joint import Joint
from .on_coordinate import OnCoordinate
from .rows import Row, Sides

NO_SIGNAL = Constant(0.0)


def _store_bounds(value: Any) -> tuple[float, float]:
    """A lower and a higher number; one positive number stands for both."""
    # One number bounds both directions.
    lower, upper = value if isinstance(value, Sequence | np.ndarray) else (-value, value)
    return limits((lower, upper))


def _bounds_in_file(bounds: tuple[float, float]) -> Any:
    lower, upper = bounds
    return upper if lower == -upper else [lower, upper]


_BOUNDS = "a positive number, or a lower and a higher one, of which one may be infinite"
Bounds = Annotated[
    tuple[float, float],
    FieldSpec(
        _BOUNDS,
        _store_bounds,
        Annotated[float | tuple[Infinite, Infinite], expected(_BOUNDS)],
        _bounds_in_file,
    ),
]


@entry()
class Motor(Entry):
    """A torque or a force on a joint coordinate c, between the two bodies of the joint.

        v = torque + stiffness (r - c) + damping (r' - c') + z,     z' = integral (r - c)

    The motor gives v, within its limits. Beyond a limit the integral follows it, so that it does
    not wind up:

        z' = integral (r - c) + (limit - v) / tracking_time

    Parameters
    ----------
    name : str
    joint : str
    coordinate : str
        One that the joint leaves free.
    torque, force : signal, optional
        Torque [N m] on an angle, force [N] on a distance.
    reference : signal, optional [rad, m]
        r, by default 0.
    reference_rate : signal, optional [rad/s, m/s]
        r', by default the derivative of r where it is smooth, or else 0.
    stiffness, damping, integral : float
        Gains [N m/rad, N/m], [N m s/rad, N s/m], [N m/(rad s), N/(m s)].
    limit : float or (2,), optional [N m, N]
        Of v: for both directions, or a lower and a higher one.
    speed : float, optional [rad/s, m/s]
        Without load; towards it the limit of a v that drives the motion falls linearly to zero.
    tracking_time : float, optional [s]
        By default sqrt(damping / integral), or stiffness / integral without damping.

    Examples
    --------
    >>> from duhamel.solver import SmoothStep
    >>> turn = SmoothStep((0.0, 1.0), over=(0.0, 0.5))
    >>> Motor("servo", "hinge", "angle", reference=turn, stiffness=50.0, damping=2.0).coordinate
    'angle'
    """

    label = "motor {name!r}"
    group: ClassVar[str] = "motors"

    name: Name
    joint: JointName
    coordinate: str
    torque: AnySignal | None = None
    force: AnySignal | None = None
    reference: AnySignal | None = None
    reference_rate: AnySignal | None = None
    stiffness: NotNegative = 0.0
    damping: NotNegative = 0.0
    integral: NotNegative = 0.0
    limit: Bounds | None = None
    speed: Positive | None = None
    tracking_time: PositiveTime | None = None

    @property
    def is_servo(self) -> bool:
        return self.stiffness > 0.0 or self.damping > 0.0 or self.integral > 0.0

    @property
    def signals(self) -> tuple[Signal, Signal, Signal]:
        """The feedforward torque or force, the reference, and the rate of the reference."""
        feedforward, reference = self.torque or self.force or NO_SIGNAL, self.reference or NO_SIGNAL
        rate = self.reference_rate
        # An input is known step by step: its rate is not.
        if isinstance(reference, Input) or not is_smooth(reference):
            return feedforward, reference, rate or NO_SIGNAL
        return feedforward, Values(reference), rate or Rate(reference)

    @property
    def tracking(self) -> float:
        """1 / tracking_time, 0 where nothing winds up [1/s]."""
        if self.limit is None or self.integral == 0.0:
            return 0.0
        if self.tracking_time is not None:
            return 1.0 / self.tracking_time
        if self.damping > 0.0:
            # Astrom's rule for anti-windup, sqrt(T_i T_d) with T_i = stiffness / integral, T_d =
            # damping / stiffness.
            return math.sqrt(self.integral / self.damping)
        return self.integral / self.stiffness

    def validate(self) -> None:
        if self.torque is not None and self.force is not None:
            raise self.error("expected torque of an angle or force of a distance, found both")
        if self.torque is None and self.force is None and not self.is_servo:
            raise self.error("expected torque, force, stiffness, damping or integral, found none")
        self._check_reference()
        self._check_limit()

    def bound(self, joints: Mapping[str, Joint]) -> "JointMotor":
        bound: JointMotor = JointMotor.of(self, joints)
        return bound

    def _check_reference(self) -> None:
        if self.reference is not None and not self.is_servo:
            raise self.error("reference: needs stiffness, damping or integral, found none")
        if self.reference_rate is None:
            return
        if self.damping == 0.0:
            raise self.error("reference_rate: needs damping, found none")
        if self.reference is None and (self.stiffness > 0.0 or self.integral > 0.0):
            raise self.error("reference_rate: needs reference, found none")

    def _check_limit(self) -> None:
        if self.speed is not None:
            if self.limit is None:
                raise self.error("speed: needs limit, found none")
            lower, upper = self.limit
            # The line from the limit at rest to zero at `speed` needs both ends.
            if not -math.inf < lower <= 0.0 <= upper < math.inf:
                raise self.error(f"speed: needs a limit on both sides of 0, got {[lower, upper]}")
        winds_up = self.integral > 0.0 and self.limit is not None
        if self.tracking_time is not None and not winds_up:
            raise self.error("tracking_time: needs integral and limit")
        alone = self.stiffness == 0.0 and self.damping == 0.0
        if winds_up and alone and self.tracking_time is None:
            raise self.error("tracking_time: required with a limit and integral alone")


@dataclass(frozen=True)
class Values(Pointwise):
    """A smooth signal, sampled by its values at the steps, as drives are."""

    signal: Any

    def values_at(self, t: Array) -> Array:
        return values_of(self.signal, t)


@dataclass(frozen=True)
class Rate(Pointwise):
    """The derivative of a smooth signal."""

    signal: Any

    def values_at(self, t: Array) -> Array:
        return derivatives_of(self.signal, t)[0]


class JointMotor(OnCoordinate):
    """A motor with the joint that it belongs to."""

    part: Motor
    group: ClassVar[str] = "motors"
    dimension: ClassVar[str] = "motor"
    keeps_turns: ClassVar[bool] = True

    def __post_init__(self) -> None:
        """`ModelError` for a coordinate that the joint has not, or drives, or of another kind."""
        super().__post_init__()
        if self.coordinate in self.joint.drives:
            raise self.error(f"coordinate: {self.coordinate} of {self.joint.name!r} is driven")
        if self.part.torque is not None and not self.turns:
            raise self.error(f"torque: {self.coordinate!r} is a distance and takes a force")
        if self.part.force is not None and self.turns:
            raise self.error(f"force: {self.coordinate!r} is an angle and takes a torque")

    def rows(self, sides: Sequence[Sides]) -> list[Row]:
        """The joint coordinate with its motor."""
        return [replace(self.row(sides), motor=self.part)]

    def given_angles(self) -> Iterator[tuple[str, Any]]:
        if self.turns and self.part.reference is not None:
            yield "reference", self.part.reference
