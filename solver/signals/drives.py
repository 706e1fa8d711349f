"""Drives: coordinates that follow a signal, or whose velocity or acceleration does.

    s(t) = s_0 + v_0 t + int_0^t (t - tau) a(tau) dtau,     s(t) = s_0 + int_0^t v(tau) dtau

The integrals are those of quadrature.py, exact to rounding, so that a coordinate ends where the
signal takes it: what is left at the end of a recorded acceleration is drift, which `Drift` states.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple, Protocol

import numpy as np

from ..arrays import Array
from ..errors import ModelError
from .composed import has_slope, slope_of
from .curves import Constant, Impulse, Input, Polynomial
from .quadrature import Integrals
from .signal import Pointwise, Signal, SmoothSignal, is_any, jumps_of, parts_of


class DriveKeys(NamedTuple):
    """The keys of a driven coordinate: itself, its velocity and its acceleration."""

    coordinate: str
    velocity: str
    acceleration: str

    @property
    def rate(self) -> str:
        """The key of the rate at the start."""
        return f"{self.coordinate}_rate"


LINEAR_RATES = "velocity", "acceleration"
ANGULAR_RATES = "angular_velocity", "angular_acceleration"


class _Driven(Protocol):
    """A joint or a motion."""

    @property
    def start(self) -> Mapping[str, float]: ...

    def error(self, message: str) -> ModelError: ...


@dataclass(frozen=True, eq=False)
class IntegratedDrive(Pointwise):
    """A coordinate whose velocity (order 1) or acceleration (order 2) follows a signal.

    start, rate: the coordinate and its rate at t = 0; by velocity the rate is that of the signal.
    """

    signal: Signal
    order: int
    start: float = 0.0
    rate: float = 0.0
    error: Callable[[str], ModelError] = ModelError
    """names the owner of the coordinate"""

    @cached_property
    def _integrals(self) -> Integrals:
        return Integrals(self.signal)

    def starting_at(self, start: float) -> "IntegratedDrive":
        return replace(self, start=start)

    def values_at(self, t: Array) -> Array:
        try:
            moved: Array = self._integrals(t)[self.order - 1]
        except ModelError as error:
            raise self.error(str(error)) from error
        # Integrals are from 0, so that what is left are the values at the start.
        return self.start + self.rate * t + moved

    def derivatives(self, t: float) -> tuple[float, float]:
        if self.order == 1:
            # Constraints of rates use the signal itself, not differences of its integral.
            return self.signal(t), slope_of(self.signal, t)
        return self.rate + float(self._integrals(np.array([t]))[0][0]), self.signal(t)


def given_drive(owner: _Driven, keys: DriveKeys) -> tuple[str, Any]:
    """The one key that is given, and its value; "" and None if none is."""
    given = {key: getattr(owner, key) for key in keys if getattr(owner, key) is not None}
    if len(given) > 1:
        raise owner.error(f"expected one of {', '.join(keys)}, found {' and '.join(given)}")
    return next(iter(given.items()), ("", None))


def drive_of(owner: _Driven, keys: DriveKeys) -> SmoothSignal | None:
    """The signal of a coordinate that follows one, by whichever of its keys; None if it does not.

    ModelError for more than one, and for signals that have no integral.
    """
    key, signal = given_drive(owner, keys)
    if signal is None:
        return None
    if key == keys.coordinate:
        driving: SmoothSignal = signal
        return driving
    order = keys.index(key)
    if reason := refusal(signal, order):
        raise owner.error(f"{key}: {reason}")
    # A velocity determines the rate at the start; an acceleration leaves it open.
    rate = owner.start.get(keys.rate, 0.0) if order == 2 else 0.0
    return IntegratedDrive(signal, order, rate=rate, error=owner.error)


def angle_at_rate(angle: SmoothSignal | None, rate: float) -> Mapping[str, Any]:
    """The keys of an angle that turns at a constant rate [rad/s] from where its drive starts."""
    # All keys of a drive are reset, or the joint would have two.
    steady = {"angle": None, "angular_velocity": None, "angular_acceleration": None}
    if angle is None:
        return {**steady, "angular_velocity": Constant(rate)}
    return {**steady, "angle": Polynomial((angle(0.0), rate))}


def refusal(signal: Signal, order: int) -> str:
    """Why the velocity (order 1) or acceleration (2) of a coordinate cannot follow a signal."""
    if is_any(signal, Input):
        return "an input is known only when its step is due: drive the coordinate itself by it"
    if is_any(signal, Impulse):
        return "an impulse makes the velocity jump: spread it over some time, as by half_sine"
    if order == 1 and (jumps := jumps_of(signal)):
        return (
            f"expected a velocity without jumps, found one at t = {jumps[0]:.6g} s: give it a "
            "slope, or give the acceleration"
        )
    if order == 1 and not has_slope(signal):
        return f"expected a signal with derivatives, found {_name_of_rough(signal)}"
    return ""


def _name_of_rough(signal: Signal) -> str:
    rough = [part for part in parts_of(signal) if not has_slope(part)]
    return _name_of_rough(rough[0]) if rough else type(signal).__name__.lower()


class Drift(NamedTuple):
    """Where a coordinate that is driven by its velocity or acceleration ends."""

    owner: str
    by: str
    time: float
    value: float
    rate: float
    unit: str

    def __str__(self) -> str:
        return (
            f"{self.owner}, driven by its {self.by}: at t = {self.time:.6g} s it has moved by "
            f"{self.value:.4g} {self.unit} and moves at {self.rate:.4g} {self.unit}/s"
        )


def drift_of(drive: IntegratedDrive, owner: str, unit: str, t_end: float) -> Drift:
    by = ("velocity", "acceleration")[drive.order - 1]
    moved = drive(t_end) - drive.start
    return Drift(owner, by, t_end, moved, drive.derivatives(t_end)[0], unit)
