"""Quantities of results as curves: one number over time, over frequency, or over another one."""

from dataclasses import dataclass

import numpy as np

from ..results import QuantityError, Results
from ..results.quantities import KINDS_BY_NAME
from ..results.transforms import IN_G, TIME, Series, Window, in_g, series
from ..superelement.validation import Array
from . import naming

NEGLIGIBLE = 1e-6
"""a component this much smaller than the largest one is rounding, or as good as zero in a picture
"""

AGAINST = " against "
"""what stands between two quantities of which one is drawn over the other"""
PLANES = ("plane", "space")


@dataclass(frozen=True, eq=False)
class Curve:
    """One number over time, over frequency, or over another number.

    words: its kind, its owners, its axis, what was made of it.
    """

    words: tuple[str, ...]
    unit: str
    values: Array
    """(n,)"""
    abscissa: Array | None = None
    """(n,), unless it is the time of all curves of a picture"""
    base: str = "s"
    """the unit of the abscissa, s or Hz, or that of another quantity"""
    ordinate: str = ""
    """what the values are, where the kind does not say it"""
    paper: str = "lines"
    """lines, log, bands or tripartite; of two quantities plane, or space for a way in space"""
    along: str = ""
    """what stands between the kind and the axis: "about" """
    run: str = ""
    """the name of its run, where there are several"""
    across: "Curve | None" = None
    """the quantity of its abscissa, if that is one"""
    band: float = np.inf
    """of a spectrum: the frequency up to which the superelement is right [Hz]"""


def curves(
    results: Results, quantity: str, gravities: bool = False, window: Window | None = None
) -> list[Curve]:
    """The curves of a quantity, as angular_velocity:hub:z, of what is made of one, as
    srs(acceleration:hub:z), or of one against another, as "position:tip:y against position:tip:x".

    Without an axis, a vector gives the curves of those axes along which it is not zero.
    gravities: accelerations in g; window: from and to [s], cut before anything is made of it.
    QuantityError names the quantity and lists those there are; SeriesError says why something
    cannot be made of it.
    """
    if AGAINST in quantity:
        return [_against(results, quantity, gravities, window)]
    found = _series(results, quantity, gravities, window)
    axes = found.axes or (found.axis,)
    columns = found.values.reshape(len(found.abscissa), -1)
    own_abscissa = window is not None or bool(found.treatment)
    return [
        Curve(
            (naming.kind(found), naming.owner(results, found), axis, *found.treatment),
            naming.unit(found),
            columns[:, axes.index(axis)],
            found.abscissa if own_abscissa else None,
            found.base,
            found.ordinate,
            found.paper,
            KINDS_BY_NAME[found.kind].preposition,
            band=found.band,
        )
        for axis in (_moving_axes(axes, columns) if found.axes else axes)
    ]


def _series(results: Results, quantity: str, gravities: bool, window: Window | None) -> Series:
    found = series(results, quantity, window)
    return in_g(found) if gravities and found.unit in IN_G else found


def _against(results: Results, text: str, gravities: bool, window: Window | None) -> Curve:
    """One number over another at the same times."""
    y, x = (_one(results, part.strip(), gravities, window) for part in text.split(AGAINST, 1))
    if not np.array_equal(x[0], y[0]):
        raise QuantityError(f"{text}: expected two quantities at the same times")
    (_, over), (_, curve) = x, y
    is_way = over.unit == curve.unit and {over.words[0], curve.words[0]} <= naming.PLACES
    return Curve(
        curve.words,
        curve.unit,
        curve.values,
        over.values,
        over.unit,
        curve.ordinate,
        "space" if is_way else "plane",
        curve.along,
        across=over,
    )


def _one(
    results: Results, quantity: str, gravities: bool, window: Window | None
) -> tuple[Array, Curve]:
    """A quantity over time that is one number, with its times."""
    found = _series(results, quantity, gravities, window)
    if found.base != TIME:
        raise QuantityError(f"{quantity}: expected a quantity over time, found a spectrum")
    if found.axes:
        axes = "|".join(found.axes)
        raise QuantityError(f"{quantity}: expected one number, with an axis: {axes}")
    (curve,) = curves(results, quantity, gravities, window)
    return found.abscissa, curve


def _moving_axes(axes: tuple[str, ...], values: Array) -> tuple[str, ...]:
    """The axes along which vectors (n, axes) are not negligible; all if they are zero."""
    peaks = np.abs(values).max(axis=0)
    moving = [
        axis for axis, peak in zip(axes, peaks, strict=True) if peak > NEGLIGIBLE * peaks.max()
    ]
    return tuple(moving) or axes
