"""The picture of a fit: what was measured, what the model has there, and what is left."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..superelement.validation import Array
from .picture import entitle, panels, style
from .prefixes import DIMENSIONLESS, UNIT_PREFIXES, exponent_of, with_unit
from .styles import COLORS

MEASURED_COLOR, NOISE_COLOR = "0.6", "0.92"
NOISE_BAND = 2.0
"""of standard deviations, within which 95 of 100 residuals lie that are noise"""
RESIDUAL_HEIGHT = 0.6
"""over that of the series"""


@dataclass(frozen=True, eq=False)
class SeriesFit:
    """A measured series and the model at its times, see `draw_series_fit` for an example.

    label : str
    time : (n,) [s]
    measured, fitted : (n,)
    unit : str, optional
    sigma : float, optional
        The standard deviation of the noise, 0 if it is not known.
    """

    label: str
    time: Array
    measured: Array
    fitted: Array
    unit: str = ""
    sigma: float = 0.0


def draw_series_fit(fits: Sequence[SeriesFit], title: str = "") -> Figure:
    """Draw measured series, the model, and below each what is left of it, model less measured.

    A band shows twice the standard deviation of the noise, where that is known.

    Parameters
    ----------
    fits : sequence of SeriesFit
    title : str

    Examples
    --------
    >>> import numpy as np
    >>> from duhamel import view
    >>> t = np.linspace(0.0, 1.0, 50)
    >>> one = view.SeriesFit("angle", t, np.sin(t) + 0.01, np.sin(t), "rad")
    >>> [axes.get_ylabel() for axes in view.draw_series_fit([one]).axes]
    ['[rad]', 'residual [mrad]']
    """
    figure, axes = panels(2 * len(fits), heights=[1.0, RESIDUAL_HEIGHT] * len(fits))
    exponent = exponent_of(max((float(one.time[-1]) for one in fits), default=0.0))
    with style():
        for n, one in enumerate(fits):
            above, below = axes[2 * n : 2 * n + 2]
            _draw_series(above, one, 10.0**exponent)
            _draw_residuals(below, one, 10.0**exponent)
            above.set_title(one.label, parse_math=False)
        axes[-1].set_xlabel(f"time [{UNIT_PREFIXES[exponent]}s]")
        # A column of numbers below one another reads as one scale.
        figure.align_ylabels()
    entitle(figure, title)
    return figure


def _draw_series(axes: Axes, one: SeriesFit, second: float) -> None:
    values = np.concatenate([one.measured, one.fitted])
    size, prefix = _scale(float(np.abs(values).max(initial=0.0)), one.unit)
    look: dict[str, Any] = {"color": MEASURED_COLOR, "markersize": 3, "label": "measured"}
    axes.plot(one.time / second, one.measured / size, ".", **look)
    axes.plot(one.time / second, one.fitted / size, color=COLORS[0], label="model")
    axes.set_ylabel(with_unit("", prefix, one.unit))
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.2)


def _draw_residuals(axes: Axes, one: SeriesFit, second: float) -> None:
    residuals = one.fitted - one.measured
    peak = float(np.abs(residuals).max(initial=0.0))
    peak = max(peak, NOISE_BAND * one.sigma)
    size, prefix = _scale(peak, one.unit)
    if one.sigma:
        ends = (-NOISE_BAND * one.sigma / size, NOISE_BAND * one.sigma / size)
        axes.axhspan(*ends, color=NOISE_COLOR, zorder=0.5, label="twice sigma")
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2)
    # Dots: lines between samples of noise would fill the panel.
    axes.plot(one.time / second, residuals / size, ".", color=COLORS[1], markersize=3)
    axes.axhline(0.0, color="0.3", linewidth=0.8)
    axes.set_ylabel(with_unit("residual", prefix, one.unit))
    limit = 1.1 * (peak / size or 1.0)
    axes.set_ylim(-limit, limit)


def _scale(peak: float, unit: str) -> tuple[float, str]:
    """The power of ten that makes values easy to read, and the prefix that stands for it."""
    exponent = exponent_of(peak, unit or DIMENSIONLESS)
    return 10.0**exponent, UNIT_PREFIXES[exponent]
