"""Profiles: smooth steps, pulses and windows, each over a given time, and chirps.

Their samples are their means over the hat functions of the time grid, so that the area under a load
is exact however short they are. Ones without jumps of velocity have `derivatives`, and drive.
"""

from typing import Annotated, Any

import numpy as np

from ..arrays import Array
from ..errors import ModelError
from ..schema.entry import Entry, FieldSpec, NameInFile, entry
from ..schema.values import NotNegative, Positive, reals
from .sampling import Averaged
from .shapes import Shape, half_wave, quintic, raised_cosine, ramp, rise
from .signal import SIGNAL_FORMS, Pointwise, Smooth


def _pair(value: Any) -> tuple[float, float]:
    numbers = reals(value)
    if numbers.shape != (2,):
        raise ValueError
    return float(numbers[0]), float(numbers[1])


def _span(value: Any) -> tuple[float, float]:
    start, end = _pair(value)
    if not start < end:
        raise ValueError
    return start, end


def _positive_pair(value: Any) -> tuple[float, float]:
    first, second = _pair(value)
    if not min(first, second) > 0.0:
        raise ValueError
    return first, second


_Two = tuple[float, float]
FromTo = Annotated[_Two, FieldSpec("two numbers, from and to", _pair, _Two)]
Span = Annotated[_Two, FieldSpec("two times, start and end", _span, _Two)]
_FREQUENCIES = "two positive frequencies, from and to"
Frequencies = Annotated[_Two, FieldSpec(_FREQUENCIES, _positive_pair, _Two)]


class Profile(Averaged):
    """A signal that changes between a few times, its corners, alone."""

    def terms(self, t: Array) -> Array:
        """Values, first and second derivatives, first and second antiderivatives (5, ...)."""
        raise NotImplementedError

    def values_at(self, t: Array) -> Array:
        values: Array = self.terms(t)[0]
        return values

    def antiderivatives(self, t: Array) -> tuple[Array, Array]:
        """A first and a second antiderivative at times t, of any shape."""
        *_, once, twice = self.terms(t)
        return once, twice

    def slope(self, t: float) -> float:
        """The derivative, at a corner that after it."""
        return float(self.terms(np.array(t))[1])


class SmoothProfile(Smooth, Profile):
    """A profile without jumps of its derivative, which can drive joints."""

    def derivatives_at(self, t: Array) -> tuple[Array, Array]:
        _, rate, acceleration, *_ = self.terms(t)
        return rate, acceleration


@entry(eq=True)
class _Step(SmoothProfile, Entry):
    """A step from one value to another over a time."""

    values: Annotated[FromTo, NameInFile("smooth_step")]
    over: Span

    # Subclasses may have another one.
    shape = staticmethod(quintic)

    @property
    def corners(self) -> tuple[float, ...]:
        return self.over

    def terms(self, t: Array) -> Array:
        (before, after), (start, end) = self.values, self.over
        terms = (after - before) * rise(self.shape, t, start, end - start)
        # Value and both antiderivatives of the constant; its derivatives are zero.
        terms[0] += before
        terms[3] += before * t
        terms[4] += 0.5 * before * t**2
        return terms


@SIGNAL_FORMS.in_files("smooth_step")
@entry(eq=True)
class SmoothStep(_Step):
    """A step from one value to another by 10 x^3 - 15 x^4 + 6 x^5.

    Rate and acceleration are zero at both ends. The largest rate is 15/8 of the change over the
    duration, the largest acceleration 10/sqrt(3) of the change over its square.

    Parameters
    ----------
    values : (2,)
        Before and after the step.
    over : (2,) [s]
        Its begin and end.

    Examples
    --------
    >>> SmoothStep((0.0, 2.0), over=(0.0, 1.0))(0.5)
    1.0
    """


@SIGNAL_FORMS.in_files("smooth_step", flag="haversine")
@entry(eq=True)
class Haversine(_Step):
    """A step from one value to another by (1 - cos(pi x)) / 2.

    The rate is zero at both ends, where the acceleration jumps.

    Parameters
    ----------
    values : (2,)
        Before and after the step.
    over : (2,) [s]
        Its begin and end.

    Examples
    --------
    >>> round(Haversine((0.0, 2.0), over=(0.0, 1.0))(0.5), 6)
    1.0
    """

    shape = staticmethod(raised_cosine)


@SIGNAL_FORMS.in_files("half_sine")
@entry(eq=True)
class HalfSine(Profile, Entry):
    """Half a sine: peak sin(pi (t - start) / duration) during `duration`, 0 elsewhere.

    Parameters
    ----------
    peak : float
    duration, start : float [s]

    Examples
    --------
    >>> HalfSine(200.0, duration=1e-3)(0.5e-3)
    200.0
    """

    peak: Annotated[float, NameInFile("half_sine")]
    duration: Positive
    start: Annotated[float, NameInFile("from")] = 0.0

    @property
    def corners(self) -> tuple[float, ...]:
        return self.start, self.start + self.duration

    def terms(self, t: Array) -> Array:
        return self.peak * rise(half_wave, t, self.start, self.duration)


@SIGNAL_FORMS.in_files("trapezoid")
@entry(eq=True)
class Trapezoid(Profile, Entry):
    """A pulse with straight flanks, 0 elsewhere.

    Parameters
    ----------
    peak : float
    duration : float [s]
        Of the whole pulse.
    rise, fall : float [s]
        Of its first and last flank.
    start : float [s]

    Examples
    --------
    >>> Trapezoid(8.0, duration=4.0, rise=1.0, fall=1.0)(0.5)
    4.0
    """

    peak: Annotated[float, NameInFile("trapezoid")]
    duration: Positive
    rise: NotNegative
    fall: NotNegative
    start: Annotated[float, NameInFile("from")] = 0.0

    def validate(self) -> None:
        _check_flanks("a trapezoid", self.duration, self.rise, self.fall)

    @property
    def corners(self) -> tuple[float, ...]:
        end = self.start + self.duration
        return self.start, self.start + self.rise, end - self.fall, end

    @property
    def jumps(self) -> tuple[float, ...]:
        ends = ((self.start, self.rise), (self.start + self.duration, self.fall))
        return tuple(time for time, flank in ends if flank == 0.0)

    def terms(self, t: Array) -> Array:
        return self.peak * _between(ramp, t, self)


@SIGNAL_FORMS.in_files("sawtooth")
@entry(eq=True)
class Sawtooth(Profile, Entry):
    """A terminal-peak sawtooth: from 0 straight to `peak` at the end of `duration`, then 0.

    Parameters
    ----------
    peak : float
    duration, start : float [s]

    Examples
    --------
    >>> Sawtooth(10.0, duration=2.0)(0.5)
    2.5
    """

    peak: Annotated[float, NameInFile("sawtooth")]
    duration: Positive
    start: Annotated[float, NameInFile("from")] = 0.0

    @property
    def corners(self) -> tuple[float, ...]:
        return self.start, self.start + self.duration

    @property
    def jumps(self) -> tuple[float, ...]:
        return (self.start + self.duration,)

    def terms(self, t: Array) -> Array:
        end = self.start + self.duration
        terms: Array = rise(ramp, t, self.start, self.duration) - rise(ramp, t, end, 0.0)
        return self.peak * terms


@SIGNAL_FORMS.in_files("window")
@entry(eq=True)
class Window(SmoothProfile, Entry):
    """1 during a time, 0 elsewhere, with smooth steps within it, as a factor of a product.

    Parameters
    ----------
    over : (2,) [s]
        Begin and end.
    rise, fall : float [s]
        Durations of the steps.

    Examples
    --------
    >>> Window((0.0, 4.0), rise=1.0, fall=1.0)(0.5)
    0.5
    """

    over: Annotated[Span, NameInFile("window")]
    rise: Positive
    fall: Positive

    def validate(self) -> None:
        _check_flanks("a window", self.duration, self.rise, self.fall)

    @property
    def start(self) -> float:
        return self.over[0]

    @property
    def duration(self) -> float:
        return self.over[1] - self.over[0]

    @property
    def corners(self) -> tuple[float, ...]:
        start, end = self.over
        return start, start + self.rise, end - self.fall, end

    def terms(self, t: Array) -> Array:
        return _between(quintic, t, self)


def _between(shape: Shape, t: Array, pulse: "Trapezoid | Window") -> Array:
    """Up at the start of a pulse, down at its end."""
    down = pulse.start + pulse.duration - pulse.fall
    terms: Array = rise(shape, t, pulse.start, pulse.rise) - rise(shape, t, down, pulse.fall)
    return terms


def _check_flanks(what: str, duration: float, rise: float, fall: float) -> None:
    # Sums of decimal fractions, 0.1 + 0.2 for 0.3, exceed by rounding.
    if rise + fall > duration * (1.0 + 1e-12):
        raise ModelError(
            f"{what} must last as long as its rise and fall, got duration = {duration}, "
            f"rise = {rise}, fall = {fall}"
        )


@entry(eq=True)
class _Chirp(Smooth, Pointwise, Entry):
    """amplitude sin(angle(t)), of a frequency that changes over a time and is constant outside."""

    amplitude: Annotated[float, NameInFile("chirp")]
    frequencies: Frequencies
    over: Span
    phase: float = 0.0

    @property
    def breaks(self) -> tuple[float, ...]:
        return self.over

    @property
    def highest_frequency(self) -> float:
        """The highest frequency [Hz]."""
        return max(self.frequencies)

    def values_at(self, t: Array) -> Array:
        values: Array = self.amplitude * np.sin(self._angles(t)[0])
        return values

    def derivatives_at(self, t: Array) -> tuple[Array, Array]:
        angle, omega, change = self._angles(t)
        sine, cosine = np.sin(angle), np.cos(angle)
        rate = self.amplitude * omega * cosine
        return rate, self.amplitude * (change * cosine - omega**2 * sine)

    def _angles(self, t: Array) -> tuple[Array, Array, Array]:
        """The angle [rad], its rate and its acceleration."""
        (start, end), (first, last) = self.over, self.frequencies
        within, beyond = np.clip(t, start, end) - start, np.maximum(t - end, 0.0)
        turns, frequency, change = self._sweep(within)
        # The frequency is constant outside, so that phase and rate stay continuous.
        turns = turns + first * np.minimum(t - start, 0.0) + last * beyond
        inside = (t >= start) & (t < end)
        rates = frequency, np.where(inside, change, 0.0)
        omega, acceleration = (2.0 * np.pi * values for values in rates)
        return 2.0 * np.pi * turns + self.phase, omega, acceleration

    def _sweep(self, x: Array) -> tuple[Array, Array, Array]:
        """Turns, frequency [Hz] and its change a time x after the start."""
        raise NotImplementedError


@SIGNAL_FORMS.in_files("chirp")
@entry(eq=True)
class Chirp(_Chirp):
    """A sine whose frequency changes in proportion to time; constant outside.

    Parameters
    ----------
    amplitude : float
    frequencies : (2,) [Hz]
        At the begin and at the end.
    over : (2,) [s]
        Begin and end.
    phase : float [rad]
        At the begin.

    Examples
    --------
    >>> round(Chirp(2.0, frequencies=(1.0, 3.0), over=(0.0, 1.0))(0.5), 6)
    -2.0
    """

    def _sweep(self, x: Array) -> tuple[Array, Array, Array]:
        (start, end), (first, last) = self.over, self.frequencies
        change = (last - first) / (end - start)
        return (first + 0.5 * change * x) * x, first + change * x, np.full(x.shape, change)


@SIGNAL_FORMS.in_files("chirp", flag="logarithmic")
@entry(eq=True)
class LogarithmicChirp(_Chirp):
    """A sine whose frequency changes by so many octaves a second; constant outside.

    Parameters
    ----------
    amplitude : float
    frequencies : (2,) [Hz]
        At the begin and at the end.
    over : (2,) [s]
        Begin and end.
    phase : float [rad]
        At the begin.

    Examples
    --------
    >>> LogarithmicChirp(2.0, frequencies=(1.0, 4.0), over=(0.0, 1.0))(0.0)
    0.0
    """

    def _sweep(self, x: Array) -> tuple[Array, Array, Array]:
        (start, end), (first, last) = self.over, self.frequencies
        rate = np.log(last / first) / (end - start)
        frequency = first * np.exp(rate * x)
        # expm1: at slow rates the difference of two exponentials would cancel.
        turns = first * np.expm1(rate * x) / rate if rate != 0.0 else first * x
        return turns, frequency, rate * frequency
