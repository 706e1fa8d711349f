"""Tables of peaks: the largest and smallest values of quantities, when, and where."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from ..files.arrays import Array
from .errors import QuantityError
from .quantities import KINDS_BY_NAME
from .results import Results
from .space import Place
from .steps import batches
from .transforms import FREQUENCY, IN_G, Series, in_g, parse, series
from .wildcards import named, of_all

# Stresses have more components, and no length.
MAX_VECTOR_COMPONENTS = 3
STRESS_PREFIX = "von_mises:"
# Values at points times steps in memory together.
PEAK_BATCH_VALUES = 1_000_000
# A component so much smaller than the largest of its vector is rounding, and left out.
NEGLIGIBLE_COMPONENT_SHARE = 1e-6


@dataclass(frozen=True)
class Peak:
    """The extremes of one number over time, or over frequency.

    Parameters
    ----------
    quantity : str
        As outputs of studies have it; |QUANTITY| for the length of a vector, or von_mises:BODY.
    unit : str
    largest, smallest : float
    at_largest, at_smallest : float
        Times or frequencies, in the unit `base`.
    base : {"s", "Hz"}
    place : Place, optional
        Of a stress: the point of the surface, in the mesh.
    band : float [Hz]
        Of a spectrum: the frequency up to which the superelement is right.

    Examples
    --------
    >>> peak = Peak("height:ball:z", "m", 2.0, 0.1, -3.0, 0.4, "s")
    >>> peak.magnitude, peak.is_beyond
    (3.0, False)
    """

    quantity: str
    unit: str
    largest: float
    at_largest: float
    smallest: float
    at_smallest: float
    base: str
    place: Place | None = None
    """of a stress: the point of the surface, in the mesh"""
    band: float = np.inf
    """of a spectrum: the frequency up to which the superelement is right [Hz]"""

    @property
    def is_beyond(self) -> bool:
        """Whether the largest value is one of a spectrum beyond the band of the superelement."""
        return self.base == FREQUENCY and self.at_largest > self.band

    @property
    def magnitude(self) -> float:
        """The larger absolute value of both extremes."""
        return max(abs(self.largest), abs(self.smallest))


def peaks(
    results: Results, quantities: Iterable[str] = (), gravities: bool = False
) -> tuple[Peak, ...]:
    """Find the peaks of quantities, or of what is made of them, as "srs(acceleration:hub:z)".

    Parameters
    ----------
    results : Results
    quantities : iterable of str
        In names `*` stands for anything: "acceleration:bracket.*:z". "von_mises:BODY" is the
        largest equivalent stress on the surface, with its point. Without quantities:
        accelerations, forces and elastic displacements of all.
    gravities : bool
        Accelerations in g.

    Returns
    -------
    tuple of Peak
        Of a vector without axis, each axis that is more than rounding, and its length over time.
        The peaks of each argument are in descending order of magnitude.

    Raises
    ------
    QuantityError
        For a quantity that the results do not have; the message lists those that they have.
    RecoveryError
        For stresses without recovery.

    Examples
    --------
    >>> import duhamel as du
    >>> m = du.Mechanism(gravity=[0.0, 0.0, -10.0])
    >>> ball = m.add(du.RigidBody(1.0, [0.1, 0.1, 0.1]), name="ball")
    >>> results = m.simulate(1.0, step=0.1).results
    >>> (peak,) = peaks(results, ["acceleration:ball:z"], gravities=True)
    >>> round(peak.smallest, 3), peak.unit
    (-1.02, 'g')
    """
    quantities = tuple(quantities)
    if not quantities:
        return _unasked(results, gravities)
    found: list[Peak] = []
    for quantity in quantities:
        if quantity.startswith(STRESS_PREFIX):
            found.append(_stress(results, quantity))
        else:
            found += _alike(results, quantity, gravities)
    return tuple(found)


def _alike(results: Results, quantity: str, gravities: bool) -> list[Peak]:
    """The peaks of a quantity, or of all that it stands for that have it, as sensors of a kind.

    The largest one comes first.
    """
    found = of_all(named(results, quantity), lambda name: _of(results, name, gravities))
    return sorted(found, key=lambda peak: -peak.magnitude)


def _stress(results: Results, quantity: str) -> Peak:
    """The extremes over time of the largest stress on a body, and the point of the largest."""
    body = quantity.removeprefix(STRESS_PREFIX)
    if body not in results.superelement_files:
        known = ", ".join(results.superelement_files) or "none"
        raise QuantityError(f"{quantity}: no flexible body {body!r}; there are: {known}")
    # By a search that looks at few steps and points, see search.py.
    found, time = results.field_extremes(body, "von_mises"), results.time
    at_largest, at_smallest = float(time[found.at_largest]), float(time[found.at_smallest])
    extremes = found.largest, at_largest, found.smallest, at_smallest
    return Peak(quantity, "Pa", *extremes, "s", results.place(body, found.point))


def largest_over_time(values: Callable[[Array], Array], time: Array, points: int) -> Array:
    """The largest (n,) of the values (k, p) at each of the times (n,).

    values: a function of times (k,), at so many points, of which few enough for memory are taken
    at once.
    """
    parts = batches(len(time), PEAK_BATCH_VALUES // max(points, 1))
    return np.concatenate([values(time[rows]).max(axis=1) for rows in parts])


def _of(results: Results, quantity: str, gravities: bool) -> Iterator[Peak]:
    made = series(results, quantity)
    if gravities and made.unit in IN_G:
        made = in_g(made)
    if not made.axes:
        yield _peak(quantity, made, made.values)
        return
    within, _ = parse(quantity)
    sizes = np.abs(made.values).max(axis=0)
    for axis, column, size in zip(made.axes, made.values.T, sizes, strict=True):
        if 0.0 < size < NEGLIGIBLE_COMPONENT_SHARE * sizes.max():
            continue
        yield _peak(quantity.replace(within, f"{within}:{axis}"), made, column)
    if made.base == "s" and len(made.axes) <= MAX_VECTOR_COMPONENTS:
        yield _peak(f"|{quantity}|", made, np.linalg.norm(made.values, axis=1))


def _peak(quantity: str, made: Series, values: Array) -> Peak:
    high, low = int(values.argmax()), int(values.argmin())
    return Peak(
        quantity,
        made.unit,
        float(values[high]),
        float(made.abscissa[high]),
        float(values[low]),
        float(made.abscissa[low]),
        made.base,
        band=made.band,
    )


def _unasked(results: Results, gravities: bool) -> tuple[Peak, ...]:
    """Those of the kinds that are looked at unasked, of all that the run recorded of them."""
    found: list[Peak] = []
    for name, kind in KINDS_BY_NAME.items():
        if kind.in_peaks:
            with suppress(QuantityError):
                everything = ":".join([name, *("*" for _ in kind.names)])
                found += _alike(results, everything, gravities)
    if not found:
        raise QuantityError(
            "the run recorded no quantity that a table of peaks has by default: name quantities"
        )
    return tuple(found)
