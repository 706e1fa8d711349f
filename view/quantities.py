"""Quantities of results as curves: one number over time each."""

from dataclasses import dataclass

import numpy as np

from ..results import Results
from ..results.quantities import KINDS, evaluate
from ..superelement.validation import Array

NEGLIGIBLE = 1e-6
"""a component this much smaller than the largest one is rounding, or as good as zero in a picture
"""

JOINED = {"displacement": " seen from "}
"""what stands between the names of a quantity of two"""


@dataclass(frozen=True, eq=False)
class Curve:
    """One number over time; words: its kind, its owners, its axis."""

    words: tuple[str, str, str]
    unit: str
    values: Array
    """(n,)"""


def curves(results: Results, quantity: str) -> list[Curve]:
    """The curves of a quantity, as angular_velocity:hub:z.

    Without an axis, a vector gives the curves of those axes along which it is not zero.
    QuantityError names the quantity and lists those there are.
    """
    evaluated = evaluate(results, quantity)
    title = evaluated.kind.replace("_", " ")
    of = JOINED.get(evaluated.kind, " ").join(evaluated.names)
    values, unit = evaluated.values, evaluated.unit
    if evaluated.axis or not KINDS[evaluated.kind].axes:
        return [Curve((title, of, evaluated.axis), unit, values)]
    axes = KINDS[evaluated.kind].axes
    return [
        Curve((title, of, axis), unit, values[:, axes.index(axis)])
        for axis in _moving_axes(axes, values)
    ]


def _moving_axes(axes: tuple[str, ...], values: Array) -> tuple[str, ...]:
    """The axes along which vectors (n, axes) are not negligible; all if they are zero."""
    peaks = np.abs(values).max(axis=0)
    moving = [
        axis for axis, peak in zip(axes, peaks, strict=True) if peak > NEGLIGIBLE * peaks.max()
    ]
    return tuple(moving) or axes
