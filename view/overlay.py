"""Measured curves beside those of a run."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..results.transforms import Window
from ..superelement.validation import Array
from .curve import PLANE_PAPERS, Curve
from .errors import PictureError

# The curves of a single run have no name of their own beside measured ones.
SIMULATED_LABEL = "simulated"


def overlaid(
    curves: Sequence[Curve],
    name: str,
    abscissa: Array,
    values: Array,
    window: Window | None = None,
) -> list[Curve]:
    """Add a measured curve to a panel, in its unit and over what its curves are over.

    Parameters
    ----------
    curves : sequence of Curve
    name : str
        In the legend.
    abscissa : (n,) [s or Hz]
        Times, or frequencies of a spectrum.
    values : (n,)
    window : (float, float) [s], optional
        From and to, of times.

    Raises
    ------
    PictureError
        For a panel of one quantity against another, and where nothing is within the window.

    Examples
    --------
    >>> import numpy as np
    >>> from duhamel import view
    >>> computed = view.Curve(("velocity", "hub", "x"), "m/s", np.ones(3))
    >>> both = view.overlaid([computed], "test.csv", np.array([0.0, 1.0]), np.array([0.9, 1.1]))
    >>> [curve.run for curve in both]
    ['simulated', 'test.csv']
    """
    first = curves[0]
    if first.paper in PLANE_PAPERS:
        raise PictureError(f"{name}: expected a panel over time or frequency, found a plane")
    if window is not None and first.base == "s":
        within = (abscissa >= window[0]) & (abscissa <= window[1])
        if not within.any():
            raise PictureError(f"{name}: nothing was measured in the window")
        abscissa, values = abscissa[within], values[within]
    if not np.isfinite(values).all():
        raise PictureError(f"{name}: expected finite values")
    simulated = [curve if curve.run else replace(curve, run=SIMULATED_LABEL) for curve in curves]
    longest = max(len(curve.words) for curve in curves)
    columns = zip(*(_padded(curve.words, longest) for curve in curves), strict=True)
    shared = tuple(column[0] if len(set(column)) == 1 else "" for column in columns)
    measured = replace(first, words=shared, run=name, values=values, abscissa=abscissa, across=None)
    return [*simulated, measured]


def _padded(words: tuple[str, ...], length: int) -> tuple[str, ...]:
    return (*words, *[""] * (length - len(words)))
