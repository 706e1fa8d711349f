"""The record of a quantity, and what has recorded quantities as attributes.

All that is known of a quantity stands in one `Quantity`, in the class of its owner (motion.py):

    class MotorMotion(Recorded, group="motors", owner="motor"):
        power: Array = quantity("W", "power of the motor")

The arrays of the time loop, the file, the attribute `results.motor(name).power`, the names and
legends of `plot`, the report, exports and the tables of the documentation follow from it.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, NoReturn

import numpy as np

from ..files.arrays import Array
from .batches import Batch
from .dimensions import DIMENSIONS, Axes, Axis, Dimension
from .errors import ResultsError

SUPERSCRIPTS = {"2": "²", "3": "³"}


@dataclass(frozen=True)
class Quantity:
    """A quantity of results: the one place that describes it.

    `group`, `dimensions` and, unless they are given, `attribute` and `name` are set by the class in
    which it stands.
    """

    unit: str | tuple[str, ...]
    """in the spelling of UDUNITS; where entries are lengths or angles, that of each"""
    description: str
    along: str = ""
    """the dimension of its components, if it has several"""
    name: str = ""
    """of the variable in the file and of the array of the time loop: its attribute unless given,
    behind OWNER_ where it has an owner"""
    of: str = ""
    """the dimension of its entries, where an owner has several or none"""
    attribute: str = ""
    """of its owner; "{}" stands for the name of a coordinate"""
    source: str = ""
    """the array of the time loop that holds it, where that has another name"""
    derive: Callable[[Batch], Array] | None = None
    """or else the function that computes it"""
    integer: bool = False
    sparse: bool = False
    """whether most of its values are zero, so that files compress it"""
    since: int = 0
    """the version of files that has it first, where an owner had others before"""
    plot: str | None = None
    """its name in `plot`, which several may share; "": it has none"""
    role: str = ""
    """the names that `plot` takes, where these are not those of all of its owners"""
    words: str | tuple[str, ...] = ""
    """its name in a legend, by default that in `plot` without the owner; one for each unit"""
    states: str = ""
    """what its whole numbers mean"""
    in_peaks: bool = False
    """whether a table of peaks has it unasked"""
    in_vtk: bool = False
    """whether it is a field of the bodies, or frames, that ParaView shows"""
    section: str = ""
    """of the report that draws it unasked"""
    group: str = ""
    dimensions: tuple[str, ...] = ()

    def within(
        self, attribute: str, group: str = "", owner: str = "", rows: str = "time", plot: str = ""
    ) -> "Quantity":
        """This quantity as an attribute of the owners of a group.

        plot: a pattern of names in `plot`, where they are not those in the file.
        """
        own = self.name or attribute
        name = "_".join(filter(None, (owner or rows.removeprefix("time"), own)))
        plotted = not self.of and rows == "time"
        shown = (plot.format(own) if plot else name) if self.plot is None else self.plot
        return replace(
            self,
            group=group,
            dimensions=tuple(filter(None, (rows, self.of or owner, self.along))),
            attribute=self.attribute or attribute,
            name=name,
            source="" if self.derive else self.source or name,
            plot=shown if plotted else "",
        )

    @property
    def key(self) -> str:
        return f"{self.group}/{self.attribute}"

    @property
    def owned(self) -> Dimension | None:
        """The dimension of its owners, or of their entries, if it has owners."""
        dimension = DIMENSIONS[self.dimensions[1]] if len(self.dimensions) > 1 else None
        return dimension if dimension and dimension.group else None

    @property
    def components(self) -> tuple[str, ...]:
        """The names of its components; none: it is a scalar, or of several entries."""
        return DIMENSIONS[self.along].entries if self.along else ()

    def shape(self, axes: Axes) -> tuple[int, ...]:
        """The shape of a row."""
        return tuple(len(axes[name]) for name in self.dimensions[1:])

    def entries(self, axes: Axes, owner: str) -> Any:
        """The entry of an owner in its dimension, or a slice of those of which it may have several.

        The slice is empty where the owner has none.
        """
        dimension = self.owned
        assert dimension is not None
        axis = axes.get(dimension.name, Axis(()))
        if not dimension.ragged:
            return axis.number(owner)
        found = axis.range_of(owner)
        return slice(found.start, found.stop)

    def units(self, axes: Axes, entries: Any = slice(None)) -> tuple[str, ...]:
        """The unit of each entry, or the one unit; of all entries, or some of its dimension."""
        if isinstance(self.unit, str):
            return (self.unit,)
        chosen = entries if isinstance(entries, slice) else slice(entries, entries + 1)
        return tuple(self.unit[angular] for angular in axes[self.measured].angular[chosen])

    @property
    def measured(self) -> str:
        """The dimension along which its unit differs."""
        return self.dimensions[1] if len(self.dimensions) > 1 else "event_owner"

    def take(self, batch: Batch, axes: Axes) -> Array:
        """Its rows (n, ...) of the steps of a batch; a view where its entries stand together."""
        if self.derive is not None:
            return self.derive(batch)
        array: Array = getattr(batch.output, self.source)[: len(batch.steps)]
        return array[:, _together(axes[self.dimensions[1]].rows)] if self.owned else array

    @property
    def all_units(self) -> tuple[str, ...]:
        """The units that its entries may have, each once."""
        return tuple(dict.fromkeys((self.unit,) if isinstance(self.unit, str) else self.unit))

    def __str__(self) -> str:
        """As "center of mass, in space [m]"."""
        unit = ", ".join(map(readable, self.all_units))
        return self.description if unit == "1" else f"{self.description} [{unit}]"


def lacking(results: str, version: int, names: str, since: int = 0) -> str:
    """The message that results have no such variables, with the version of their file."""
    later = f"; files have it since version {since}" if since > version else ""
    file = f"a file of version {version}{later}"
    return f"{results}: variable {names}: expected numbers, found none in {file}"


def _together(rows: Sequence[int]) -> Any:
    """Rows as an index: a slice if they are consecutive."""
    first = rows[0]
    # A slice gives a view; a list of rows would copy every batch.
    consecutive = rows[-1] - first + 1 == len(rows)
    return slice(first, first + len(rows)) if consecutive else np.array(rows)


def readable(unit: str) -> str:
    """A unit as a person writes it: "m s-2" as "m/s²", "kg m2 s-1" as "kg m²/s"."""
    above, below = list[str](), list[str]()
    for symbol, minus, power in re.findall(r"([A-Za-z]+|1)(-?)(\d*)", unit):
        factor = symbol + SUPERSCRIPTS.get(power, "")
        (below if minus else above).append(factor)
    return "/".join([" ".join(above) or "1", *below]) if unit else ""


class Attribute:
    """Quantities as an attribute of what records them: a place in its class, by which it is found.

    The arrays of an instance are in its own dictionary, where Python looks first.
    """

    def __init__(self, quantities: tuple[Quantity, ...]) -> None:
        self.quantities = quantities

    def __get__(self, instance: "Recorded | None", owner: type) -> "Attribute":
        return self if instance is None else instance.lacks(self)

    def __repr__(self) -> str:
        return f"{self.shape} {'; '.join(map(str, self.quantities))}"

    @property
    def shape(self) -> str:
        """As "(n, 3)"; k entries where an owner has several."""
        width = sum(len(quantity.components) for quantity in self.quantities)
        if any(quantity.of for quantity in self.quantities):
            return f"(n, k, {width})" if width else "(n, k)"
        if width:
            return f"(n, {width})"
        return "(n,)" if self.quantities[0].dimensions[0] == "time" else "(m,)"


def quantity(*arguments: Any, **more: Any) -> Any:
    """A field of arrays that is a quantity, with the arguments of `Quantity`."""
    return Attribute((Quantity(*arguments, **more),))


def vector(*arguments: Any, **more: Any) -> Any:
    """A field that is a quantity with components along x, y, z."""
    return quantity(*arguments, along="axis", **more)


def joined(*fields: Any) -> Any:
    """A field of several quantities, joined along the last axis."""
    return Attribute(tuple(one for field in fields for one in field.quantities))


class Recorded:
    """Arrays of an owner, or of the whole run, as attributes by the records of its class.

    Keywords of a class that has records: its group; the dimension of its owners, if it has any, and
    of its rows; and a pattern of the names of its quantities in `plot`, which are those in the file
    unless given. An attribute that results do not have, as those of earlier versions, is a
    `ResultsError` when it is asked for.
    """

    # beside `vars`, which has the arrays alone
    __slots__ = ("__dict__", "_origin")
    _origin: tuple[str, int]

    group: ClassVar[str] = ""
    owner: ClassVar[str] = ""
    quantities: ClassVar[tuple[Quantity, ...]] = ()
    kinds: ClassVar[list[type["Recorded"]]] = []
    """all classes that have records"""

    def __init_subclass__(
        cls, group: str = "", owner: str = "", rows: str = "time", plot: str = ""
    ) -> None:
        cls.group, cls.owner = group, owner
        found = [(name, one) for name, one in vars(cls).items() if isinstance(one, Attribute)]
        for name, one in found:
            one.quantities = tuple(q.within(name, group, owner, rows, plot) for q in one.quantities)
        cls.quantities = tuple(quantity for _, one in found for quantity in one.quantities)
        if cls.quantities:
            Recorded.kinds.append(cls)

    def __init__(self, arrays: Mapping[str, Any], origin: tuple[str, int] = ("", 0)) -> None:
        """arrays: by attribute; origin: the name of the results and their version."""
        vars(self).update(arrays)
        object.__setattr__(self, "_origin", origin)

    def lacks(self, attribute: Attribute) -> NoReturn:
        results, version = self._origin
        names = ", ".join(repr(quantity.name) for quantity in attribute.quantities)
        raise ResultsError(lacking(results, version, names, attribute.quantities[0].since))

    def __setattr__(self, name: str, value: Any) -> NoReturn:
        raise AttributeError(f"cannot assign to {name!r}: results are not changed")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (vars(self), self._origin)

    def __repr__(self) -> str:
        arrays = (f"{k} {v.shape}" for k, v in vars(self).items() if isinstance(v, np.ndarray))
        return f"<{type(self).__name__}: {', '.join(arrays)}>"
