"""Outputs of a study over its parameters: lines, contours, or points with rank correlations."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation
from numpy.typing import NDArray

from ..superelement.validation import Array
from .errors import PictureError
from .picture import PANEL_HEIGHT, PICTURE_WIDTH, entitle, style
from .styles import COLORS

# Of one panel; more values of the second parameter are drawn as contours.
MAX_LINES = 6
# Beside one another: the parameters with the strongest correlations.
MAX_PANELS = 5
MAX_OUTPUTS = 12
CONTOUR_LEVELS = 12
# Of the height of a panel: cases that failed have a parameter, but no ordinate.
FAILED_HEIGHT = 0.03
# Characters.
MAX_LABEL = 40
# Ratio of the largest to the least value of a parameter that goes on a logarithmic axis.
LEAST_LOG_SPAN = 30.0


@dataclass(frozen=True, eq=False)
class Axis:
    """A parameter that varies: its value in each case, or the numbers of its values.

    name: its key; values (n,); labels: what values that are no numbers stand for.
    """

    name: str
    values: Array
    labels: tuple[str, ...] = ()

    @property
    def levels(self) -> Array:
        """Its different values, ascending."""
        return np.unique(self.values)


def draw_variation(
    parameters: Mapping[str, Sequence[Any]],
    outputs: Mapping[str, Array],
    title: str = "",
    units: Mapping[str, str] | None = None,
    failed: Mapping[str, Sequence[Any]] | None = None,
) -> Figure:
    """Draw a row of panels for each output, over the parameters that vary.

    One parameter: a line. Two: a line for each value of the second; contours where these are many,
    or scattered. More: points over each, with Spearman's rank correlation, and the strongest first.
    Of an array the element that varies most is drawn.

    Parameters
    ----------
    parameters : mapping of sequence
        Values of n cases by key.
    outputs : mapping of (n,)
        By name; those that are no number are left out.
    title : str
    units : mapping of str, optional
        Of the outputs by name.
    failed : mapping of sequence, optional
        Values of k more cases, which have no outputs: crosses at the edge of the panels, as of
        cases without a number.

    Raises
    ------
    PictureError
        If nothing varies.

    Examples
    --------
    >>> import numpy as np
    >>> from duhamel import view
    >>> figure = view.draw_variation({"length": [1.0, 2.0]}, {"peak": np.array([3.0, 4.0])})
    >>> figure.axes[0].get_xlabel()
    'length'
    """
    units = {} if units is None else units
    if failed and (lost := len(next(iter(failed.values())))):
        parameters = {key: [*values, *failed[key]] for key, values in parameters.items()}
        outputs = {name: np.append(values, [np.nan] * lost) for name, values in outputs.items()}
    axes = [axis for key, values in parameters.items() if (axis := _axis(key, values)) is not None]
    if not axes or not outputs:
        raise PictureError(
            f"expected parameters that vary and outputs, found {len(axes)} and {len(outputs)}"
        )
    if len(outputs) > MAX_OUTPUTS:
        raise PictureError(f"expected at most {MAX_OUTPUTS} outputs, found {len(outputs)}")
    columns = min(len(axes), MAX_PANELS) if len(axes) > 2 else 1
    figure = Figure(
        figsize=(
            PICTURE_WIDTH if columns < 3 else 0.5 * PICTURE_WIDTH + 1.6 * columns,
            _height(axes, outputs),
        ),
        layout="constrained",
    )
    with style():
        panels: Any = figure.subplots(len(outputs), columns, squeeze=False)
        for row, (name, values) in zip(panels, outputs.items(), strict=True):
            label = f"{name} [{units[name]}]" if units.get(name) else name
            _fill(list(row), axes, label, values)
        entitle(figure, title)
    return figure


def _height(axes: Sequence[Axis], outputs: Mapping[str, Array]) -> float:
    tall = 1.35 if len(axes) == 2 else 1.1
    return 0.4 + tall * PANEL_HEIGHT * len(outputs)


def _axis(key: str, values: Sequence[Any]) -> Axis | None:
    """A parameter as numbers, of arrays one element; None if it does not vary."""
    texts = list(map(str, values))
    if len(set(texts)) < 2:
        return None
    if all(isinstance(value, Real) and not isinstance(value, bool) for value in values):
        return Axis(key, np.array(values, dtype=float))
    return _element(key, values) or _labelled(key, texts)


def _element(key: str, values: Sequence[Any]) -> Axis | None:
    """The element of arrays of numbers that varies most, if it tells them apart."""
    try:
        table = np.array(values, dtype=float)
    except (TypeError, ValueError):
        return None
    if table.ndim < 2:
        return None
    table = table.reshape(len(table), -1)
    i = int(np.argmax(np.ptp(table, axis=0)))
    if len(np.unique(table[:, i])) < len(np.unique(table, axis=0)):
        return None
    return Axis(f"{key}[{i}]", table[:, i])


def _labelled(key: str, texts: Sequence[str]) -> Axis:
    known = list(dict.fromkeys(texts))
    return Axis(key, np.array([float(known.index(text)) for text in texts]), tuple(known))


def _fill(panels: list[Axes], axes: Sequence[Axis], name: str, values: Array) -> None:
    known = np.isfinite(values)
    every = axes
    axes = [Axis(axis.name, axis.values[known], axis.labels) for axis in axes]
    values = values[known]
    if not len(values):
        panels[0].set_title(f"{_shown(name)}: no numbers", parse_math=False)
    elif len(axes) == 1:
        _draw_line(panels[0], axes[0], values, "")
        _label(panels[0], axes[0], name)
    elif len(axes) == 2:
        _draw_plane(panels[0], axes[0], axes[1], name, values)
    else:
        _draw_points(panels, axes, name, values)
    if len(values) and not known.all():
        _mark_failed(panels, every, ~known)


def _mark_failed(panels: list[Axes], axes: Sequence[Axis], failed: NDArray[np.bool_]) -> None:
    """Crosses at the lower edge of panels where cases have no number; in a plane, at their place.

    Of more than two parameters the panels show others than the order of the axes: by their names.
    """
    shown = {_shown(axis.name): axis for axis in axes}
    for panel in panels:
        x = shown.get(panel.get_xlabel())
        if x is None:
            continue
        y = shown.get(panel.get_ylabel())
        at_edge: dict[str, Any] = (
            {} if y is not None else {"transform": panel.get_xaxis_transform()}
        )
        height = np.full(int(failed.sum()), FAILED_HEIGHT) if y is None else y.values[failed]
        panel.plot(x.values[failed], height, "x", color="0.25", markersize=5, **at_edge)
    where = f"{int(failed.sum())} failed: x"
    panels[0].annotate(where, (1.0, 1.01), xycoords="axes fraction", ha="right", fontsize=7)


def _draw_line(panel: Axes, axis: Axis, values: Array, label: str) -> None:
    order = np.argsort(axis.values, kind="stable")
    panel.plot(axis.values[order], values[order], "o-", markersize=3.5, label=_shown(label))


def _draw_plane(panel: Axes, one: Axis, two: Axis, name: str, values: Array) -> None:
    """Lines over the parameter with more values, one for each value of the other; or contours."""
    x, other = (one, two) if len(one.levels) >= len(two.levels) else (two, one)
    if len(other.levels) > MAX_LINES and not (x.labels or other.labels):
        _draw_contours(panel, one, two, name, values)
        return
    for level in other.levels:
        among = other.values == level
        part = Axis(x.name, x.values[among], x.labels)
        _draw_line(panel, part, values[among], _level(other, float(level)))
    _label(panel, x, name)
    legend = panel.legend(title=_shown(other.name), loc="upper left", bbox_to_anchor=(1.0, 1.0))
    for text in (legend.get_title(), *legend.get_texts()):
        text.set_parse_math(False)


def _draw_contours(panel: Axes, x: Axis, y: Axis, name: str, values: Array) -> None:
    """Linear between the nearest cases (Delaunay), which are drawn as dots."""
    places = np.stack([_position(x), _position(y)], axis=1)
    spans = np.ptp(places, axis=0)
    is_plane = len(values) > 3 and np.linalg.matrix_rank((places - places[0]) / spans, 1e-9) == 2
    if is_plane and np.ptp(values) > 0.0:
        nearest = Triangulation(*((places - places[0]) / spans).T).triangles
        mesh = Triangulation(x.values, y.values, nearest)
        filled: Any = panel.tricontourf(mesh, values, levels=CONTOUR_LEVELS, cmap="viridis")
    else:
        filled = panel.scatter(x.values, y.values, c=values, cmap="viridis")
    panel.figure.colorbar(filled, ax=panel)
    panel.plot(x.values, y.values, ".", color="white", markersize=2.5, markeredgewidth=0.0)
    panel.grid(visible=False)
    _label(panel, x, name)
    panel.set_title(_shown(name), parse_math=False)
    panel.set_ylabel(_shown(y.name), parse_math=False)
    if _is_logarithmic(y):
        panel.set_yscale("log")


def _draw_points(panels: list[Axes], axes: Sequence[Axis], name: str, values: Array) -> None:
    ranks = [rank_correlation(axis.values, values) for axis in axes]
    order = np.argsort([-abs(rank) for rank in ranks], kind="stable")
    for panel, i in zip(panels, order, strict=False):
        color = COLORS[0] if ranks[i] >= 0.0 else COLORS[1]
        panel.plot(axes[i].values, values, "o", markersize=3.0, color=color, alpha=0.7)
        _label(panel, axes[i], name if panel is panels[0] else "")
        panel.set_title(f"rank correlation {ranks[i]:+.2f}")


def rank_correlation(x: Array, y: Array) -> float:
    """Spearman's: the linear correlation of the ranks, of equal values their mean; 0 of constants.

    x, y (n,). Source: C. Spearman, The American Journal of Psychology 15 (1904).
    """
    from scipy.stats import rankdata  # takes as long to import as all else of a small picture

    ranks = np.array([rankdata(x), rankdata(y)])
    ranks -= ranks.mean(axis=1, keepdims=True)
    size = float(np.sqrt((ranks[0] @ ranks[0]) * (ranks[1] @ ranks[1])))
    return float(ranks[0] @ ranks[1]) / size if size > 0.0 else 0.0


def _label(panel: Axes, x: Axis, name: str) -> None:
    panel.set_xlabel(_shown(x.name), parse_math=False)
    panel.set_ylabel(_shown(name), parse_math=False)
    panel.margins(x=0.04)
    if x.labels:
        panel.set_xticks(range(len(x.labels)), list(map(_shown, x.labels)))
    elif _is_logarithmic(x):
        panel.set_xscale("log")


def _is_logarithmic(axis: Axis) -> bool:
    """Whether positive values of a wide range are more evenly spread by their logarithms."""
    if axis.labels or not len(axis.values) or not axis.values.min() > 0.0:
        return False
    if axis.values.max() < LEAST_LOG_SPAN * axis.values.min():
        return False
    return _unevenness(np.log(axis.levels)) < _unevenness(axis.levels)


def _unevenness(values: Array) -> float:
    """How far the median lies from the middle, over the range."""
    low, high = float(values.min()), float(values.max())
    return abs(float(np.median(values)) - 0.5 * (low + high)) / (high - low)


def _position(axis: Axis) -> Array:
    return np.log(axis.values) if _is_logarithmic(axis) else axis.values


def _level(axis: Axis, value: float) -> str:
    return axis.labels[int(value)] if axis.labels else f"{value:.4g}"


def _shown(text: str) -> str:
    """Text that can be drawn, not at length."""
    line = "".join(letter if letter.isprintable() else "?" for letter in text)
    line = line.encode("utf-8", "replace").decode("utf-8")
    return line if len(line) <= MAX_LABEL else f"{line[: MAX_LABEL - 1]}\u2026"
