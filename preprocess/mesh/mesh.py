"""Meshes and their named groups."""

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from ...cad import CadGeometry
from ...superelement.validation import Array
from ..errors import MeshError
from .cells import CELL_DIMENSIONS

IntArray = NDArray[np.int64]
NO_NODES: IntArray = np.zeros(0, dtype=np.int64)


@dataclass(frozen=True, eq=False)
class Group:
    """A named group: cells by type, as rows of `Mesh.cells[type]`, and points that belong to no
    cell.

    loose (k, 3): where the nodes are [m] that it names and the mesh leaves out, for no element has
    them.
    """

    cells: Mapping[str, IntArray]
    points: IntArray
    loose: Array = field(default_factory=lambda: np.zeros((0, 3)))

    @property
    def kinds(self) -> list[str]:
        """The types of what it holds, for messages."""
        return [*self.cells, *(["points"] if len(self.points) else [])]


@dataclass(frozen=True, eq=False)
class Mesh:
    """Points (n, 3) [m]; cells (n_cells, k) by type, both as meshio names and orders; groups.

    labels (n,): the numbers that the file gives to points, None if none; geometry: what it was
    made of, of a CAD file; shells: by type, the rows of cells (m,) that are shells beside the
    solids.

    `body_types` are the types of the cells that make the body: lines alone, or shells or solid
    cells of one or more types. Elements are counted through these types in their order: number n is
    a row of the first type with rows to spare.
    """

    name: str
    points: Array
    cells: Mapping[str, IntArray]
    groups: Mapping[str, Group]
    body_types: tuple[str, ...]
    labels: IntArray | None = None
    geometry: CadGeometry | None = None
    shells: Mapping[str, IntArray] = field(default_factory=dict)

    def with_shells(self, groups: Iterable[str]) -> "Mesh":
        """The mesh of solids whose triangles and quadrangles in these groups are shells.

        The same of other meshes; groups that it lacks are passed over.
        """
        if CELL_DIMENSIONS.get(self.body_types[0], 3) < 3:
            return self
        found: dict[str, list[IntArray]] = {}
        for group in (self.groups[name] for name in groups if name in self.groups):
            for kind, rows in group.cells.items():
                if CELL_DIMENSIONS.get(kind) == 2:
                    found.setdefault(kind, []).append(rows)
        rows_of = {kind: np.unique(np.concatenate(rows)) for kind, rows in found.items()}
        return replace(self, shells=rows_of)

    @property
    def used(self) -> NDArray[np.bool_]:
        """True (n,) for points that are nodes of an element, shells beside solids included."""
        used = np.zeros(len(self.points), dtype=np.bool_)
        for cells in self.elements.values():
            used[cells] = True
        for kind, rows in self.shells.items():
            used[self.cells[kind][rows]] = True
        return used

    @property
    def size(self) -> float:
        """The diagonal of the bounding box [m]."""
        return float(np.linalg.norm(np.ptp(self.points, axis=0)))

    @property
    def elements(self) -> dict[str, IntArray]:
        """The cells that make the body, by type, in the order of their numbers."""
        return {kind: self.cells[kind] for kind in self.body_types}

    @property
    def first(self) -> dict[str, int]:
        """The number of the first element of each type."""
        counts = [len(cells) for cells in self.elements.values()]
        return dict(zip(self.body_types, accumulate(counts, initial=0), strict=False))

    @property
    def n_elements(self) -> int:
        return sum(len(cells) for cells in self.elements.values())

    @property
    def sha256(self) -> str:
        """A digest of points, cells and groups, by which a mesh without a file is known again."""
        # Names are sorted: the order of groups is not part of the mesh.
        digest = hashlib.sha256(np.ascontiguousarray(self.points).tobytes())
        for kind, cells in sorted(self.cells.items()):
            digest.update(kind.encode() + np.ascontiguousarray(cells, dtype=np.int64).tobytes())
        for name, group in sorted(self.groups.items()):
            digest.update(name.encode() + group.points.tobytes())
            for kind, rows in sorted(group.cells.items()):
                digest.update(kind.encode() + rows.tobytes())
        return digest.hexdigest()

    def members(self, group: str) -> IntArray:
        """The numbers of the elements in a group."""
        cells = self.group(group).cells
        return np.concatenate(
            [cells[kind] + first for kind, first in self.first.items() if kind in cells]
            or [NO_NODES]
        )

    def of_kind(self, per_element: IntArray, kind: str) -> IntArray:
        """The entries of the elements of one type, from those of all (n_elements,)."""
        return per_element[self.first[kind] :][: len(self.cells[kind])]

    def element(self, number: int) -> tuple[str, int]:
        """The type of an element, and its row in the cells of that type."""
        kind = [kind for kind, first in self.first.items() if first <= number][-1]
        return kind, number - self.first[kind]

    def group(self, name: str) -> Group:
        if name not in self.groups:
            known = ", ".join(sorted(self.groups)) or "none"
            raise MeshError(f"{self.name}: no group {name!r}; the groups of the mesh are: {known}")
        return self.groups[name]

    def part(self, numbers: IntArray, groups: Iterable[str]) -> tuple["Mesh", IntArray]:
        """Some of the elements, ascending, in some of the groups, on the points (n,) that they use.

        Groups keep elements alone.
        """
        rows = {
            kind: numbers[(first <= numbers) & (numbers < first + len(self.cells[kind]))] - first
            for kind, first in self.first.items()
        }
        rows = {kind: chosen for kind, chosen in rows.items() if len(chosen)}
        used = np.zeros(len(self.points), dtype=np.bool_)
        for kind, chosen in rows.items():
            used[self.cells[kind][chosen]] = True
        # Kept points keep their order, so that parts of one mesh number them alike.
        new_row = np.cumsum(used) - 1

        def remaining(group: Group) -> Group:
            inside = {
                kind: np.flatnonzero(np.isin(chosen, group.cells[kind]))
                for kind, chosen in rows.items()
                if kind in group.cells
            }
            return Group({kind: found for kind, found in inside.items() if len(found)}, NO_NODES)

        part = Mesh(
            name=self.name,
            points=self.points[used],
            cells={kind: new_row[self.cells[kind][chosen]] for kind, chosen in rows.items()},
            groups={name: remaining(self.groups[name]) for name in groups},
            body_types=tuple(rows),
            labels=None if self.labels is None else self.labels[used],
        )
        return part, np.flatnonzero(used)

    def without_loose_nodes(self) -> "Mesh":
        """The mesh without points that belong to no element, and without cells on such points.

        Such are the reference points of Abaqus, the points of Gmsh's geometry, and grids that rigid
        elements hold.
        """
        used = self.used
        new_row = np.cumsum(used) - 1
        whole = self.only(
            {kind: np.flatnonzero(used[cells].all(axis=1)) for kind, cells in self.cells.items()}
        )

        def remaining(name: str, group: Group) -> Group:
            nodes = [
                self.groups[name].points,
                *(self.cells[kind][rows].ravel() for kind, rows in self.groups[name].cells.items()),
            ]
            named = np.unique(np.concatenate(nodes))
            return Group(
                group.cells,
                new_row[group.points[used[group.points]]],
                self.points[named[~used[named]]],
            )

        return replace(
            whole,
            points=self.points[used],
            cells={kind: new_row[cells] for kind, cells in whole.cells.items()},
            groups={name: remaining(name, group) for name, group in whole.groups.items()},
            labels=None if self.labels is None else self.labels[used],
        )

    def only(self, rows: Mapping[str, IntArray]) -> "Mesh":
        """The mesh with some of its cells, by type the rows of those, and all of its points."""

        def remaining(members: Mapping[str, IntArray]) -> dict[str, IntArray]:
            cells = {
                kind: np.flatnonzero(np.isin(rows[kind], chosen))
                for kind, chosen in members.items()
                if kind in rows
            }
            return {kind: found for kind, found in cells.items() if len(found)}

        return replace(
            self,
            cells={kind: self.cells[kind][chosen] for kind, chosen in rows.items()},
            groups={
                name: replace(group, cells=remaining(group.cells))
                for name, group in self.groups.items()
            },
            shells=remaining(self.shells),
        )
