"""Curves as pictures: one panel below the other, in one style."""

import io
import os
from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from cycler import cycler
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..superelement.validation import Array
from . import spectra
from .errors import PictureError
from .quantities import Curve

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
"""the palette of Okabe and Ito, which the color-blind can distinguish"""

STYLE: dict[Any, Any] = {
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

PREFIXES = {-15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
"""of units, by their powers of ten"""

WIDTH, PANEL_HEIGHT = 7.0, 2.2
"""[inch]"""

HEIGHTS = {"tripartite": 1.8}
"""of panels of other papers than lines, over that of theirs"""

UNPREFIXED = ("g",)
"""units that take no prefix"""

DOTS_PER_INCH = 110

LONGEST_TITLE = 300
"""characters: layout takes time with the square of their number"""

STEADY = 1e-4
"""the least span of the ordinate of a panel, relative to its largest value"""


def style() -> AbstractContextManager[None]:
    """The style of all pictures, for figures that are drawn by hand: `with style(): ...`."""
    return matplotlib.rc_context(STYLE)


def panels(
    rows: int,
    columns: int = 1,
    share_time: bool = True,
    heights: Sequence[float] | None = None,
) -> tuple[Figure, list[Axes]]:
    """An empty figure and its panels, row by row; heights (rows,): over the usual one."""
    heights = [1.0] * rows if heights is None else heights
    with style():
        figure = Figure(
            figsize=(WIDTH if columns == 1 else 1.3 * WIDTH, PANEL_HEIGHT * sum(heights)),
            layout="constrained",
        )
        axes: Any = figure.subplots(
            rows, columns, sharex=share_time, squeeze=False, height_ratios=heights
        )
    return figure, list(axes.flat)


def entitle(figure: Figure, title: str) -> None:
    """A title at the upper left of a figure."""
    shown = title.encode("utf-8", "replace").decode("utf-8")
    if len(shown) > LONGEST_TITLE or not shown.isprintable():
        raise PictureError(
            f"title: expected a line of at most {LONGEST_TITLE} printable characters, "
            f"found {len(shown)}: {shown[:20]!r}"
        )
    figure.suptitle(shown, x=0.01, ha="left", fontweight="bold", parse_math=False)


def draw(time: Array, contents: Sequence[Sequence[Curve]], title: str = "") -> Figure:
    """A panel for each list of curves, which must have one unit.   time (n,)

    The words that all curves of a panel share stand above it, the others in its legend.
    Raises PictureError where units differ, or what the curves are over.
    """
    of_time = [curves[0].base == "s" for curves in contents]
    heights = [HEIGHTS.get(curves[0].paper, 1.0) for curves in contents]
    figure, axes = panels(len(contents), share_time=all(of_time), heights=heights)
    exponent = _exponent(float(time[-1]))
    with style():
        for axis, curves in zip(axes, contents, strict=True):
            _check_panel(curves)
            if curves[0].base == "s":
                _fill(axis, time, curves, exponent)
            else:
                spectra.fill(axis, curves)
                axis.set_ylabel(_with_unit(curves[0].ordinate, curves[0].unit))
            _name(axis, curves)
        for axis, below in zip(axes, [*of_time[1:], False], strict=True):
            if not below and of_time[axes.index(axis)]:
                axis.set_xlabel(f"time [{PREFIXES[exponent]}s]")
        entitle(figure, title)
    return figure


def save(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a picture in the format of its suffix.

    PictureError if there is no such format or folder.
    """
    path = Path(path)
    formats = figure.canvas.get_supported_filetypes()
    if (suffix := path.suffix.removeprefix(".").lower()) not in formats:
        raise PictureError(
            f"{path}: expected a suffix of {', '.join(sorted(formats))}, found {path.suffix!r}"
        )
    if not path.parent.is_dir():
        raise PictureError(f"{path}: no folder {path.parent}")
    image = io.BytesIO()
    figure.savefig(image, format=suffix, dpi=DOTS_PER_INCH)
    try:
        path.write_bytes(image.getbuffer())
    except OSError as error:
        raise PictureError(f"{path}: cannot be written: {error}") from error


def _check_panel(curves: Sequence[Curve]) -> None:
    units = {curve.unit: _line(curve.words) for curve in curves}
    if len(units) > 1:
        several = " and ".join(f"{words} [{unit}]" for unit, words in units.items())
        raise PictureError(f"expected curves of one unit in a panel, found {several}")
    papers = {curve.paper: _line(curve.words) for curve in curves}
    if len(papers) > 1:
        several = " and ".join(papers.values())
        raise PictureError(f"expected curves over time or of one kind of spectrum, found {several}")


def _fill(axes: Axes, time: Array, curves: Sequence[Curve], time_exponent: int) -> None:
    peak = max(float(np.abs(curve.values).max()) for curve in curves)
    exponent = 0 if curves[0].unit in UNPREFIXED else _exponent(peak)
    for curve in curves:
        at = time if curve.abscissa is None else curve.abscissa
        axes.plot(at / 10.0**time_exponent, curve.values / 10.0**exponent)
    _widen(axes, STEADY * peak / 10.0**exponent)
    axes.set_ylabel(_with_unit(curves[0].ordinate, PREFIXES[exponent] + curves[0].unit))


def _name(axes: Axes, curves: Sequence[Curve]) -> None:
    """What the curves share as title, and the rest as legend."""
    longest = max(len(curve.words) for curve in curves)
    words = np.array([[*c.words, *[""] * (longest - len(c.words))] for c in curves])
    common = (words == words[0]).all(axis=0)
    axes.set_title(_line(words[0, common]), parse_math=False)
    if len(curves) > 1:
        lines, named = axes.lines[: len(curves)], [_line(row[~common]) for row in words]
        legend = axes.legend(lines, named, loc="upper left", bbox_to_anchor=(1.0, 1.0))
        for text in legend.get_texts():
            text.set_parse_math(False)


def _with_unit(ordinate: str, unit: str) -> str:
    return f"{ordinate} [{unit}]".strip()


def _widen(axes: Axes, least: float) -> None:
    """Show at least this much of the ordinate: below it a curve is a level with rounding on it."""
    low, high = axes.get_ylim()
    if high - low < least:
        middle = 0.5 * (low + high)
        axes.set_ylim(middle - 0.5 * least, middle + 0.5 * least)


def _line(words: Iterable[str]) -> str:
    return ", ".join(word for word in words if word)


def _exponent(peak: float) -> int:
    """The power of ten of the prefix that makes values up to a peak easy to read."""
    if peak == 0.0 or 0.1 <= peak < 1e4:
        return 0
    return int(np.clip(3 * np.floor(np.log10(peak) / 3), min(PREFIXES), max(PREFIXES)))
