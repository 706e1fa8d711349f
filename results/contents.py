"""The contents of results: what a run records, and a file holds."""

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from ..files.outputs import resolved
from ..superelement import sha256
from .dimensions import DIMENSIONS, FIXED_ENTRIES, Axes, Axis
from .motion import (
    EVENT_NUMBER,
    EVENT_OWNER,
    EVENT_QUANTITIES,
    OWNERS_OF_GROUP,
    QUANTITIES,
    TIME_QUANTITY,
)
from .quantity import Quantity
from .space import Space

RESULTS_FORMAT = "duhamel-results"
RESULTS_VERSION = 12
# All that files since this version hold has the same meaning today.
EARLIEST_VERSION = 3


class SuperelementFile(NamedTuple):
    """The file of a superelement, "" where there is none, with its SHA-256.

    variation: the text of the `SuperelementVariation` of the body, "" where it is as in the file.
    As long as results are in memory, with the time of its last change [ns] and its size instead,
    which cost nothing.
    """

    path: str
    digest: str = ""
    stamp: tuple[int, int] | None = None
    variation: str = ""

    @classmethod
    def of(cls, path: str | os.PathLike[str], variation: str = "") -> "SuperelementFile":
        """The file at a path as it is now."""
        path = resolved(Path(path))
        return cls(str(path), stamp=_stamp(path), variation=variation)

    def hashed(self) -> "SuperelementFile":
        """This file with its SHA-256."""
        return self._replace(digest=sha256(self.path), stamp=None) if self.stamp else self

    def change(self) -> str:
        """The difference of the file at the path from this one; "" if it is the same."""
        if self.stamp is not None:
            return "" if _stamp(Path(self.path)) == self.stamp else "it was written anew"
        digest = sha256(self.path)
        return "" if digest == self.digest else f"expected SHA-256 {self.digest}, found {digest}"


def _stamp(path: Path) -> tuple[int, int]:
    status = path.stat()
    return status.st_mtime_ns, status.st_size


@dataclass(frozen=True)
class Contents:
    """The contents of results: entries of dimensions, quantities, files of superelements, checks.

    checks: of the validity of the run, by name (validity.py). space: outlines and connections; None
    where they are in a file that is read, which has them when they are asked for.
    """

    axes: Axes
    quantities: tuple[Quantity, ...]
    superelements: Mapping[str, SuperelementFile]
    checks: tuple[str, ...] = ()
    space: Space | None = None
    version: int = RESULTS_VERSION
    """of the file"""

    @property
    def recorded(self) -> tuple[str, ...]:
        """The groups: "bodies/hub", "frames/beam.tip", "energy", ..."""
        owned = [
            f"{group}/{name}"
            for group, dimension in OWNERS_OF_GROUP.items()
            if dimension in self.axes
            for name in sorted(self.axes[dimension].names)
        ]
        groups = {quantity.group for quantity in self.quantities}
        return (*owned, *(group for group in ("energy", "momentum") if group in groups))

    def difference(self, other: "Contents") -> str:
        """The first difference of the variables of others, in words; "" if there is none."""
        # Names before entries: another set of variables makes other dimensions, too.
        names, others = ([q.name for q in c.quantities] for c in (self, other))
        if names != others:
            # Those that only one of both has.
            odd = sorted({*names} ^ {*others})
            return f"other variables are recorded: {', '.join(odd)}"
        for name in sorted({*self.axes, *other.axes}):
            axes = (self.axes.get(name, Axis(())).names, other.axes.get(name, Axis(())).names)
            if axes[0] != axes[1]:
                return f"{name}: expected {', '.join(axes[0])}, found {', '.join(axes[1])}"
        return ""


def lay_out(
    axes: Axes,
    superelements: Mapping[str, SuperelementFile],
    selects: Callable[[str], bool],
    checks: tuple[str, ...] = (),
) -> Contents:
    """The contents that are recorded of all entries and quantities, with checks of validity.

    selects: True for a group to record, "bodies/hub" or "energy".
    """
    kept = {name: Axis(entries) for name, entries in FIXED_ENTRIES.items()}
    for name, axis in axes.items():
        dimension = DIMENSIONS[name]
        chosen = axis.keep(
            lambda entry, d=dimension: (
                not d.group  # type: ignore[misc]
                or selects(f"{d.group}/{entry.rpartition('.')[0] if d.ragged else entry}")
            )
        )
        if len(chosen):
            kept[name] = chosen
    quantities = tuple(
        quantity
        for quantity in QUANTITIES
        if set(quantity.dimensions[1:]) <= kept.keys()
        and (quantity.owned is not None or quantity is TIME_QUANTITY or selects(quantity.group))
    )
    used = {dimension for quantity in quantities for dimension in quantity.dimensions}
    kept = {name: axis for name, axis in kept.items() if name in used or name not in FIXED_ENTRIES}
    return Contents(kept, quantities, superelements, checks)


def attributes_of(
    quantities: Iterable[Quantity], axes: Axes, group: str, owner: str
) -> Iterator[tuple[str, Quantity, Any]]:
    """The attributes of an owner, each with its quantity and entries of the quantity's dimension.

    An entry is a number, or a slice of those that the owner has of a ragged dimension, which may be
    none. quantities: those that there are, of which a file of an earlier version has fewer.
    """
    for quantity in quantities:
        dimension = quantity.owned
        if quantity.group != group or dimension is None:
            continue
        entries = quantity.entries(axes, owner)
        if "{}" not in quantity.attribute:
            yield quantity.attribute, quantity, entries
            continue
        for i in range(entries.start, entries.stop):
            coordinate = axes[dimension.name].names[i].rpartition(".")[2]
            yield quantity.attribute.format(coordinate), quantity, i


def table() -> str:
    """The variables as a table in Markdown, for the documentation."""
    lines = ["| variable | dimensions | unit | |", "|---|---|---|---|"]
    for one in (*QUANTITIES, EVENT_NUMBER, EVENT_OWNER, *EVENT_QUANTITIES):
        dimensions, units = ", ".join(one.dimensions), " or ".join(one.all_units)
        lines.append(f"| `{one.name}` | {dimensions} | {units} | {one.description} |")
    return "\n".join(lines)
