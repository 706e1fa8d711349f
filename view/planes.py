"""One quantity over another: phase planes, orbits, ways in space."""

import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from . import naming
from .prefixes import PREFIXES, exponent_of, with_unit
from .quantities import Curve
from .styles import styles

ACROSS, UP = 90, 40
"""characters of a line beside an axis"""


def fill(axes: Axes, curves: Sequence[Curve]) -> None:
    """Draw curves over the quantities of their abscissas, which have one unit; a dot begins each.

    Where both are places in space, a length is as long up as across.
    """
    is_way = all(curve.paper == "space" for curve in curves)
    across = max(float(np.abs(curve.abscissa).max()) for curve in curves)
    up = max(float(np.abs(curve.values).max()) for curve in curves)
    if is_way:
        across = up = max(across, up)
    right, high = exponent_of(across, curves[0].base), exponent_of(up, curves[0].unit)
    for curve, look in zip(curves, styles(curves), strict=True):
        axes.plot(curve.abscissa / 10.0**right, curve.values / 10.0**high, **look)
    for curve, line in zip(curves, axes.get_lines(), strict=True):
        start = [[curve.abscissa[0] / 10.0**right], [curve.values[0] / 10.0**high]]
        axes.plot(*start, "o", color=line.get_color(), markersize=4)
    if is_way:
        axes.set_aspect("equal", adjustable="datalim")
    over = [curve.across for curve in curves if curve.across is not None]
    _label(axes.set_xlabel, over, PREFIXES[right], ACROSS)
    _label(axes.set_ylabel, curves, PREFIXES[high], UP)


def _label(write: Any, curves: Sequence[Curve], prefix: str, longest: int) -> None:
    """What the curves share, with their unit."""
    shared, _ = naming.title_and_labels(curves)
    write(textwrap.fill(with_unit(shared, prefix, curves[0].unit), longest), parse_math=False)
