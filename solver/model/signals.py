"""Functions of time that drive loads and joints.

A signal is called with a time, `signal(t)`, and is sampled for the integrator at the time steps.
At its jumps, the samples are its means over the hat functions of the time grid, so that the area
under a load is exact wherever the jump falls between two steps; elsewhere they are its values.
"""

from collections.abc import Callable
from dataclasses import field
from itertools import pairwise
from typing import Annotated, Any, Protocol, runtime_checkable

import numpy as np

from ..arrays import Array
from ..errors import ModelError
from ..schema.entry import Entry, Key, Takes, entry
from ..schema.forms import Family
from ..schema.values import Numbers, SomeNumbers


@runtime_checkable
class Signal(Protocol):
    def __call__(self, t: float) -> float:
        """The value at time t [s]."""

    def samples(self, t: Array, h: float) -> Array:
        """The values that the integrator takes at the steps t (n,), multiples of h."""


@runtime_checkable
class SmoothSignal(Signal, Protocol):
    """A signal smooth enough to drive a joint."""

    def derivatives(self, t: float) -> tuple[float, float]:
        """The first and second derivative at time t."""


SIGNALS = Family("signal")


class Pointwise:
    """Signals without jumps: a sample is a value."""

    def __call__(self, t: float) -> float:
        raise NotImplementedError

    def samples(self, t: Array, h: float) -> Array:
        return np.array([self(time) for time in t.tolist()])


@SIGNALS.bare_number
@entry(eq=True)
class Constant(Pointwise, Entry):
    """A constant value."""

    value: float

    def __call__(self, t: float) -> float:
        return self.value

    def derivatives(self, t: float) -> tuple[float, float]:
        return 0.0, 0.0


@SIGNALS.in_files("times")
@entry(eq=True)
class Steps(Entry):
    """values[i] from times[i] on, 0 before the first."""

    times: Numbers
    values: Numbers

    def validate(self) -> None:
        _check_table(self.times, self.values)

    def __call__(self, t: float) -> float:
        index = int(np.searchsorted(self.times, t, side="right"))
        return self.values[index - 1] if index else 0.0

    @property
    def jumps(self) -> tuple[float, ...]:
        return self.times

    def samples(self, t: Array, h: float) -> Array:
        jumps = np.diff(self.values, prepend=0.0)
        return sum(
            (
                jump * _step_samples(time, t, h)
                for time, jump in zip(self.times, jumps, strict=True)
            ),
            np.zeros_like(t),
        )


@SIGNALS.in_files("times", flag="linear")
@entry(eq=True)
class Table(Pointwise, Entry):
    """Linear between the points (times, values), constant outside."""

    times: Numbers
    values: Numbers

    def validate(self) -> None:
        _check_table(self.times, self.values)

    def __call__(self, t: float) -> float:
        return float(np.interp(t, self.times, self.values))


@SIGNALS.in_files("times", flag="spline")
@entry(eq=True)
class Spline(Pointwise, Entry):
    """The natural cubic spline through the points (times, values), for measured motions.

    It is the smoothest curve through them. Its second derivative is zero at both ends, beyond which
    it goes on straight, so that it drives joints without jumps of velocity or acceleration.
    """

    times: Numbers
    values: Numbers
    _pieces: Any = field(init=False, repr=False, compare=False)

    def validate(self) -> None:
        from scipy.interpolate import CubicSpline

        _check_table(self.times, self.values)
        if len(self.times) < 2:
            raise ModelError(f"a spline needs two or more points, got {len(self.times)}")
        object.__setattr__(self, "_pieces", CubicSpline(self.times, self.values, bc_type="natural"))

    def __call__(self, t: float) -> float:
        return float(self.samples(np.array(t), 0.0))

    def samples(self, t: Array, h: float) -> Array:
        within = np.clip(t, self.times[0], self.times[-1])
        values: Array = self._pieces(within) + self._pieces(within, 1) * (t - within)
        return values

    def derivatives(self, t: float) -> tuple[float, float]:
        within = float(np.clip(t, self.times[0], self.times[-1]))
        return float(self._pieces(within, 1)), float(self._pieces(within, 2))


@SIGNALS.in_files("amplitude")
@entry(eq=True)
class Harmonic(Pointwise, Entry):
    """offset + amplitude sin(2 pi frequency t + phase), frequency in Hz, phase in rad."""

    amplitude: float
    frequency: float
    phase: float = 0.0
    offset: float = 0.0

    def __call__(self, t: float) -> float:
        return float(
            self.offset + self.amplitude * np.sin(2.0 * np.pi * self.frequency * t + self.phase)
        )

    def derivatives(self, t: float) -> tuple[float, float]:
        omega = 2.0 * np.pi * self.frequency
        angle = omega * t + self.phase
        rate = self.amplitude * omega * np.cos(angle)
        return float(rate), float(-self.amplitude * omega**2 * np.sin(angle))


@SIGNALS.in_files("polynomial")
@entry(eq=True)
class Polynomial(Pointwise, Entry):
    """c_0 + c_1 t + c_2 t^2 + ..."""

    coefficients: Annotated[SomeNumbers, Key("polynomial")]

    def __call__(self, t: float) -> float:
        return float(np.polynomial.Polynomial(self.coefficients)(t))

    def derivatives(self, t: float) -> tuple[float, float]:
        polynomial = np.polynomial.Polynomial(self.coefficients)
        return float(polynomial.deriv(1)(t)), float(polynomial.deriv(2)(t))


@SIGNALS.in_files("impulse")
@entry(eq=True)
class Impulse(Entry):
    """A given area (an impulse [N s] of a force) at the step nearest to time `at`."""

    area: Annotated[float, Key("impulse")]
    at: float

    def validate(self) -> None:
        if self.at < 0.0:
            raise ModelError(f"an impulse must act at t >= 0, got at = {self.at}")

    def __call__(self, t: float) -> float:
        return float("inf") if t == self.at else 0.0

    @property
    def jumps(self) -> tuple[float, ...]:
        return (self.at,)

    def samples(self, t: Array, h: float) -> Array:
        # The hat function of a step has the area h; that of t = 0 has lost its left half.
        height = self.area / h if self.at >= 0.5 * h else 2.0 * self.area / h
        return np.where(np.round(t / h) == np.round(self.at / h), height, 0.0)


@SIGNALS.in_files("pulse")
@entry(eq=True)
class Pulse(Entry):
    """A rectangle: `value` from `start` to `end`, 0 elsewhere."""

    value: Annotated[float, Key("pulse")]
    start: Annotated[float, Key("from")]
    end: Annotated[float, Key("to")]

    def validate(self) -> None:
        if not self.start < self.end:
            raise ModelError(
                f"a pulse must end after it starts, got start = {self.start}, end = {self.end}"
            )

    def __call__(self, t: float) -> float:
        return self.value if self.start <= t < self.end else 0.0

    @property
    def jumps(self) -> tuple[float, ...]:
        return self.start, self.end

    def samples(self, t: Array, h: float) -> Array:
        return self.value * (_step_samples(self.start, t, h) - _step_samples(self.end, t, h))


@SIGNALS.in_files("input")
@entry(eq=True)
class Input(Pointwise, Entry):
    """A signal whose values a `Simulator` receives step by step, by its name.

    value: at t = 0, and always in `simulate`.
    """

    name: Annotated[str, Key("input")]
    value: float = 0.0

    def __call__(self, t: float) -> float:
        return self.value

    def derivatives(self, t: float) -> tuple[float, float]:
        return 0.0, 0.0


@entry(eq=True)
class Function(Pointwise, Entry):
    """Any Python function of time, sampled at the steps, its jumps included."""

    function: Callable[[float], float]

    def __call__(self, t: float) -> float:
        return float(self.function(t))


@entry(eq=True)
class SmoothFunction(Function):
    """A Python function of time with its first and second derivative; it can drive joints."""

    rate: Callable[[float], float]
    acceleration: Callable[[float], float]

    def derivatives(self, t: float) -> tuple[float, float]:
        return float(self.rate(t)), float(self.acceleration(t))


def jumps_of(signal: Signal) -> tuple[float, ...]:
    """The times at which a signal jumps, as far as it says so."""
    jumps: tuple[float, ...] = getattr(signal, "jumps", ())
    return jumps


def _step_samples(at: float, t: Array, h: float) -> Array:
    """Means of the unit step at time `at` over the hat functions of the time grid.

    They are centered at t, of half width h, and cut off at t = 0.
    """
    s = np.clip((t - at) / h, -1.0, 1.0)
    # the integral of the hat from -1 to s
    mean = np.where(s < 0.0, 0.5 * (1.0 + s) ** 2, 1.0 - 0.5 * (1.0 - s) ** 2)
    first = t < 0.5 * h
    after = np.clip(1.0 - at / h, 0.0, 1.0)
    return np.where(first, after**2 if at > 0.0 else 1.0, mean)


def _check_table(times: tuple[float, ...], values: tuple[float, ...]) -> None:
    if len(times) != len(values) or not times:
        raise ModelError(
            f"a signal needs as many values as times, got {len(times)} times and {len(values)} "
            "values"
        )
    if any(later <= earlier for earlier, later in pairwise(times)):
        raise ModelError(f"the times of a signal must increase, got {list(times)}")


def _class_name(value: Any) -> str:
    return type(value).__name__.lower()


def _is_a(kind: type) -> Callable[[Any], Any]:
    def store(value: Any) -> Any:
        if not isinstance(value, kind):
            raise TypeError
        return value

    return store


AnySignal = Annotated[Signal, SIGNALS, Takes("a signal such as Constant", _is_a(Signal), Any)]
DrivingSignal = Annotated[
    SmoothSignal,
    SIGNALS,
    Takes(
        "a smooth signal (constant, harmonic, polynomial, spline)",
        _is_a(SmoothSignal),
        Any,
        found=_class_name,
    ),
]
