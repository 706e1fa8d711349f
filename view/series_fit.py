"""The picture of a fit: what was measured, what the model has there, and what is left."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from ..superelement.validation import Array
from .picture import entitle, panels, style
from .styles import COLORS

MEASURED_COLOR = "0.6"


@dataclass(frozen=True, eq=False)
class SeriesFit:
    """A measured series and the model at its times, see `draw_series_fit` for an example.

    label : str
        With the unit.
    time : (n,) [s]
    measured, fitted : (n,)
    """

    label: str
    time: Array
    measured: Array
    fitted: Array


def draw_series_fit(fits: Sequence[SeriesFit], title: str = "") -> Figure:
    """Draw measured series, the model, and below each what is left of it.

    Parameters
    ----------
    fits : sequence of SeriesFit
    title : str

    Examples
    --------
    >>> import numpy as np
    >>> from duhamel import view
    >>> t = np.linspace(0.0, 1.0, 50)
    >>> one = view.SeriesFit("angle [rad]", t, np.sin(t) + 0.01, np.sin(t))
    >>> [axes.get_ylabel() for axes in view.draw_series_fit([one]).axes]
    ['angle [rad]', 'residual']
    """
    figure, axes = panels(2 * len(fits), heights=[1.0, 0.5] * len(fits))
    with style():
        for n, one in enumerate(fits):
            above, below = axes[2 * n : 2 * n + 2]
            above.plot(
                one.time, one.measured, ".", color=MEASURED_COLOR, markersize=3, label="measured"
            )
            above.plot(one.time, one.fitted, color=COLORS[0], label="model")
            above.set_ylabel(one.label)
            above.legend(loc="best", fontsize="small")
            below.plot(one.time, one.fitted - one.measured, color=COLORS[1], linewidth=0.8)
            below.axhline(0.0, color="0.3", linewidth=0.8)
            below.set_ylabel("residual")
            size = float(np.abs(one.fitted - one.measured).max(initial=0.0)) or 1.0
            below.set_ylim(-1.1 * size, 1.1 * size)
        axes[-1].set_xlabel("time [s]")
    entitle(figure, title)
    return figure
