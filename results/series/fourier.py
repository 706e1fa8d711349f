"""Fourier spectra, power spectral densities, and root mean squares."""

from dataclasses import dataclass

import numpy as np

from ...files.arrays import Array, Complex
from ..errors import SeriesError
from .sampling import Sampled, sampled

SPECTRUM_SCALES = ("transient", "amplitude", "rms")
# They overlap by half.
WELCH_SEGMENTS = 8
WINDOW_NAMES = ("rectangular", "hann", "hamming", "blackman", "blackmanharris", "flattop")


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Frequencies (m,) from 0 to half the sampling rate [Hz], and values (m,) or (m, k) there."""

    frequency: Array
    values: Array


def fourier(
    time: Array, values: Array, *, scale: str = "transient", window: str = "rectangular"
) -> Spectrum:
    """The magnitude of the Fourier transform of a series.

    scale: `transient`, of something that comes and goes, in the unit of the series times seconds;

        |X(f)| = |integral of w(t) x(t) e^(-2 pi i f t) dt|

    `amplitude`, that of a sine at a frequency of the spectrum, or its `rms`, in the unit of the
    series, whatever the window. window: one of `WINDOW_NAMES`; for amplitudes
    `flattop`, which is right to 0.01 dB between the frequencies of the spectrum too.
    """
    if scale not in SPECTRUM_SCALES:
        raise SeriesError(f"expected a scale of {', '.join(SPECTRUM_SCALES)}, found {scale!r}")
    series = sampled(time, values)
    weights = _window(window, len(series.time))
    frequency, X = _transformed(series, weights)
    if scale == "transient":
        return Spectrum(frequency, series.step * np.abs(X))
    sides = _sides(len(series.time)).reshape(-1, *[1] * (X.ndim - 1))
    peaks = sides * np.abs(X) / weights.sum()
    if scale == "rms":
        # a mean and what is at half the rate are their own root mean squares
        peaks = peaks / np.sqrt(sides)
    return Spectrum(frequency, peaks)


def psd(
    time: Array, values: Array, *, resolution: float | None = None, window: str = "hann"
) -> Spectrum:
    """The power spectral density by Welch's method, of frequencies above zero [unit^2 / Hz].

    The mean of the periodograms of segments that overlap by half, without their means: its integral
    over frequency is the variance. resolution: the distance of its frequencies [Hz]; unless given,
    there are eight segments. Source: Welch, IEEE Transactions on Audio and Electroacoustics 15
    (1967).
    """
    from scipy.signal import welch

    series = sampled(time, values)
    length = _segment(series, resolution)
    frequency, density = welch(
        series.values,
        series.rate,
        window=_window(window, length),
        nperseg=length,
        detrend="constant",
        axis=0,
    )
    return Spectrum(frequency, density)


def cumulative_rms(
    time: Array, values: Array, *, resolution: float | None = None, window: str = "hann"
) -> Spectrum:
    """The root mean square of what a series has below each frequency, without its mean.

    sqrt(integral of its power spectral density from 0 to f). At the end it is the standard
    deviation of the series, as far as its segments are like the whole.
    """
    density = psd(time, values, resolution=resolution, window=window)
    width = density.frequency[1] - density.frequency[0]
    return Spectrum(density.frequency, np.sqrt(width * np.cumsum(density.values, axis=0)))


def rms(time: Array, values: Array) -> Array:
    """The root mean square over time, mean included, () or (k,); by trapezoids."""
    time, values = np.asarray(time, dtype=float), np.asarray(values, dtype=float)
    if len(time) == 1:
        single: Array = np.abs(values[0])
        return single
    mean: Array = np.trapezoid(values**2, time, axis=0) / (time[-1] - time[0])
    root: Array = np.sqrt(mean)
    return root


def periodogram(series: Sampled) -> Spectrum:
    """Of the whole series without window: the mean square at each frequency [unit^2].

    They add up to the mean square of the samples (Parseval).
    """
    frequency, X = _transformed(series, np.ones(len(series.time)))
    sides = _sides(len(series.time)).reshape(-1, *[1] * (X.ndim - 1))
    return Spectrum(frequency, sides * np.abs(X / len(series.time)) ** 2)


def _transformed(series: Sampled, weights: Array) -> tuple[Array, Complex]:
    shaped = weights.reshape(-1, *[1] * (series.values.ndim - 1))
    frequency = np.fft.rfftfreq(len(weights), series.step).astype(np.float64)
    return frequency, np.fft.rfft(shaped * series.values, axis=0)


def _sides(n: int) -> Array:
    """2 for frequencies that stand for their negative ones too, otherwise 1."""
    sides = np.full(n // 2 + 1, 2.0)
    sides[0] = 1.0
    if n % 2 == 0:
        sides[-1] = 1.0
    return sides


def _window(name: str, n: int) -> Array:
    from scipy.signal import get_window

    if name not in WINDOW_NAMES:
        raise SeriesError(f"expected a window of {', '.join(WINDOW_NAMES)}, found {name!r}")
    weights: Array = get_window("boxcar" if name == "rectangular" else name, n)
    return weights


def _segment(series: Sampled, resolution: float | None) -> int:
    """The samples of a segment."""
    n = len(series.time)
    if resolution is None:
        return max(3, 2 * n // (WELCH_SEGMENTS + 1))
    length = round(series.rate / resolution) if resolution > 0.0 else 0
    if not 3 <= length <= n:
        raise SeriesError(
            f"resolution: expected {series.rate / n:.4g} to {series.rate / 3:.4g} Hz of a series "
            f"of {n} samples, {series.step * n:.4g} s, found {resolution:.6g} Hz"
        )
    return length
