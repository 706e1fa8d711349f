"""One quantity over another: phase planes, orbits, ways in space."""

import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ..superelement.validation import Array
from . import naming
from .curve import Curve
from .prefixes import UNIT_PREFIXES, exponent_of, with_unit
from .styles import styles

# Characters of a line beside an axis; longer ones are folded.
MAX_ABSCISSA_LINE = 90
MAX_ORDINATE_LINE = 40


def fill(axes: Axes, curves: Sequence[Curve]) -> None:
    """Draw curves over the quantities of their abscissas, which have one unit; a dot begins each.

    Where both are places in space, a length is as long up as across.
    """
    is_way = all(curve.paper == "space" for curve in curves)
    across = max(float(np.abs(_over(curve)).max()) for curve in curves)
    up = max(float(np.abs(curve.values).max()) for curve in curves)
    if is_way:
        across = up = max(across, up)
    right, high = exponent_of(across, curves[0].base), exponent_of(up, curves[0].unit)
    for curve, look in zip(curves, styles(curves), strict=True):
        axes.plot(_over(curve) / 10.0**right, curve.values / 10.0**high, **look)
    for curve, line in zip(curves, axes.get_lines(), strict=True):
        start = [[_over(curve)[0] / 10.0**right], [curve.values[0] / 10.0**high]]
        axes.plot(*start, "o", color=line.get_color(), markersize=4)
    if is_way:
        axes.set_aspect("equal", adjustable="datalim")
    over = [curve.across for curve in curves if curve.across is not None]
    _label(axes.set_xlabel, over, UNIT_PREFIXES[right], MAX_ABSCISSA_LINE)
    _label(axes.set_ylabel, curves, UNIT_PREFIXES[high], MAX_ORDINATE_LINE)


def _over(curve: Curve) -> Array:
    """The values of the other quantity (n,)."""
    assert curve.abscissa is not None
    return curve.abscissa


def _label(write: Any, curves: Sequence[Curve], prefix: str, longest: int) -> None:
    """What the curves share, with their unit."""
    shared, _ = naming.title_and_labels(curves)
    write(textwrap.fill(with_unit(shared, prefix, curves[0].unit), longest), parse_math=False)
