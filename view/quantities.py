"""Quantities of results as curves: one number over time or frequency each."""

from dataclasses import dataclass

import numpy as np

from ..results import Results
from ..results.transforms import IN_G, in_g, series
from ..superelement.validation import Array

NEGLIGIBLE = 1e-6
"""a component this much smaller than the largest one is rounding, or as good as zero in a picture
"""

JOINED = {"displacement": " seen from "}
"""what stands between the names of a quantity of two"""


@dataclass(frozen=True, eq=False)
class Curve:
    """One number over time or frequency.

    words: its kind, its owners, its axis, what was made of it.
    """

    words: tuple[str, ...]
    unit: str
    values: Array
    """(n,)"""
    abscissa: Array | None = None
    """(n,), unless it is the time of all curves of a picture"""
    base: str = "s"
    """the unit of the abscissa, s or Hz"""
    ordinate: str = ""
    """what the values are, where the kind does not say it"""
    paper: str = "lines"
    """lines, log, bands or tripartite"""


def curves(results: Results, quantity: str, gravities: bool = False) -> list[Curve]:
    """The curves of a quantity, as angular_velocity:hub:z, or of what is made of one, as
    srs(acceleration:hub:z).

    Without an axis, a vector gives the curves of those axes along which it is not zero.
    gravities: accelerations in g. QuantityError names the quantity and lists those there are;
    SeriesError says why something cannot be made of it.
    """
    found = series(results, quantity)
    if gravities and found.unit in IN_G:
        found = in_g(found)
    of = JOINED.get(found.kind, " ").join(found.names)
    axes = found.axes or (found.axis,)
    columns = found.values.reshape(len(found.abscissa), -1)
    return [
        Curve(
            (found.kind.replace("_", " "), of, axis, *found.treatment),
            found.unit,
            columns[:, axes.index(axis)],
            found.abscissa if found.treatment else None,
            found.base,
            found.ordinate,
            found.paper,
        )
        for axis in (_moving_axes(axes, columns) if found.axes else axes)
    ]


def _moving_axes(axes: tuple[str, ...], values: Array) -> tuple[str, ...]:
    """The axes along which vectors (n, axes) are not negligible; all if they are zero."""
    peaks = np.abs(values).max(axis=0)
    moving = [
        axis for axis, peak in zip(axes, peaks, strict=True) if peak > NEGLIGIBLE * peaks.max()
    ]
    return tuple(moving) or axes
