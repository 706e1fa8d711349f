"""Octave and third octave bands: root mean squares between the edges of IEC 61260-1."""

import math
from dataclasses import dataclass

import numpy as np

from ...files.arrays import Array
from ..errors import SeriesError
from .fourier import periodogram
from .sampling import sampled

OCTAVE_FRACTIONS = (1, 2, 3, 6, 12, 24)
# G of IEC 61260-1: frequencies an octave apart, by powers of ten.
OCTAVE_RATIO = 10.0**0.3
# [Hz], IEC 61260-1.
BAND_REFERENCE_FREQUENCY = 1000.0


@dataclass(frozen=True, eq=False)
class Bands:
    """Root mean squares of a series by frequency bands, see `octave_bands` for an example.

    Parameters
    ----------
    center, lower, upper : (m,) [Hz]
    values : (m,) or (m, k)
        In the unit of the series.
    """

    center: Array
    lower: Array
    upper: Array
    values: Array


def band_edges(lowest: float, highest: float, fraction: int = 3) -> tuple[Array, Array, Array]:
    """Centers and edges (m,) [Hz] of the bands that lie between two frequencies as a whole.

        f_m = 1000 Hz * G^(k / b),  for even b G^((2 k + 1) / (2 b));    G = 10^(3/10)

    and f_m G^(-1/(2b)), f_m G^(1/(2b)), for 1/b of an octave. Source: IEC 61260-1:2014.
    """
    _check(fraction)
    half = 0.5 / fraction
    # For even fractions 1 kHz is an edge, for odd ones a center (IEC 61260-1).
    shift = 0.0 if fraction % 2 else half
    first = math.ceil((_octaves(lowest) + half - shift) * fraction - 1e-9)
    last = math.floor((_octaves(highest) - half - shift) * fraction + 1e-9)
    center: Array = BAND_REFERENCE_FREQUENCY * OCTAVE_RATIO ** (
        np.arange(first, last + 1) / fraction + shift
    )
    return center, center * OCTAVE_RATIO**-half, center * OCTAVE_RATIO**half


def octave_bands(time: Array, values: Array, fraction: int = 3) -> Bands:
    """Compute the root mean squares of a series in bands of 1/fraction of an octave.

    They are those of the whole series, from its periodogram, whose lines are shared out where a
    band edge cuts them. Bands narrower than the distance of its frequencies, one over its length,
    and bands beyond half its sampling rate are left out.

    Parameters
    ----------
    time : (n,) [s]
    values : (n,) or (n, k)
        One series a column.
    fraction : {1, 2, 3, 6, 12, 24}

    Returns
    -------
    Bands

    Raises
    ------
    SeriesError
        For another fraction, and for a series too short to have a whole band.

    Examples
    --------
    >>> import numpy as np
    >>> time = np.arange(1000) * 1e-3
    >>> wave = 2.0 * np.sin(2.0 * np.pi * 50.0 * time)
    >>> bands = octave_bands(time, wave)
    >>> loudest = bands.values.argmax()
    >>> round(float(bands.center[loudest]), 1), round(float(bands.values[loudest]), 3)
    (50.1, 1.414)
    """
    _check(fraction)
    series = sampled(time, values)
    width, nyquist = series.rate / len(series.time), 0.5 / series.coarsest
    lowest = width / (OCTAVE_RATIO ** (1.0 / fraction) - 1.0)
    center, lower, upper = band_edges(lowest, nyquist, fraction)
    if not len(center):
        raise SeriesError(
            f"1/{fraction} octave: expected a series with a whole band between {lowest:.4g} Hz and "
            f"half its sampling rate, {nyquist:.4g} Hz"
        )
    powers = periodogram(series)
    # Each line stands for the power half a distance to both sides.
    edges = np.concatenate([[0.0], powers.frequency + 0.5 * width])
    # The power below each edge; differences at band edges then share lines out linearly.
    below = np.concatenate([np.zeros((1, *powers.values.shape[1:])), powers.values]).cumsum(axis=0)
    square = np.apply_along_axis(
        lambda column: np.interp(upper, edges, column) - np.interp(lower, edges, column), 0, below
    )
    # Differences of large sums may be negative by rounding.
    return Bands(center, lower, upper, np.sqrt(np.maximum(square, 0.0)))


def _check(fraction: int) -> None:
    if fraction not in OCTAVE_FRACTIONS:
        raise SeriesError(
            f"expected bands of 1/b octave with b of {', '.join(map(str, OCTAVE_FRACTIONS))}, "
            f"found {fraction:g}"
        )


def _octaves(frequency: float) -> float:
    """Octaves above 1000 Hz."""
    return math.log(frequency / BAND_REFERENCE_FREQUENCY) / math.log(OCTAVE_RATIO)
