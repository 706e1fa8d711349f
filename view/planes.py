"""One quantity over another: phase planes, orbits, ways in space."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from .prefixes import PREFIXES, exponent_of, with_unit
from .quantities import Curve
from .styles import styles


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
    names = list(dict.fromkeys(curve.across for curve in curves))
    axes.set_xlabel(
        with_unit(names[0] if len(names) == 1 else "", PREFIXES[right], curves[0].base),
        parse_math=False,
    )
    axes.set_ylabel(with_unit(curves[0].ordinate, PREFIXES[high], curves[0].unit))
