"""Signals that are composed of others: sums, products, and signals that come later."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np

from ..arrays import Array
from ..errors import ModelError
from ..schema.entry import Entry, FieldSpec, NameInFile, entry
from ..schema.forms import Members
from .curves import Impulse, Input
from .sampling import Averaged
from .signal import (
    SIGNAL_FORMS,
    AnySignal,
    Signal,
    Smooth,
    breaks_of,
    corners_of,
    derivatives_of,
    is_any,
    is_signal,
    jumps_of,
    parts_of,
    values_of,
)


def _signals(value: Any) -> tuple[Signal, ...]:
    parts = tuple(value)
    if len(parts) < 1 or not all(map(is_signal, parts)):
        raise ValueError
    return parts


if TYPE_CHECKING:
    from ..schema.values import Converted

    Parts = Converted[tuple[Signal, ...], Iterable[Signal]]
    OptionalParts = Converted[tuple[Signal, ...] | None, Iterable[Signal] | None]
else:
    Parts = Annotated[
        tuple[Signal, ...], Members(SIGNAL_FORMS), FieldSpec("a list of signals", _signals)
    ]
    OptionalParts = Parts | None


class _Composed(Smooth, Averaged):
    """The base of signals that are composed of parts."""

    @property
    def parts(self) -> tuple[Signal, ...]:
        raise NotImplementedError

    @property
    def jumps(self) -> tuple[float, ...]:
        return self._times(jumps_of)

    @property
    def corners(self) -> tuple[float, ...]:
        return self._times(corners_of)

    @property
    def breaks(self) -> tuple[float, ...]:
        return self._times(breaks_of)

    def _times(self, times: Any) -> tuple[float, ...]:
        return tuple(sorted({time for part in self.parts for time in times(part)}))

    def values_at(self, t: Array) -> Array:
        raise NotImplementedError


@SIGNAL_FORMS.in_files("sum")
@entry(eq=True)
class Sum(_Composed, Entry):
    """The sum of signals.

    Parameters
    ----------
    signals : sequence of signals

    Examples
    --------
    >>> from duhamel.solver import Constant, Polynomial
    >>> Sum([Constant(1.0), Polynomial([0.0, 2.0])])(3.0)
    7.0
    """

    signals: Annotated[Parts, NameInFile("sum")]

    def validate(self) -> None:
        _refuse(self, "a sum", Input)

    @property
    def parts(self) -> tuple[Signal, ...]:
        return self.signals

    def values_at(self, t: Array) -> Array:
        return sum((values_of(part, t) for part in self.parts), np.zeros(t.shape))

    def samples(self, t: Array, h: float) -> Array:
        return sum((part.samples(t, h) for part in self.parts), np.zeros(t.shape))

    def slope(self, t: float) -> float:
        return sum(slope_of(part, t) for part in self.parts)

    def derivatives_at(self, t: Array) -> tuple[Array, Array]:
        rates, accelerations = zip(*(derivatives_of(part, t) for part in self.parts), strict=True)
        return sum(rates), sum(accelerations)

    def antiderivatives(self, t: Array) -> tuple[Array, Array]:
        parts: Any = self.parts
        once, twice = zip(*(part.antiderivatives(t) for part in parts), strict=True)
        return sum(once), sum(twice)


@SIGNAL_FORMS.in_files("product")
@entry(eq=True)
class Product(_Composed, Entry):
    """The product of signals, as of one and a window.

    Parameters
    ----------
    signals : sequence of signals

    Examples
    --------
    >>> from duhamel.solver import Constant, Polynomial
    >>> Product([Constant(3.0), Polynomial([0.0, 2.0])])(1.0)
    6.0
    """

    signals: Annotated[Parts, NameInFile("product")]

    def validate(self) -> None:
        _refuse(self, "a product", Input, Impulse)

    @property
    def parts(self) -> tuple[Signal, ...]:
        return self.signals

    def values_at(self, t: Array) -> Array:
        product = np.ones(t.shape)
        for part in self.parts:
            product = product * values_of(part, t)
        return product

    def slope(self, t: float) -> float:
        value, rate = 1.0, 0.0
        for part in self.parts:
            # (u v)' = u v' + u' v, factor by factor.
            factor = part(t)
            value, rate = value * factor, rate * factor + value * slope_of(part, t)
        return rate

    def derivatives_at(self, t: Array) -> tuple[Array, Array]:
        value, rate, acceleration = np.ones(t.shape), np.zeros(t.shape), np.zeros(t.shape)
        for part in self.parts:
            factor, (first, second) = values_of(part, t), derivatives_of(part, t)
            # (u v)'' = u'' v + 2 u' v' + u v''; in this order, for each line uses the values before
            # it.
            acceleration = acceleration * factor + 2.0 * rate * first + value * second
            rate = rate * factor + value * first
            value = value * factor
        return rate, acceleration


@SIGNAL_FORMS.in_files("delay")
@entry(eq=True)
class Delayed(_Composed, Entry):
    """A signal that comes later.

    Parameters
    ----------
    delay : float [s]
        Below zero: earlier.
    signal : signal

    Examples
    --------
    >>> from duhamel.solver import Polynomial
    >>> Delayed(1.0, Polynomial([0.0, 2.0]))(3.0)
    4.0
    """

    delay: float
    signal: Annotated[AnySignal, NameInFile("of")]

    def validate(self) -> None:
        _refuse(self, "a delay", Input, Impulse)

    @property
    def parts(self) -> tuple[Signal, ...]:
        return (self.signal,)

    def _times(self, times: Any) -> tuple[float, ...]:
        return tuple(time + self.delay for time in times(self.signal))

    def values_at(self, t: Array) -> Array:
        return values_of(self.signal, t - self.delay)

    def slope(self, t: float) -> float:
        return slope_of(self.signal, t - self.delay)

    def derivatives_at(self, t: Array) -> tuple[Array, Array]:
        return derivatives_of(self.signal, t - self.delay)

    def antiderivatives(self, t: Array) -> tuple[Array, Array]:
        signal: Any = self.signal
        once, twice = signal.antiderivatives(t - self.delay)
        return once, twice


def slope_of(signal: Signal, t: float) -> float:
    """The derivative of a signal without jumps, at a corner that after it."""
    given: Any = signal
    # `slope` is defined at corners too, where second derivatives are not.
    return float(given.slope(t) if hasattr(given, "slope") else given.derivatives(t)[0])


def has_slope(signal: Signal) -> bool:
    """True for a signal that is continuous, and says how fast it changes."""
    parts = parts_of(signal)
    # A jump of a factor jumps in a product, even if the others are continuous.
    if jumps_of(signal):
        return False
    if parts:
        return all(map(has_slope, parts))
    return hasattr(signal, "slope") or hasattr(signal, "derivatives")


def _refuse(signal: Signal, what: str, *kinds: type) -> None:
    for kind in kinds:
        if is_any(signal, kind):
            name = {Input: "an input", Impulse: "an impulse"}[kind]
            raise ModelError(f"{name} cannot be part of {what}")
