"""Quantities of results as curves: one number over time each."""

from dataclasses import dataclass

import numpy as np

from ..results import Results
from ..results.quantities import AXES, KINDS, evaluate
from ..superelement.validation import Array

NEGLIGIBLE = 1e-6
"""a component this much smaller than the largest one is rounding, or as good as zero in a picture
"""


@dataclass(frozen=True, eq=False)
class Curve:
    """One number over time. The words say what it is: the kind, of what, along which axis."""

    words: tuple[str, str, str]
    unit: str
    values: Array
    """(n,)"""


def curves(results: Results, quantity: str) -> list[Curve]:
    """The curves of a quantity, as angular_velocity:hub:z; QuantityError names the quantity and
    lists what there is.

    Without an axis, a vector gives the curves of those axes along which it is not zero.
    """
    found = evaluate(results, quantity)
    title, of = found.kind.replace("_", " "), " seen from ".join(found.names)
    if found.axis or not KINDS[found.kind].axes:
        return [Curve((title, of, found.axis), found.unit, found.values)]
    return [
        Curve((title, of, axis), found.unit, found.values[:, AXES.index(axis)])
        for axis in _moving_axes(found.values)
    ]


def _moving_axes(values: Array) -> list[str]:
    """The axes along which vectors (n, 3) are not negligible; all if they are zero."""
    peaks = np.abs(values).max(axis=0)
    moving = [
        axis for axis, peak in zip(AXES, peaks, strict=True) if peak > NEGLIGIBLE * peaks.max()
    ]
    return moving or list(AXES)
