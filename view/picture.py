"""Curves as pictures: one panel below the other, in one style."""

import io
import os
import warnings
from collections.abc import Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from textwrap import fill, wrap
from typing import Any

import matplotlib
import numpy as np
from cycler import cycler
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text

from ..files.outputs import renamed_when_whole
from ..superelement.validation import Array
from . import naming, planes, spectra
from .curve import PLANE_PAPERS, Curve
from .errors import PictureError, require_target
from .prefixes import UNIT_PREFIXES, exponent_of, with_unit
from .styles import COLORS, styles

PICTURE_STYLE: dict[Any, Any] = {
    "axes.edgecolor": "0.35",
    "axes.formatter.limits": (-4, 5),
    "axes.formatter.use_mathtext": True,
    "axes.grid": True,
    "axes.labelsize": 9,
    "axes.linewidth": 0.7,
    "axes.prop_cycle": cycler(color=COLORS),
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 9,
    "axes.xmargin": 0.01,
    "figure.titlesize": 10,
    "font.size": 9,
    "grid.color": "0.9",
    "grid.linewidth": 0.6,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "lines.linewidth": 1.2,
    "xtick.color": "0.35",
    "xtick.labelcolor": "black",
    "ytick.color": "0.35",
    "ytick.labelcolor": "black",
}

PICTURE_WIDTH = 7.0  # [inch]
PANEL_HEIGHT = 2.2  # [inch]

# Of panels of other papers than lines, over that of theirs: decades and lengths are as long up as
# across.
RELATIVE_HEIGHTS = {"tripartite": 1.8, "plane": 1.6, "space": 1.8}

LEGEND_LINE_HEIGHT = 0.19  # [inch]

# Characters, which fit at this size of letters: longer ones are folded.
MAX_TITLE_LINE = 100
MAX_LEGEND_LINE = 34

DOTS_PER_INCH = 110
# Such files are printed: the pictures of surfaces within them are to be as sharp as their lines.
VECTOR_SUFFIXES = ("pdf", "svg", "svgz", "eps", "ps")
VECTOR_DOTS_PER_INCH = 300

# Characters: layout takes time with the square of their number.
MAX_TITLE = 300

# Relative to the largest value of a panel: closer, a level would look like noise.
LEAST_ORDINATE_SPAN = 1e-4


def style() -> AbstractContextManager[None]:
    """Draw in the style of all pictures: `with style(): ...`.

    Examples
    --------
    >>> from duhamel import view
    >>> import matplotlib
    >>> with view.style():
    ...     matplotlib.rcParams["axes.titlelocation"]
    'left'
    """
    return matplotlib.rc_context(PICTURE_STYLE)


def panels(
    rows: int,
    columns: int = 1,
    share_time: bool = True,
    heights: Sequence[float] | None = None,
) -> tuple[Figure, list[Axes]]:
    """Make an empty figure with its panels, row by row.

    Parameters
    ----------
    rows, columns : int
    share_time : bool
        Whether all panels zoom together.
    heights : (rows,), optional
        Over the usual one.

    Returns
    -------
    figure : matplotlib.figure.Figure
    axes : list of matplotlib.axes.Axes

    Examples
    --------
    >>> from duhamel import view
    >>> figure, (upper, lower) = view.panels(2)
    >>> lines = upper.plot([0.0, 1.0], [0.0, 1.0])
    """
    heights = [1.0] * rows if heights is None else heights
    with style():
        figure = Figure(
            figsize=(
                PICTURE_WIDTH if columns == 1 else 1.3 * PICTURE_WIDTH,
                PANEL_HEIGHT * sum(heights),
            ),
            layout="constrained",
        )
        axes: Any = figure.subplots(
            rows, columns, sharex=share_time, squeeze=False, height_ratios=heights
        )
    return figure, list(axes.flat)


def entitle(figure: Figure, title: str) -> Text:
    """Put a title at the upper left of a figure.

    Raises
    ------
    PictureError
        For one that is too long, or cannot be printed.

    Examples
    --------
    >>> from duhamel import view
    >>> figure, _ = view.panels(1)
    >>> view.entitle(figure, "Case 1").get_text()
    'Case 1'
    """
    shown = title.encode("utf-8", "replace").decode("utf-8")
    if len(shown) > MAX_TITLE or not shown.isprintable():
        raise PictureError(
            f"title: expected a line of at most {MAX_TITLE} printable characters, "
            f"found {len(shown)}: {shown[:20]!r}"
        )
    return figure.suptitle(shown, x=0.01, ha="left", fontweight="bold", parse_math=False)


def add_room(figure: Figure, above: float = 0.0, below: float = 0.0) -> None:
    """Make a figure of drawn axes higher, with empty room above and below them [inch]."""
    wide, high = figure.get_size_inches()
    whole = high + above + below
    for axes in figure.axes:
        x, y, width, height = axes.get_position().bounds
        axes.set_position((x, (y * high + below) / whole, width, height * high / whole))
    figure.set_size_inches(wide, whole)


def draw(time: Array, contents: Sequence[Sequence[Curve]], title: str = "") -> Figure:
    """Draw a panel for each list of curves, which must have one unit.

    The words that all curves of a panel share stand above it, the others in its legend.

    Parameters
    ----------
    time : (n,) [s]
        Of curves without an abscissa of their own.
    contents : sequence of sequence of Curve
    title : str

    Raises
    ------
    PictureError
        Where units differ in a panel, or what its curves are over.

    Examples
    --------
    >>> import numpy as np
    >>> from duhamel import view
    >>> curve = view.Curve(("velocity", "hub", "x"), "m/s", np.ones(3), along="along")
    >>> figure = view.draw(np.array([0.0, 1.0, 2.0]), [[curve]], "Case 1")
    >>> figure.axes[0].get_title(loc="left")
    'hub, velocity along x'
    """
    for curves in contents:
        _check_panel(curves)
    of_time = [_is_over_time(curves) for curves in contents]
    figure, axes = panels(len(contents), share_time=all(of_time), heights=_heights(contents))
    exponent = exponent_of(_last(time, contents))
    with style():
        for axis, curves, is_over_time in zip(axes, contents, of_time, strict=True):
            if is_over_time:
                _fill(axis, time, curves, exponent)
            elif curves[0].paper in PLANE_PAPERS:
                planes.fill(axis, curves)
            else:
                spectra.fill(axis, curves)
                axis.set_ylabel(with_unit(curves[0].ordinate, "", curves[0].unit))
            _name(axis, curves)
        for n, axis in enumerate(axes):
            if of_time[n] and not (n + 1 < len(axes) and of_time[n + 1]):
                axis.set_xlabel(f"time [{UNIT_PREFIXES[exponent]}s]")
        entitle(figure, title)
    return figure


def _is_over_time(curves: Sequence[Curve]) -> bool:
    return curves[0].base == "s" and curves[0].paper not in PLANE_PAPERS


def _last(time: Array, contents: Sequence[Sequence[Curve]]) -> float:
    """The last time of all curves over time."""
    return max(
        (
            float((time if curve.abscissa is None else curve.abscissa)[-1])
            for curves in contents
            if _is_over_time(curves)
            for curve in curves
        ),
        default=0.0,
    )


def _heights(contents: Sequence[Sequence[Curve]]) -> list[float]:
    """Of panels, which hold their legends."""
    heights = []
    for curves in contents:
        _, labels = naming.title_and_labels(curves)
        lines = 2 + sum(len(wrap(label, MAX_LEGEND_LINE)) for label in labels)
        least = lines * LEGEND_LINE_HEIGHT / PANEL_HEIGHT
        heights.append(max(RELATIVE_HEIGHTS.get(curves[0].paper, 1.0), least))
    return heights


def save(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a picture in the format of its suffix, whole or not at all.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
    path : path
        .png, .svg, .pdf and others that matplotlib knows.

    Raises
    ------
    PictureError
        If there is no such format or folder, or no room for the panels.

    Examples
    --------
    >>> from duhamel import view
    >>> figure, _ = view.panels(1)
    >>> view.save(figure, "empty.png")
    """
    path = Path(path)
    formats = sorted(figure.canvas.get_supported_filetypes())
    suffix = require_target(path, [f".{name}" for name in formats]).removeprefix(".")
    image = io.BytesIO()
    with warnings.catch_warnings():
        warnings.filterwarnings("error", message="constrained_layout not applied")
        try:
            dots = VECTOR_DOTS_PER_INCH if suffix in VECTOR_SUFFIXES else DOTS_PER_INCH
            figure.savefig(image, format=suffix, dpi=dots)
        except UserWarning as error:
            wide, high = figure.get_size_inches()
            raise PictureError(
                f"{path}: {wide:g}x{high:g} inches are too small for its panels and legends"
            ) from error
    with renamed_when_whole(path, failure=PictureError) as whole:
        whole.write_bytes(image.getbuffer())


def _check_panel(curves: Sequence[Curve]) -> None:
    for curve in curves:
        if not len(curve.values):
            raise PictureError(f"{naming.in_full(curve)}: nothing was recorded")
    units = {curve.unit: naming.in_full(curve) for curve in curves}
    if len(units) > 1:
        several = " and ".join(f"{words} [{unit}]" for unit, words in units.items())
        raise PictureError(f"expected curves of one unit in a panel, found {several}")
    papers = {curve.paper: naming.in_full(curve) for curve in curves}
    if len(papers) > 1 and not papers.keys() <= set(PLANE_PAPERS):
        several = " and ".join(papers.values())
        raise PictureError(f"expected curves over time or of one kind of spectrum, found {several}")
    bases = {curve.base: naming.in_full(curve.across or curve) for curve in curves}
    if len(bases) > 1:
        several = " and ".join(f"{words} [{unit}]" for unit, words in bases.items())
        raise PictureError(f"expected curves over quantities of one unit, found {several}")


def _fill(axes: Axes, time: Array, curves: Sequence[Curve], time_exponent: int) -> None:
    peak = max(float(np.abs(curve.values).max()) for curve in curves)
    exponent = exponent_of(peak, curves[0].unit)
    for curve, look in zip(curves, styles(curves), strict=True):
        at = time if curve.abscissa is None else curve.abscissa
        marker = "o" if len(at) == 1 else None
        axes.plot(at / 10.0**time_exponent, curve.values / 10.0**exponent, marker=marker, **look)
    _widen(axes, LEAST_ORDINATE_SPAN * peak / 10.0**exponent)
    axes.set_ylabel(with_unit(curves[0].ordinate, UNIT_PREFIXES[exponent], curves[0].unit))


def _name(axes: Axes, curves: Sequence[Curve]) -> None:
    """What the curves share as title, and the rest as legend."""
    title, labels = naming.title_and_labels(curves)
    if curves[0].paper not in PLANE_PAPERS:  # where it stands beside the axes
        axes.set_title(fill(title, MAX_TITLE_LINE), parse_math=False)
    if any(labels):
        lines = axes.lines[: len(curves)]
        folded = [fill(label, MAX_LEGEND_LINE) for label in labels]
        legend = axes.legend(lines, folded, loc="upper left", bbox_to_anchor=(1.0, 1.0))
        for text in legend.get_texts():
            text.set_parse_math(False)


def _widen(axes: Axes, least: float) -> None:
    """Show at least this much of the ordinate: below it a curve is a level with rounding on it."""
    low, high = axes.get_ylim()
    if high - low < least:
        middle = 0.5 * (low + high)
        axes.set_ylim(middle - 0.5 * least, middle + 0.5 * least)
