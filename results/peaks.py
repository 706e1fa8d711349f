"""Tables of peaks: the largest and smallest values of quantities, when, and where."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fnmatch import fnmatchcase
from itertools import product

import numpy as np

from ..superelement.validation import Array
from .errors import QuantityError
from .quantities import KINDS
from .results import Results
from .transforms import IN_G, Series, check, in_g, parse, series

UNASKED = ("acceleration", "force", "normal_force", "elastic_displacement")
"""the kinds of quantities of a table for which none are named"""


@dataclass(frozen=True)
class Peak:
    """The extremes of one number over time, or over frequency.

    quantity: as outputs of studies take it, |QUANTITY| for the length of a vector; base: the unit
    of the times or frequencies `at_largest` and `at_smallest`, s or Hz.
    """

    quantity: str
    unit: str
    largest: float
    at_largest: float
    smallest: float
    at_smallest: float
    base: str

    @property
    def magnitude(self) -> float:
        return max(abs(self.largest), abs(self.smallest))


def peaks(
    results: Results, quantities: Iterable[str] = (), gravities: bool = False
) -> tuple[Peak, ...]:
    """The peaks of quantities, or of what is made of them, as "srs(acceleration:hub:z)".

    In names `*` stands for anything: "acceleration:bracket.*:z". Of a vector without axis each
    axis has a peak, and over time its length. The peaks of each argument are ordered, the largest
    one first, which is the place of it; those of all times, without quantities, of accelerations,
    forces and elastic displacements. gravities: accelerations in g.
    """
    found: list[Peak] = []
    for quantity in quantities or _unasked(results):
        alike = [peak for one in _named(results, quantity) for peak in _of(results, one, gravities)]
        found += sorted(alike, key=lambda peak: -peak.magnitude)
    return tuple(found)


def _of(results: Results, quantity: str, gravities: bool) -> Iterator[Peak]:
    made = series(results, quantity)
    if gravities and made.unit in IN_G:
        made = in_g(made)
    if not made.axes:
        yield _peak(quantity, made, made.values)
        return
    within, _ = parse(quantity)
    for axis, column in zip(made.axes, made.values.T, strict=True):
        yield _peak(quantity.replace(within, f"{within}:{axis}"), made, column)
    if made.base == "s":
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
    )


def _unasked(results: Results) -> list[str]:
    """The kinds that are looked at unasked, of all that the run recorded of them."""
    found = []
    for kind in UNASKED:
        pattern = ":".join([kind, *("*" for _ in KINDS[kind].names)])
        if _matching(results, pattern):
            found.append(pattern)
    if not found:
        raise QuantityError("there is nothing of which peaks are told unasked: name quantities")
    return found


def _named(results: Results, text: str) -> list[str]:
    """The text, or with `*` in the names of its quantity all that it stands for."""
    quantity, _ = parse(text)
    if "*" not in quantity:
        return [text]
    found = _matching(results, quantity)
    if not found:
        raise QuantityError(f"{text}: found no {quantity}")
    return [text.replace(quantity, one) for one in found]


def _matching(results: Results, pattern: str) -> list[str]:
    kind_name, *names = pattern.split(":")
    if kind_name not in KINDS:
        check(results, pattern)
    roles = KINDS[kind_name].names
    axis = names[len(roles) :]
    choices = [_owners(results, role, name) for role, name in zip(roles, names, strict=False)]
    return [":".join([kind_name, *chosen, *axis]) for chosen in product(*choices)]


def _owners(results: Results, role: str, pattern: str) -> list[str]:
    """The owners in a role, as "BODY|FRAME", that a pattern stands for."""
    if "*" not in pattern:
        return [pattern]
    names: list[str] = []
    for word in role.split("|"):
        known = "energies" if word == "ENERGY" else f"{word.lower()}s"
        names += getattr(results, "bodies" if word == "BODY" else known, ())
    return [name for name in dict.fromkeys(names) if fnmatchcase(name, pattern)]
