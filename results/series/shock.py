"""Shock response spectra: what a shock does to oscillators of all frequencies on its base."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...files.arrays import Array, Complex
from ..errors import SeriesError
from .sampling import Sampled, sampled

# Absolute acceleration; equivalent static acceleration; pseudo-velocity; relative displacement.
RESPONSE_KINDS = ("absolute", "static", "pseudo-velocity", "displacement")
EXTREME_KINDS = ("maximax", "positive", "negative")
RESPONSE_SPANS = ("overall", "primary", "residual")
# MIL-STD-810 asks for ten samples in a period of the highest frequency.
MIN_SAMPLES_PER_PERIOD = 10.0
# Looking at the response as often finds its extremes to 0.12 %.
INSTANTS_PER_PERIOD = 64.0
# [Hz]. All spectra have it, so that those of different runs share their frequencies.
SPECTRUM_REFERENCE_FREQUENCY = 1000.0
# [Hz], where the frequencies begin unless the caller says otherwise.
DEFAULT_MIN_FREQUENCY = 5.0
MAX_SPECTRUM_FREQUENCIES = 10_000
# Of |p|: below it (e^p - 1 - p) / p^2 loses digits by cancellation, and is summed as a series.
MAX_SERIES_ARGUMENT = 0.5


@dataclass(frozen=True, eq=False)
class ShockSpectrum:
    """A shock response spectrum, see `shock_spectrum` for an example.

    Parameters
    ----------
    frequency : (m,) [Hz]
        Undamped natural frequencies of the oscillators.
    values : (m,) or (m, k)
        The largest responses.
    Q : float
        The quality factor of the oscillators, 1 / (2 zeta); infinite without damping.
    """

    frequency: Array
    values: Array
    Q: float


def octave_frequencies(lowest: float, highest: float, per_octave: int = 12) -> Array:
    """List the frequencies 1000 Hz * 2^(k / per_octave) between two frequencies.

    Twelve in an octave, from 5 to 2000 Hz, are those of MIL-STD-810, Method 516.

    Parameters
    ----------
    lowest, highest : float [Hz]
    per_octave : int

    Returns
    -------
    (m,) [Hz]

    Raises
    ------
    SeriesError
        Where there is none, or more than 10 000.

    Examples
    --------
    >>> octave_frequencies(200.0, 2000.0, per_octave=1).tolist()
    [250.0, 500.0, 1000.0, 2000.0]
    """
    if not (0.0 < lowest < highest < math.inf):
        raise SeriesError(
            f"expected frequencies 0 < from < to, found from {lowest:.6g} to {highest:.6g} Hz"
        )
    if per_octave < 1 or per_octave * math.log2(highest / lowest) > MAX_SPECTRUM_FREQUENCIES:
        raise SeriesError(
            f"per_octave: expected 1 or more, and at most {MAX_SPECTRUM_FREQUENCIES} frequencies, "
            f"found {per_octave}"
        )
    first = math.ceil(per_octave * math.log2(lowest / SPECTRUM_REFERENCE_FREQUENCY) - 1e-9)
    last = math.floor(per_octave * math.log2(highest / SPECTRUM_REFERENCE_FREQUENCY) + 1e-9)
    found: Array = SPECTRUM_REFERENCE_FREQUENCY * 2.0 ** (np.arange(first, last + 1) / per_octave)
    if not len(found):
        raise SeriesError(
            f"from {lowest:.6g} to {highest:.6g} Hz: found no frequency of 1000 Hz * "
            f"2^(k/{per_octave}) there"
        )
    return found


def shock_spectrum(
    time: Array,
    acceleration: Array,
    frequencies: Array | None = None,
    *,
    q: float = 10.0,
    response: str = "absolute",
    extreme: str = "maximax",
    span: str = "overall",
) -> ShockSpectrum:
    """Compute the shock response spectrum of an acceleration of the base.

        z'' + (omega / Q) z' + omega^2 z = -a        z: motion relative to the base

    The oscillators are at rest before the series; it is a line between its samples, and zero after
    the last. Their motion under it is exact (the ramp invariant filter of Smallwood), and so is the
    vibration after its end. Source: Smallwood, An improved recursive formula for calculating shock
    response spectra, Shock and Vibration Bulletin 51 (1981); ISO 18431-4; docs/spectra.md.

    Parameters
    ----------
    time : (n,) [s]
    acceleration : (n,) or (n, k) [m/s^2]
        One series a column.
    frequencies : (m,) [Hz], optional
        Natural frequencies; by default twelve in an octave, from 5 Hz to a tenth of the sampling
        rate.
    q : float
        The quality factor Q = 1 / (2 zeta) of the oscillators.
    response : {"absolute", "static", "pseudo-velocity", "displacement"}
        The acceleration of the mass z'' + a [m/s^2]; omega^2 z, which times the mass is the force
        in the spring [m/s^2]; omega z [m/s]; or z [m]. All are positive where the spring pushes the
        mass in the direction of the axis.
    extreme : {"maximax", "positive", "negative"}
        The largest value without sign, the largest, or the smallest one; the zero at the start
        counts.
    span : {"overall", "primary", "residual"}
        The whole time, the time of the series, or the time after its end.

    Returns
    -------
    ShockSpectrum

    Raises
    ------
    SeriesError
        For frequencies above a tenth of the sampling rate, where the line between samples misses
        3 % of a vibration, and for words or a q that are not allowed.

    Examples
    --------
    A step of the acceleration doubles the static response of an undamped oscillator:

    >>> import numpy as np
    >>> time = np.linspace(0.0, 1.0, 1001)
    >>> step = np.full(1001, 3.0)
    >>> spectrum = shock_spectrum(time, step, np.array([10.0]), q=np.inf, span="primary")
    >>> spectrum.values.round(2).tolist()
    [6.0]
    """
    _check_choices(response, extreme, span)
    if not q > 0.5:
        raise SeriesError(f"q: expected a quality factor above 0.5, found {q:.6g}")
    series = sampled(time, acceleration)
    frequencies = _frequencies(series, frequencies)
    columns = series.values.reshape(len(series.time), -1)
    found = np.array(
        [
            [_extremes(series.step, column, f, q, response, span) for column in columns.T]
            for f in frequencies.tolist()
        ]
    )
    low, high = found[..., 0], found[..., 1]
    values = {"maximax": np.maximum(high, np.abs(low)), "positive": high, "negative": low}[extreme]
    return ShockSpectrum(frequencies, values.reshape(len(frequencies), *series.values.shape[1:]), q)


def _frequencies(series: Sampled, frequencies: Array | None) -> Array:
    highest = 1.0 / (MIN_SAMPLES_PER_PERIOD * series.coarsest)
    if frequencies is None:
        if highest <= DEFAULT_MIN_FREQUENCY:
            raise SeriesError(
                "expected steps below "
                f"{1.0 / (MIN_SAMPLES_PER_PERIOD * DEFAULT_MIN_FREQUENCY):.3g} s for oscillators "
                f"from {DEFAULT_MIN_FREQUENCY:g} Hz on, found {series.coarsest:.6g} s: give lower "
                "frequencies"
            )
        return octave_frequencies(DEFAULT_MIN_FREQUENCY, highest)
    frequencies = np.atleast_1d(np.asarray(frequencies, dtype=float))
    if frequencies.ndim != 1 or not frequencies.size or not (frequencies > 0.0).all():
        raise SeriesError("expected frequencies (m,), one or more, above zero")
    if (top := float(frequencies.max())) > (1.0 + 1e-9) * highest:
        raise SeriesError(
            f"{top:.6g} Hz: expected frequencies up to {highest:.6g} Hz, a tenth of the sampling "
            f"rate; for this one the steps must be {1.0 / (MIN_SAMPLES_PER_PERIOD * top):.3g} s at "
            "most, "
            f"found {series.coarsest:.6g} s"
        )
    return frequencies


def _extremes(
    step: float, base: Array, frequency: float, q: float, response: str, span: str
) -> tuple[float, float]:
    """Smallest and largest response of an oscillator on a base (n,), with that at the start, 0."""
    omega, zeta = 2.0 * math.pi * frequency, 0.5 / q
    damped = omega * math.sqrt(1.0 - zeta**2)
    pole = complex(-zeta * omega, damped)
    # z = Im(w) / damped, z' = Im(pole w) / damped, z'' + a = Im(pole^2 w) / damped
    factor = {
        "absolute": pole**2,
        "static": -(omega**2),
        "pseudo-velocity": -omega,
        "displacement": -1.0,
    }[response] / damped
    fine = max(1, math.ceil(INSTANTS_PER_PERIOD * frequency * step))
    motion = factor * _oscillate(step / fine, _refined(base, fine), pole)
    seen = [np.zeros(1)]
    if span != "residual":
        seen.append(motion.imag)
    if span != "primary":
        seen.append(_ringing(complex(motion[-1]), pole))
    return min(float(s.min()) for s in seen), max(float(s.max()) for s in seen)


def _oscillate(step: float, base: Array, pole: complex) -> Complex:
    """w (n,) of w' = pole w - a from rest, exact for a (n,) that is a line between samples.

    w_{k+1} = e^p w_k - h [phi_1 a_k + phi_2 (a_{k+1} - a_k)],    p = pole h
    """
    from scipy.signal import lfilter

    p = pole * step
    ahead = -step * _phi_2(p)
    behind = -step * complex(np.expm1(p)) / p - ahead
    numerator, denominator = np.array([ahead, behind]), np.array([1.0, -np.exp(p)])
    at_rest = -ahead * base[:1]
    found: Complex = lfilter(numerator, denominator, base, zi=at_rest)[0]
    return found


def _phi_2(p: complex) -> complex:
    """(e^p - 1 - p) / p^2 without cancellation."""
    if abs(p) > MAX_SERIES_ARGUMENT:
        return complex((np.expm1(p) - p) / p**2)
    total, term = 0j, 0.5 + 0j
    for k in range(3, 20):
        total += term
        term *= p / k
    return total


def _refined(base: Array, factor: int) -> Array:
    """The line through samples, with `factor` steps between them."""
    if factor == 1:
        return base
    weights = np.arange(factor) / factor
    between = base[:-1, None] + weights * np.diff(base)[:, None]
    return np.append(between, base[-1])


def _ringing(motion: complex, pole: complex) -> Array:
    """The first two extremes of Im(m e^(pole t)), t >= 0, which are the largest of each sign.

    They are where its rate Im(pole m e^(pole t)) vanishes: arg(pole m) + damped t = n pi.
    """
    first = float(np.mod(-np.angle(pole * motion), np.pi)) / pole.imag
    times = np.array([first, first + math.pi / pole.imag])
    found: Array = (motion * np.exp(pole * times)).imag
    return found


def _check_choices(response: str, extreme: str, span: str) -> None:
    choices: tuple[tuple[str, Any, tuple[str, ...]], ...] = (
        ("response", response, RESPONSE_KINDS),
        ("extreme", extreme, EXTREME_KINDS),
        ("span", span, RESPONSE_SPANS),
    )
    for name, value, known in choices:
        if value not in known:
            raise SeriesError(f"{name}: expected one of {', '.join(known)}, found {value!r}")
