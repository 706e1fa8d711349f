"""Curves over frequency: on logarithmic paper, in bands, and on four-coordinate paper."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from ..results.series.bands import OCTAVE_RATIO
from ..results.transforms import STANDARD_GRAVITY
from ..superelement.validation import Array
from .curve import Curve
from .styles import styles

# Of the ends of an ordinate: a flat spectrum is to look flat.
LEAST_ORDINATE_RATIO = 3.0
# Of fewer decades there are numbers between the powers of ten.
NUMBERED_DECADES = 2.5
# Of an ordinate: below is rounding.
MAX_DECADES = 6.0
# Height over width, where decades are as long up as across, and the ruled lines rise by 45
# degrees.
TRIPARTITE_ASPECT = 0.62
RULED_LINE: dict[str, Any] = {"color": "0.85", "linewidth": 0.5, "zorder": 0.5}
RULED_LABEL: dict[str, Any] = {"fontsize": 6.5, "color": "0.4", "ha": "center", "zorder": 0.7}
# Hides the line on which a label stands.
LABEL_GROUND: dict[str, Any] = {"facecolor": "white", "edgecolor": "none", "pad": 0.6}


def fill(axes: Axes, curves: Sequence[Curve]) -> None:
    """Draw the curves of a panel, which have one paper, over frequency."""
    paper = curves[0].paper
    axes.set_xscale("log")
    for curve, look in zip(curves, styles(curves), strict=True):
        assert curve.abscissa is not None
        if paper == "bands":
            _draw_bands(axes, curve, look)
        else:
            axes.plot(curve.abscissa, np.abs(curve.values), **look)
    of_oscillators = curves[0].words[-1].startswith("shock")
    axes.set_xlabel("natural frequency [Hz]" if of_oscillators else "frequency [Hz]")
    peaks = np.concatenate([np.abs(curve.values) for curve in curves])
    if peaks.any():
        axes.set_yscale("log")
        low, high = _span(peaks)
        if paper == "tripartite":
            _rule(axes, curves, low, high)
        else:
            narrow = max(1.0, LEAST_ORDINATE_RATIO / (high / low)) ** 0.5
            axes.set_ylim(0.7 * low / narrow, 1.5 * high * narrow)
    _shade_beyond(axes, curves)
    _mark(axes.xaxis, axes.get_xlim())
    if peaks.any():
        _mark(axes.yaxis, axes.get_ylim())


def _shade_beyond(axes: Axes, curves: Sequence[Curve]) -> None:
    """Shade frequencies beyond the band of the superelement that first ends."""
    left, right = axes.get_xlim()
    band = min(curve.band for curve in curves)
    # The margin of the axis holds no values, and would be marked alone.
    if band < max(curve.abscissa[-1] for curve in curves if curve.abscissa is not None):
        axes.axvspan(max(band, left), right, color="0.92", zorder=0, linewidth=0)
        axes.set_xlim(left, right)
        axes.annotate(
            f"shaded beyond {band:.4g} Hz, the band of the superelement",
            (0.995, 0.02),
            xycoords="axes fraction",
            ha="right",
            fontsize=7,
            color="0.35",
        )


def _mark(axis: Axis, limits: tuple[float, float]) -> None:
    """Numbers at powers of ten, and between them where these are few."""
    decades = math.log10(limits[1] / limits[0])
    axis.set_major_locator(
        LogLocator(subs=(1.0, 2.0, 5.0) if decades < NUMBERED_DECADES else (1.0,))
    )
    axis.set_major_formatter(FuncFormatter(_written))
    axis.set_minor_formatter(NullFormatter())


def _draw_bands(axes: Axes, curve: Curve, look: dict[str, Any]) -> None:
    """A level from edge to edge of each band."""
    assert curve.abscissa is not None
    half = math.sqrt(_ratio(curve.abscissa))
    edges = np.append(curve.abscissa / half, curve.abscissa[-1] * half)
    axes.plot(curve.abscissa, np.abs(curve.values), "o", markersize=2.5, color=look["color"])
    axes.stairs(np.abs(curve.values), edges, baseline=None, linewidth=1.2, **look)


def _ratio(centers: Array) -> float:
    return float(centers[1] / centers[0]) if len(centers) > 1 else OCTAVE_RATIO


def _span(peaks: Array) -> tuple[float, float]:
    """The range of values above zero that is shown."""
    high = float(peaks.max())
    low = float(peaks[peaks > 0.0].min())
    return max(low, high * 10.0**-MAX_DECADES), high


def _rule(axes: Axes, curves: Sequence[Curve], low: float, high: float) -> None:
    """Lines of equal acceleration and of equal displacement across pseudo-velocity over frequency.

    v = a / (2 pi f)        v = 2 pi f d
    """
    frequencies = np.concatenate([curve.abscissa for curve in curves if curve.abscissa is not None])
    left, right = float(frequencies.min()), float(frequencies.max())
    wanted = TRIPARTITE_ASPECT * math.log10(right / left)
    margin = 10.0 ** max(0.15, 0.5 * (wanted - math.log10(high / low)))
    low, high = low / margin, high * margin
    axes.set_xlim(left, right)
    axes.set_ylim(low, high)
    turns = curves[0].unit.startswith("rad")
    across = np.array([left, right])
    force, unit = (1.0, "rad/s²") if turns else (STANDARD_GRAVITY, "g")
    for a in _decades(2.0 * math.pi * left * low / force, 2.0 * math.pi * right * high / force):
        axes.plot(across, a * force / (2.0 * math.pi * across), **RULED_LINE)
        f = min(right / 1.35, a * force / (2.0 * math.pi * 1.12 * low))
        _label(axes, f, a * force / (2.0 * math.pi * f), f"{_written(a)} {unit}", -1.0)
    length, unit = (1.0, "rad") if turns else (1e-3, "mm")
    for d in _decades(
        low / (2.0 * math.pi * right * length), high / (2.0 * math.pi * left * length)
    ):
        axes.plot(across, 2.0 * math.pi * across * d * length, **RULED_LINE)
        f = min(right / 1.35, high / 1.12 / (2.0 * math.pi * d * length))
        _label(axes, f, 2.0 * math.pi * f * d * length, f"{_written(d)} {unit}", 1.0)


def _decades(low: float, high: float) -> list[float]:
    first, last = math.ceil(math.log10(low)), math.floor(math.log10(high))
    return [10.0**k for k in range(first, last + 1)]


def _label(axes: Axes, x: float, y: float, text: str, slope: float) -> None:
    """A text along a line of this slope on paper."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    if not (1.1 * left < x < right and 1.05 * low < y < high):
        return
    axes.text(
        x,
        y,
        text,
        rotation=math.degrees(math.atan2(slope * y, x)),
        transform_rotates_text=True,
        rotation_mode="anchor",
        va="center",
        bbox=LABEL_GROUND,
        **RULED_LABEL,
    )


def _written(value: float, _: object = None) -> str:
    return f"{value:g}"
