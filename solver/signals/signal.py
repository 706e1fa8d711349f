"""Functions of time that drive loads and joints: what they have in common.

A signal is called with a time, `signal(t)`, and is sampled for the integrator at the time steps.
About its corners, its jumps among them, the samples are means over the hat functions of the
time grid, so that the area under a load is exact wherever they fall between two steps; elsewhere
they are its values. The signals themselves are in curves.py, profiles.py, noise.py, recorded.py and
composed.py.
"""

from collections.abc import Callable
from typing import Annotated, Any, Protocol, runtime_checkable

import numpy as np

from ..arrays import Array
from ..schema.entry import FieldSpec
from ..schema.forms import Family


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


SIGNAL_FORMS = Family("signal")


class Pointwise:
    """Signals that are sampled by their values.

    A class has `values_at(t)` for times of any shape, or else a `__call__` of its own.
    """

    def __call__(self, t: float) -> float:
        return float(values_of(self, np.array(t)))

    def samples(self, t: Array, h: float) -> Array:
        return values_of(self, t)


class Smooth:
    """Signals with derivatives at many times at once."""

    def derivatives_at(self, t: Array) -> tuple[Array, Array]:
        """The first and second derivative at times t, of any shape."""
        raise NotImplementedError

    def derivatives(self, t: float) -> tuple[float, float]:
        rate, acceleration = self.derivatives_at(np.array(t))
        return float(rate), float(acceleration)


# What signals may say beyond the protocol, and what is taken for granted where they do not.


def values_of(signal: Signal, t: Array) -> Array:
    """The values at times t, of any shape."""
    if hasattr(signal, "values_at"):
        values: Array = signal.values_at(t)
        return values
    # Signals of users need the protocol alone: one time after the other.
    return np.array([signal(time) for time in t.ravel().tolist()]).reshape(t.shape)


def derivatives_of(signal: Any, t: Array) -> tuple[Array, Array]:
    """The first and second derivative of a smooth signal at times t, of any shape."""
    if hasattr(signal, "derivatives_at"):
        rate, acceleration = signal.derivatives_at(t)
        return rate, acceleration
    both = np.array([signal.derivatives(time) for time in t.ravel().tolist()]).reshape(-1, 2)
    return both[:, 0].reshape(t.shape), both[:, 1].reshape(t.shape)


def parts_of(signal: Signal) -> tuple[Signal, ...]:
    """The signals that a signal is composed of; none of a signal that stands for itself."""
    parts: tuple[Signal, ...] = getattr(signal, "parts", ())
    return parts


def is_any(signal: Signal, kind: type) -> bool:
    """True for a signal of a kind, or one with such a part."""
    return isinstance(signal, kind) or any(is_any(part, kind) for part in parts_of(signal))


def is_smooth(signal: Any) -> bool:
    """True for a `SmoothSignal` whose parts are smooth too."""
    # A class has these methods too: `Harmonic` in place of `Harmonic(...)` is a common slip.
    instance = isinstance(signal, SmoothSignal) and not isinstance(signal, type)
    return instance and all(map(is_smooth, parts_of(signal)))


def jumps_of(signal: Signal) -> tuple[float, ...]:
    """The times at which a signal jumps, as far as it says so."""
    jumps: tuple[float, ...] = getattr(signal, "jumps", ())
    return jumps


def corners_of(signal: Signal) -> tuple[float, ...]:
    """The times about which samples are means: jumps, and the ends of profiles."""
    corners: tuple[float, ...] = getattr(signal, "corners", jumps_of(signal))
    return corners


def breaks_of(signal: Signal) -> tuple[float, ...]:
    """The times at which a signal or one of its derivatives jumps, as far as it says so."""
    breaks: tuple[float, ...] = getattr(signal, "breaks", corners_of(signal))
    return breaks


def _class_name(value: Any) -> str:
    return type(value).__name__.lower()


def _that(holds: Callable[[Any], bool]) -> Callable[[Any], Any]:
    def store(value: Any) -> Any:
        if not holds(value):
            raise TypeError
        return value

    return store


def is_signal(value: Any) -> bool:
    return isinstance(value, Signal) and not isinstance(value, type)


AnySignal = Annotated[
    Signal, SIGNAL_FORMS, FieldSpec("a signal such as Constant", _that(is_signal))
]
DrivingSignal = Annotated[
    SmoothSignal,
    SIGNAL_FORMS,
    FieldSpec(
        "a smooth signal (constant, harmonic, polynomial, spline, smooth step, chirp, noise, or of "
        "such parts)",
        _that(is_smooth),
        found=_class_name,
    ),
]
