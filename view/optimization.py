"""The picture of a search: the objective and what has limits, run by run."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..superelement.validation import Array
from .picture import entitle, panels, style
from .prefixes import DIMENSIONLESS, UNIT_PREFIXES, exponent_of, with_unit
from .styles import COLORS

CONSTRAINT_HEIGHT = 0.7
"""over that of the objective"""
FAILED_HEIGHT = 0.03
"""over that of the panel"""
MISSED_COLOR, LIMIT_COLOR = "0.6", "0.3"
ROBUST_SHARE = 95.0
"""per cent of the points that are shown; others lie far off, and above or below the panel"""


@dataclass(frozen=True, eq=False)
class GoalHistory:
    """A number of each run of a search, see `draw_optimization` for an example.

    label : str
    values : (n,)
        Without a number where a run failed.
    unit : str, optional
    low, high : float, optional
        Its limits.
    """

    label: str
    values: Array
    unit: str = ""
    low: float = -np.inf
    high: float = np.inf


def draw_optimization(
    objective: GoalHistory,
    constraints: Sequence[GoalHistory],
    kept: NDArray[np.bool_],
    best: int,
    title: str = "",
) -> Figure:
    """Draw the objective and below it what has limits, over the points of a search.

    Parameters
    ----------
    objective : GoalHistory
    constraints : sequence of GoalHistory
    kept : (n,) of bool
        Whether a point is within all limits.
    best : int
        The point that was chosen, from 0 on.
    title : str

    Examples
    --------
    >>> import numpy as np
    >>> from duhamel import view
    >>> mass = view.GoalHistory("mass", np.array([3.0, 1.0, 2.0]), "kg")
    >>> stress = view.GoalHistory("stress", np.array([1.0e8, 3.0e8, 2.0e8]), "Pa", high=2.0e8)
    >>> figure = view.draw_optimization(mass, [stress], np.array([True, False, True]), 2)
    >>> [axes.get_ylabel() for axes in figure.axes]
    ['[kg]', '[MPa]']
    """
    histories = [objective, *constraints]
    figure, axes = panels(len(histories), heights=[1.0, *([CONSTRAINT_HEIGHT] * len(constraints))])
    with style():
        for panel, one in zip(axes, histories, strict=True):
            _draw_history(panel, one, kept, best)
        axes[0].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4, borderaxespad=0.2)
        axes[-1].set_xlabel("point of the search")
        figure.align_ylabels()
    entitle(figure, title)
    return figure


def _draw_history(axes: Axes, one: GoalHistory, kept: NDArray[np.bool_], best: int) -> None:
    whole = np.isfinite(one.values)
    limits = [end for end in (one.low, one.high) if np.isfinite(end)]
    shown = np.append(one.values[whole], limits)
    size = float(np.percentile(np.abs(shown), ROBUST_SHARE)) if len(shown) else 0.0
    exponent = exponent_of(size, one.unit or DIMENSIONLESS)
    scale, number = 10.0**exponent, np.arange(1, len(kept) + 1)
    for among, color, label in (
        (whole & kept, COLORS[0], "within all limits"),
        (whole & ~kept, MISSED_COLOR, "a limit is missed"),
    ):
        if among.any():
            y = one.values[among] / scale
            axes.plot(number[among], y, "o", color=color, markersize=3.5, label=label)
    if not whole.all():
        height = np.full(int((~whole).sum()), FAILED_HEIGHT)
        edge = axes.get_xaxis_transform()
        axes.plot(number[~whole], height, "x", color="0.25", transform=edge, label="run failed")
    for end in limits:
        axes.axhline(end / scale, color=LIMIT_COLOR, linestyle="--", linewidth=0.9)
    axes.plot(
        number[best],
        one.values[best] / scale,
        "o",
        color=COLORS[1],
        fillstyle="none",
        markersize=9,
        markeredgewidth=1.5,
        label="chosen",
    )
    axes.set_title(one.label, parse_math=False)
    axes.set_ylabel(with_unit("", UNIT_PREFIXES[exponent], one.unit))
    axes.margins(x=0.02)
    _frame(axes, shown / scale)


def _frame(axes: Axes, values: Array) -> None:
    """Show what most points have, and all limits: one that is far off would flatten the rest."""
    tail = 0.5 * (100.0 - ROBUST_SHARE)
    low, high = np.percentile(values, [tail, 100.0 - tail])
    room = 0.3 * (high - low) or 0.1 * abs(high) or 1.0
    inside = values[(values >= low - 3.0 * room) & (values <= high + 3.0 * room)]
    margin = 0.08 * float(np.ptp(inside)) or 0.1 * abs(float(inside[0])) or 1.0
    axes.set_ylim(float(inside.min()) - margin, float(inside.max()) + margin)
