"""Quantities of results as curves: one number over time, over frequency, or over another one."""

import numpy as np

from ..results import QuantityError, Results
from ..results.quantities import KINDS_BY_NAME
from ..results.transforms import IN_G, TIME, Series, Window, in_g, series
from ..superelement.validation import Array
from . import naming
from .curve import Curve

# Of the largest component: smaller ones are rounding, or as good as zero in a picture.
NEGLIGIBLE_SHARE = 1e-6

# Stands between two quantities of which one is drawn over the other.
AGAINST_WORD = " against "


def curves(
    results: Results, quantity: str, gravities: bool = False, window: Window | None = None
) -> list[Curve]:
    """Evaluate a quantity as curves.

    Without an axis, a vector gives the curves of those axes along which it is not zero.

    Parameters
    ----------
    results : Results
    quantity : str
        As angular_velocity:hub:z, what is made of one, as srs(acceleration:hub:z), or one against
        another, as "position:tip:y against position:tip:x".
    gravities : bool
        Accelerations in g.
    window : (float, float) [s], optional
        From and to, cut before anything is made of it.

    Raises
    ------
    QuantityError
        Names the quantity and lists those there are.
    SeriesError
        Says why something cannot be made of it.

    Examples
    --------
    >>> from duhamel import view
    >>> import duhamel as du
    >>> m = du.Mechanism(gravity=[0.0, 0.0, -10.0])
    >>> ball = m.add(du.RigidBody(1.0, [0.1, 0.1, 0.1]), name="ball")
    >>> results = m.simulate(1.0, step=0.1).results
    >>> (curve,) = view.curves(results, "velocity:ball")
    >>> curve.words, curve.unit, curve.values[-1]
    (('velocity', 'ball', 'z'), 'm/s', np.float64(-10.0))
    """
    if AGAINST_WORD in quantity:
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
    y, x = (_one(results, part.strip(), gravities, window) for part in text.split(AGAINST_WORD, 1))
    if not np.array_equal(x[0], y[0]):
        raise QuantityError(f"{text}: expected two quantities at the same times")
    (_, over), (_, curve) = x, y
    is_way = over.unit == curve.unit and {over.words[0], curve.words[0]} <= naming.PLACE_KINDS
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
        axis
        for axis, peak in zip(axes, peaks, strict=True)
        if peak > NEGLIGIBLE_SHARE * peaks.max()
    ]
    return tuple(moving) or axes
