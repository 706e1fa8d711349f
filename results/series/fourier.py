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
    """Values over frequency, see `fourier` for an example.

    Parameters
    ----------
    frequency : (m,) [Hz]
        From 0 to half the sampling rate.
    values : (m,) or (m, k)
    """

    frequency: Array
    values: Array


def fourier(
    time: Array, values: Array, *, scale: str = "transient", window: str = "rectangular"
) -> Spectrum:
    """Compute the magnitude of the Fourier transform of a series.

        |X(f)| = |integral of w(t) x(t) e^(-2 pi i f t) dt|

    Parameters
    ----------
    time : (n,) [s]
    values : (n,) or (n, k)
        One series a column.
    scale : {"transient", "amplitude", "rms"}
        |X(f)| of a transient, in the unit of the series times seconds; the amplitude of a sine at
        a frequency of the spectrum, or its root mean square, in the unit of the series, whatever
        the window.
    window : str
        One of `WINDOW_NAMES`. For amplitudes "flattop" is right to 0.01 dB also between the
        frequencies of the spectrum.

    Returns
    -------
    Spectrum

    Raises
    ------
    SeriesError
        For other scales and windows, and what `sampled` refuses.

    Examples
    --------
    >>> import numpy as np
    >>> time = np.arange(1000) * 1e-3
    >>> wave = 2.0 * np.sin(2.0 * np.pi * 50.0 * time)
    >>> spectrum = fourier(time, wave, scale="amplitude")
    >>> largest = spectrum.values.argmax()
    >>> round(float(spectrum.frequency[largest]), 6), round(float(spectrum.values[largest]), 6)
    (50.0, 2.0)
    """
    if scale not in SPECTRUM_SCALES:
        raise SeriesError(f"expected a scale of {', '.join(SPECTRUM_SCALES)}, found {scale!r}")
    series = sampled(time, values)
    weights = _window(window, len(series.time))
    frequency, X = _transformed(series, weights)
    if scale == "transient":
        return Spectrum(frequency, series.step * np.abs(X))
    sides = _sides(len(series.time))
    peaks = sides * np.abs(X).T / weights.sum()
    if scale == "rms":
        # a mean and what is at half the rate are their own root mean squares
        peaks = peaks / np.sqrt(sides)
    return Spectrum(frequency, peaks.T)


def psd(
    time: Array, values: Array, *, resolution: float | None = None, window: str = "hann"
) -> Spectrum:
    """Compute the power spectral density of a series by Welch's method.

    It is the mean of the periodograms of segments that overlap by half, each without its mean, for
    frequencies above zero; its integral over frequency is the variance. Source: Welch, IEEE
    Transactions on Audio and Electroacoustics 15 (1967).

    Parameters
    ----------
    time : (n,) [s]
    values : (n,) or (n, k)
        One series a column.
    resolution : float [Hz], optional
        The distance of its frequencies; by default there are eight segments.
    window : str
        One of `WINDOW_NAMES`.

    Returns
    -------
    Spectrum
        Values in unit^2 / Hz.

    Raises
    ------
    SeriesError
        For a resolution that the series does not have, and what `sampled` refuses.

    Examples
    --------
    >>> import numpy as np
    >>> time = np.arange(1000) * 1e-3
    >>> wave = 2.0 * np.sin(2.0 * np.pi * 50.0 * time)
    >>> density = psd(time, wave, resolution=10.0)
    >>> round(float(density.values.sum() * 10.0), 3)  # the variance, 2^2 / 2
    2.0
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
    """Compute the root mean square of what a series has below each frequency, without its mean.

        sqrt(integral of its power spectral density from 0 to f)

    The last value is the standard deviation of the series, as far as its segments are like the
    whole. Parameters, result and exceptions are those of `psd`.

    Examples
    --------
    >>> import numpy as np
    >>> time = np.arange(1000) * 1e-3
    >>> wave = 2.0 * np.sin(2.0 * np.pi * 50.0 * time)
    >>> below = cumulative_rms(time, wave, resolution=10.0)
    >>> round(float(below.values[-1]), 3)
    1.414
    """
    density = psd(time, values, resolution=resolution, window=window)
    width = density.frequency[1] - density.frequency[0]
    return Spectrum(density.frequency, np.sqrt(width * np.cumsum(density.values, axis=0)))


def rms(time: Array, values: Array) -> Array:
    """Compute the root mean square of a series over time, mean included, by trapezoids.

    Parameters
    ----------
    time : (n,) [s]
    values : (n,) or (n, k)
        One series a column.

    Returns
    -------
    () or (k,)
        In the unit of the series.

    Examples
    --------
    >>> import numpy as np
    >>> float(rms(np.array([0.0, 1.0, 3.0]), np.array([2.0, 2.0, -2.0])))
    2.0
    """
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
    powers = _sides(len(series.time)) * np.abs(X / len(series.time)).T ** 2
    return Spectrum(frequency, powers.T)


def _transformed(series: Sampled, weights: Array) -> tuple[Array, Complex]:
    frequency = np.fft.rfftfreq(len(weights), series.step).astype(np.float64)
    return frequency, np.fft.rfft((weights * series.values.T).T, axis=0)


def _sides(n: int) -> Array:
    """2 for frequencies that stand for their negative ones too, otherwise 1."""
    sides = np.full(n // 2 + 1, 2.0)
    sides[0] = 1.0
    # With an even number the last frequency is half the rate, which has no negative partner.
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
    # The distance of the frequencies of a segment is one over its length in time.
    length = round(series.rate / resolution) if resolution > 0.0 else 0
    if not 3 <= length <= n:
        raise SeriesError(
            f"resolution: expected {series.rate / n:.4g} to {series.rate / 3:.4g} Hz of a series "
            f"of {n} samples, {series.step * n:.4g} s, found {resolution:.6g} Hz"
        )
    return length
