"""Measured curves beside those of a run."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..results.transforms import Window
from ..superelement.validation import Array
from .errors import PictureError
from .quantities import PLANES, Curve

SIMULATED = "simulated"
"""the curves of a single run, beside measured ones"""


def overlaid(
    curves: Sequence[Curve],
    name: str,
    abscissa: Array,
    values: Array,
    window: Window | None = None,
) -> list[Curve]:
    """The curves of a panel and a measured one, in their unit and over what they are over.

    name: in the legend; abscissa (n,): times [s], or frequencies [Hz] of a spectrum; values (n,);
    window: from and to, of times. `PictureError` for one quantity against another, and where
    nothing is within the window.
    """
    first = curves[0]
    if first.paper in PLANES:
        raise PictureError(f"{name}: expected a panel over time or frequency, found a plane")
    if window is not None and first.base == "s":
        within = (abscissa >= window[0]) & (abscissa <= window[1])
        if not within.any():
            raise PictureError(f"{name}: nothing was measured in the window")
        abscissa, values = abscissa[within], values[within]
    if not np.isfinite(values).all():
        raise PictureError(f"{name}: expected finite values")
    simulated = [curve if curve.run else replace(curve, run=SIMULATED) for curve in curves]
    longest = max(len(curve.words) for curve in curves)
    columns = zip(*(_padded(curve.words, longest) for curve in curves), strict=True)
    shared = tuple(column[0] if len(set(column)) == 1 else "" for column in columns)
    measured = replace(first, words=shared, run=name, values=values, abscissa=abscissa, across=None)
    return [*simulated, measured]


def _padded(words: tuple[str, ...], length: int) -> tuple[str, ...]:
    return (*words, *[""] * (length - len(words)))
