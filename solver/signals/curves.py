"""Signals of simple curves: constants, steps, tables, splines, harmonics, polynomials, pulses."""

from collections.abc import Callable
from dataclasses import field
from functools import cached_property
from itertools import pairwise
from typing import Annotated, Any

import numpy as np

from ..arrays import Array
from ..errors import ModelError
from ..schema.entry import LARGEST_NUMBER, Entry, NameInFile, entry
from ..schema.values import Numbers, SomeNumbers
from . import pieces
from .harmonics import harmonic_integrals
from .pieces import Pieces
from .signal import SIGNAL_FORMS, Pointwise, Smooth


class Piecewise(Pointwise):
    """Signals that are polynomials between times."""

    @property
    def pieces(self) -> Pieces:
        raise NotImplementedError

    @cached_property
    def _integrals(self) -> tuple[Pieces, Pieces]:
        once = self.pieces.antiderivative()
        return once, once.antiderivative()

    def values_at(self, t: Array) -> Array:
        return self.pieces(t)

    def antiderivatives(self, t: Array) -> tuple[Array, Array]:
        """A first and a second antiderivative at times t, of any shape."""
        once, twice = self._integrals
        return once(t), twice(t)


@SIGNAL_FORMS.bare_number
@entry(eq=True)
class Constant(Smooth, Pointwise, Entry):
    """A constant value.

    Parameters
    ----------
    value : float
        In the unit of what follows the signal, as in all signals.

    Examples
    --------
    >>> Constant(3.0)(0.5)
    3.0
    """

    value: float

    def values_at(self, t: Array) -> Array:
        return np.full(t.shape, self.value)

    def antiderivatives(self, t: Array) -> tuple[Array, Array]:
        return self.value * t, 0.5 * self.value * t**2

    def derivatives_at(self, t: Array) -> tuple[Array, Array]:
        return np.zeros(t.shape), np.zeros(t.shape)


@SIGNAL_FORMS.in_files("times")
@entry(eq=True)
class Steps(Piecewise, Entry):
    """A staircase: values[i] from times[i] on, 0 before the first.

    Parameters
    ----------
    times : (n,) [s]
        Ascending.
    values : (n,)

    Examples
    --------
    >>> Steps([0.0, 1.0], [2.0, 5.0])(0.5)
    2.0
    """

    times: Numbers
    values: Numbers

    def validate(self) -> None:
        _check_table(self.times, self.values)

    @property
    def jumps(self) -> tuple[float, ...]:
        return self.times

    @cached_property
    def pieces(self) -> Pieces:
        return pieces.steps(self.times, self.values)

    def samples(self, t: Array, h: float) -> Array:
        # A staircase is a sum of unit steps, whose means over hats have a closed form.
        jumps = np.diff(self.values, prepend=0.0)
        return sum(
            (
                jump * _step_samples(time, t, h)
                for time, jump in zip(self.times, jumps, strict=True)
            ),
            np.zeros_like(t),
        )


@SIGNAL_FORMS.in_files("times", flag="linear")
@entry(eq=True)
class Table(Piecewise, Entry):
    """A table: linear between the points, constant outside.

    Parameters
    ----------
    times : (n,) [s]
        Ascending.
    values : (n,)

    Examples
    --------
    >>> Table([0.0, 1.0], [0.0, 4.0])(0.25)
    1.0
    """

    times: Numbers
    values: Numbers

    def validate(self) -> None:
        _check_table(self.times, self.values)

    def values_at(self, t: Array) -> Array:
        return np.interp(t, self.times, self.values)

    @property
    def breaks(self) -> tuple[float, ...]:
        return self.times

    @cached_property
    def pieces(self) -> Pieces:
        return pieces.lines(self.times, self.values)

    def slope(self, t: float) -> float:
        """The derivative, at a point that after it."""
        return float(self.pieces.derivative()(np.array(t)))


@SIGNAL_FORMS.in_files("times", flag="spline")
@entry(eq=True)
class Spline(Smooth, Piecewise, Entry):
    """The natural cubic spline through points, for measured motions.

    It is the smoothest curve through them. Its second derivative is zero at both ends, beyond which
    it continues straight, so that it drives joints without jumps of velocity or acceleration.

    Parameters
    ----------
    times : (n,) [s]
        Ascending.
    values : (n,)

    Examples
    --------
    >>> Spline([0.0, 1.0, 2.0], [0.0, 1.0, 0.0])(1.0)
    1.0
    """

    times: Numbers
    values: Numbers
    _spline: Any = field(init=False, repr=False, compare=False)

    def validate(self) -> None:
        # scipy.interpolate takes long to load, and most models have no spline.
        from scipy.interpolate import CubicSpline

        _check_table(self.times, self.values)
        if len(self.times) < 2:
            raise ModelError(f"a spline needs two or more points, got {len(self.times)}")
        try:
            with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
                spline = CubicSpline(self.times, self.values, bc_type="natural")
        except (ValueError, np.linalg.LinAlgError) as error:
            raise _too_steep(self.times) from error
        # Times a few roundings apart make curvatures overflow without an error of scipy's.
        if not np.isfinite(spline.c).all():
            raise _too_steep(self.times)
        object.__setattr__(self, "_spline", spline)

    def values_at(self, t: Array) -> Array:
        within = np.clip(t, self.times[0], self.times[-1])
        values: Array = self._spline(within) + self._spline(within, 1) * (t - within)
        return values

    @property
    def breaks(self) -> tuple[float, ...]:
        return self.times

    @cached_property
    def pieces(self) -> Pieces:
        return pieces.cubics(self.times, self._spline.c)

    def derivatives_at(self, t: Array) -> tuple[Array, Array]:
        within = np.clip(t, self.times[0], self.times[-1])
        return self._spline(within, 1), self._spline(within, 2)


@SIGNAL_FORMS.in_files("amplitude")
@entry(eq=True)
class Harmonic(Smooth, Pointwise, Entry):
    """A sine: offset + amplitude sin(2 pi frequency t + phase).

    Parameters
    ----------
    amplitude : float
    frequency : float [Hz]
    phase : float [rad]
    offset : float

    Examples
    --------
    >>> round(Harmonic(2.0, frequency=1.0)(0.25), 6)
    2.0
    """

    amplitude: float
    frequency: float
    phase: float = 0.0
    offset: float = 0.0

    def derivatives_at(self, t: Array) -> tuple[Array, Array]:
        omega = 2.0 * np.pi * self.frequency
        angle = omega * t + self.phase
        rate = self.amplitude * omega * np.cos(angle)
        return rate, -self.amplitude * omega**2 * np.sin(angle)

    def values_at(self, t: Array) -> Array:
        return self.offset + self.amplitude * np.sin(2.0 * np.pi * self.frequency * t + self.phase)

    def antiderivatives(self, t: Array) -> tuple[Array, Array]:
        once, twice = harmonic_integrals(t, 2.0 * np.pi * self.frequency, self.phase)
        return (
            self.offset * t + self.amplitude * once,
            0.5 * self.offset * t**2 + self.amplitude * twice,
        )


@SIGNAL_FORMS.in_files("polynomial")
@entry(eq=True)
class Polynomial(Smooth, Piecewise, Entry):
    """A polynomial in time: c_0 + c_1 t + c_2 t^2 + ...

    Parameters
    ----------
    coefficients : (n,)
        c_k [unit/s^k].

    Examples
    --------
    >>> Polynomial([1.0, 2.0])(3.0)
    7.0
    """

    coefficients: Annotated[SomeNumbers, NameInFile("polynomial")]

    def derivatives_at(self, t: Array) -> tuple[Array, Array]:
        rate = self.pieces.derivative()
        return rate(t), rate.derivative()(t)

    @cached_property
    def pieces(self) -> Pieces:
        # One polynomial for all times; `Pieces` needs a knot, and the same on both sides of it.
        return Pieces([0.0], np.array([self.coefficients, self.coefficients]))


@SIGNAL_FORMS.in_files("impulse")
@entry(eq=True)
class Impulse(Entry):
    """A given area, concentrated at the step nearest to a time.

    Parameters
    ----------
    area : float
        Of a force the impulse [N s].
    at : float [s]

    Examples
    --------
    Its samples times the step have that area:

    >>> float(0.1 * Impulse(3.0, at=0.2).samples(np.arange(5) * 0.1, 0.1).sum().round(6))
    3.0
    """

    area: Annotated[float, NameInFile("impulse")]
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


@SIGNAL_FORMS.in_files("pulse")
@entry(eq=True)
class Pulse(Piecewise, Entry):
    """A rectangular pulse: `value` from `start` to `end`, 0 elsewhere.

    Parameters
    ----------
    value : float
    start, end : float [s]

    Examples
    --------
    >>> Pulse(5.0, start=1.0, end=2.0)(1.5)
    5.0
    """

    value: Annotated[float, NameInFile("pulse")]
    start: Annotated[float, NameInFile("from")]
    end: Annotated[float, NameInFile("to")]

    def validate(self) -> None:
        if not self.start < self.end:
            raise ModelError(
                f"a pulse must end after it starts, got start = {self.start}, end = {self.end}"
            )

    @property
    def jumps(self) -> tuple[float, ...]:
        return self.start, self.end

    @cached_property
    def pieces(self) -> Pieces:
        return pieces.steps([self.start, self.end], [self.value, 0.0])

    def samples(self, t: Array, h: float) -> Array:
        return self.value * (_step_samples(self.start, t, h) - _step_samples(self.end, t, h))


@SIGNAL_FORMS.in_files("input")
@entry(eq=True)
class Input(Smooth, Pointwise, Entry):
    """A signal whose values a `Simulator` receives step by step.

    Parameters
    ----------
    name : str
        By which `Simulator.inputs` lists it.
    value : float
        At t = 0, and always in `simulate`.

    Examples
    --------
    >>> Input("torque", value=0.5)(0.0)
    0.5
    """

    name: Annotated[str, NameInFile("input")]
    value: float = 0.0

    def values_at(self, t: Array) -> Array:
        return np.full(t.shape, self.value)

    def derivatives_at(self, t: Array) -> tuple[Array, Array]:
        return np.zeros(t.shape), np.zeros(t.shape)


@entry(eq=True)
class Function(Pointwise, Entry):
    """Any Python function of time, sampled at the steps, its jumps included.

    Parameters
    ----------
    function : callable
        Of the time [s].
    vectorized : bool
        The function takes an array of times and returns an array of values, of many steps at once.

    Examples
    --------
    >>> Function(lambda t: 2.0 * t)(3.0)
    6.0
    """

    function: Callable[[Any], Any]
    vectorized: bool = field(default=False, kw_only=True)

    def values_at(self, t: Array) -> Array:
        return self._called(self.function, t)

    def _called(self, function: Callable[[Any], Any], t: Array) -> Array:
        """The values of a function at times t, of any shape."""
        if not self.vectorized:
            # Plain floats: a user's function may call `math`.
            return np.array([float(function(time)) for time in t.ravel().tolist()]).reshape(t.shape)
        # A function that returns one number would be broadcast unnoticed: its shape is checked.
        values = np.asarray(function(t.ravel()), dtype=np.float64)
        if values.shape != (t.size,):
            raise ModelError(
                f"a function of `vectorized = True`: expected {t.size} values at {t.size} times, "
                f"got an array of shape {values.shape}"
            )
        return values.reshape(t.shape)


@entry(eq=True)
class SmoothFunction(Smooth, Function):
    """A Python function of time with its first and second derivative; it can drive joints.

    Parameters
    ----------
    function, rate, acceleration : callable
        Of the time [s].
    vectorized : bool
        The functions take and return arrays.

    Examples
    --------
    >>> square = SmoothFunction(lambda t: t**2, rate=lambda t: 2.0 * t, acceleration=lambda t: 2.0)
    >>> square.derivatives(3.0)
    (6.0, 2.0)
    """

    rate: Callable[[Any], Any]
    acceleration: Callable[[Any], Any]

    def derivatives_at(self, t: Array) -> tuple[Array, Array]:
        return self._called(self.rate, t), self._called(self.acceleration, t)


def _step_samples(at: float, t: Array, h: float) -> Array:
    """Means of the unit step at time `at` over the hat functions of the time grid.

    They are centered at t, of half width h, and cut off at t = 0.
    """
    s = np.clip((t - at) / h, -1.0, 1.0)
    # the integral of the hat from -1 to s
    mean = np.where(s < 0.0, 0.5 * (1.0 + s) ** 2, 1.0 - 0.5 * (1.0 - s) ** 2)
    # The hat of t = 0 has its right half alone.
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
    with np.errstate(over="ignore"):
        slopes = np.diff(values) / np.diff(times)
    if not (np.abs(slopes) <= LARGEST_NUMBER).all():
        raise _too_steep(times)


def _too_steep(times: tuple[float, ...]) -> ModelError:
    """The error of a curve whose slope or curvature is no number, or none that can be used."""
    # The closest two times are the likeliest cause.
    first = int(np.argmin(np.diff(times)))
    return ModelError(
        "the times of a signal are too close for its values: expected slopes and curvatures up to "
        f"{LARGEST_NUMBER:g}, got times {times[first]!r} and {times[first + 1]!r}"
    )
