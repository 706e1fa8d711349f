"""Filters that shift no phase: forwards, then backwards. Channel classes of SAE J211."""

import math

import numpy as np

from ...files.arrays import Array
from ..errors import SeriesError
from .sampling import Sampled, sampled

# CFC of SAE J211: the frequency [Hz] up to which the filter is level.
CHANNEL_CLASSES = (60, 180, 600, 1000)
# SAE J211 asks for at least ten samples per period of the class.
MIN_SAMPLES_PER_CLASS_PERIOD = 10.0
# 5/3 / (sqrt 2 - 1)^(1/4): then two passes have -3 dB at 5/3 of the class.
CORNER_OVER_CLASS = 2.0775
MIRRORED, FEWEST, PERIODS = 0.01, 100, 3
"""what is added at either end, at least: seconds, samples (ISO 6487), and periods of the corner"""
# (f / corner)^(2 order) of one pass where two passes together have -3 dB.
CORNER_OF_BOTH_PASSES = math.sqrt(2.0) - 1.0
FILTER_KINDS = ("lowpass", "highpass", "bandpass")
MAX_FILTER_ORDER = 20


def cfc(time: Array, values: Array, channel_class: float) -> Sampled:
    """Filter a series by a channel frequency class of SAE J211 (CFC), without phase shift.

        w = tan(pi 2.0775 CFC h)
        (1 + sqrt(2) w + w^2) y_k = w^2 (x_k + 2 x_{k-1} + x_{k-2}) + 2 (1 - w^2) y_{k-1}
                                    - (1 - sqrt(2) w + w^2) y_{k-2}

    The two-pole filter of the standard runs forwards and backwards; together both have -3 dB at
    5/3 of the class, in Hz. Before, each end is continued by its mirror image in the last sample,
    over at least 10 ms, 100 samples and three periods. Source: SAE J211-1, Appendix C; ISO 6487.

    Parameters
    ----------
    time : (n,) [s]
    values : (n,) or (n, k)
        One series a column.
    channel_class : {60, 180, 600, 1000}

    Returns
    -------
    Sampled
        At equal steps.

    Raises
    ------
    SeriesError
        For another class, and for fewer than ten samples in a period of the class.

    Examples
    --------
    A vibration far below the class passes:

    >>> import numpy as np
    >>> time = np.arange(1000) * 1e-4
    >>> wave = 2.0 * np.sin(2.0 * np.pi * 50.0 * time)
    >>> filtered = cfc(time, wave, 600)
    >>> bool(np.abs(filtered.values - wave).max() < 0.01)
    True
    """
    if channel_class not in CHANNEL_CLASSES:
        raise SeriesError(
            f"expected a channel class of {', '.join(map(str, CHANNEL_CLASSES))}, found "
            f"{channel_class:g}"
        )
    series = sampled(time, values)
    if (rate := 1.0 / series.coarsest) < (
        1.0 - 1e-9
    ) * MIN_SAMPLES_PER_CLASS_PERIOD * channel_class:
        raise SeriesError(
            f"CFC {channel_class:g}: expected {MIN_SAMPLES_PER_CLASS_PERIOD * channel_class:g} "
            "samples per second or "
            f"more, found {rate:.6g}"
        )
    w = math.tan(math.pi * CORNER_OVER_CLASS * channel_class * series.step)
    whole = 1.0 + math.sqrt(2.0) * w + w**2
    b = np.array([1.0, 2.0, 1.0]) * w**2 / whole
    a = np.array([1.0, -2.0 * (1.0 - w**2) / whole, (1.0 - math.sqrt(2.0) * w + w**2) / whole])
    return _both_ways(series, np.concatenate([b, a])[None], channel_class)


def butterworth(
    time: Array, values: Array, kind: str, corners: tuple[float, ...], order: int = 4
) -> Sampled:
    """Filter a series by a Butterworth filter that runs forwards and backwards.

    Parameters
    ----------
    time : (n,) [s]
    values : (n,) or (n, k)
        One series a column.
    kind : {"lowpass", "highpass", "bandpass"}
    corners : tuple of float [Hz]
        One, or two of a bandpass; both passes together have -3 dB there.
    order : int
        Of one pass.

    Returns
    -------
    Sampled
        At equal steps.

    Raises
    ------
    SeriesError
        For corners that do not increase, or are not below half the sampling rate.

    Examples
    --------
    >>> import numpy as np
    >>> time = np.arange(1000) * 1e-3
    >>> wave = 2.0 * np.sin(2.0 * np.pi * 50.0 * time)
    >>> filtered = butterworth(time, wave, "highpass", (200.0,))
    >>> bool(np.abs(filtered.values[100:-100]).max() < 0.01)
    True
    """
    from scipy.signal import butter

    if kind not in FILTER_KINDS:
        raise SeriesError(f"expected a filter of {', '.join(FILTER_KINDS)}, found {kind!r}")
    if len(corners) != (expected := 2 if kind == "bandpass" else 1):
        raise SeriesError(f"{kind}: expected {expected} corners [Hz], found {len(corners)}")
    if not 1 <= order <= MAX_FILTER_ORDER:
        raise SeriesError(f"order: expected 1 to {MAX_FILTER_ORDER}, found {order}")
    series = sampled(time, values)
    nyquist = 0.5 / series.coarsest
    rising = all(low < high for low, high in zip((0.0, *corners), (*corners, nyquist), strict=True))
    if not rising:
        found = " and ".join(f"{corner:g}" for corner in corners)
        raise SeriesError(
            f"{kind}: expected corners that increase, from 0 to half the sampling rate, "
            f"{nyquist:.6g} Hz; found {found} Hz"
        )
    passes = {"lowpass": ("low",), "highpass": ("high",), "bandpass": ("high", "low")}[kind]
    sections = [
        butter(order, _of_one_pass(corner, side, order, series.step), side, output="sos")
        for corner, side in zip(corners, passes, strict=True)
    ]
    return _both_ways(series, np.concatenate(sections), corners[0])


def _of_one_pass(corner: float, side: str, order: int, step: float) -> float:
    """The corner of one pass, over half the sampling rate, so that two have -3 dB at `corner`."""
    power = -1.0 if side == "low" else 1.0
    # The bilinear transform compresses frequencies by the tangent.
    analog = math.tan(math.pi * corner * step) * CORNER_OF_BOTH_PASSES ** (power / (2 * order))
    return 2.0 / math.pi * math.atan(analog)


def _both_ways(series: Sampled, sections: Array, lowest: float) -> Sampled:
    """Filtered by second order sections forwards and backwards, the ends continued by mirrors.

    lowest: the lowest corner [Hz].
    """
    # Imported late: it takes long to load, and most uses need no filter.
    from scipy.signal import sosfiltfilt

    # Long enough for the filter to forget its start.
    added = max(FEWEST, math.ceil(max(MIRRORED, PERIODS / lowest) / series.step))
    filtered = sosfiltfilt(
        sections, series.values, axis=0, padtype="odd", padlen=min(added, len(series.time) - 1)
    )
    return Sampled(series.time, filtered, series.coarsest)
