"""Meshes and their named groups."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from ..superelement.validation import Array
from .errors import MeshError

IntArray = NDArray[np.int64]
NONE: IntArray = np.zeros(0, dtype=np.int64)

LINES = ("line",)
SOLIDS = ("tetra", "tetra10", "hexahedron", "hexahedron20", "hexahedron27", "wedge")
PARTS = ("vertex", "line", "line3", "triangle", "triangle6", "quad", "quad8", "quad9")
"""Cells that may bound or mark a body without being one."""

DIMENSIONS = {"vertex": 0, "line": 1, "line3": 1, "triangle": 2, "triangle6": 2, "quad": 2, "quad8": 2, "quad9": 2}


@dataclass(frozen=True, eq=False)
class Group:
    """A named part of a mesh: cells by type, as rows of `Mesh.cells[type]`, and points that belong to no cell."""

    cells: Mapping[str, IntArray]
    points: IntArray

    @property
    def kinds(self) -> list[str]:
        """The types of what it holds, for messages."""
        return [*self.cells, *(["points"] if len(self.points) else [])]


@dataclass(frozen=True, eq=False)
class Mesh:
    """Points (n, 3) [m]; cells by meshio's type names, (n_cells, n_nodes) in meshio's node order; named groups.

    `body_types` are the types of the cells that make the body: lines alone, or solid cells of one or more types.
    Elements are counted through these types in their order: number n is a row of the first type with rows to spare.
    """

    name: str
    points: Array
    cells: Mapping[str, IntArray]
    groups: Mapping[str, Group]
    body_types: tuple[str, ...]

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

    def members(self, group: str) -> IntArray:
        """The numbers of the elements in a group."""
        cells = self.group(group).cells
        return np.concatenate([cells[kind] + first for kind, first in self.first.items() if kind in cells] or [NONE])

    def element(self, number: int) -> tuple[str, int]:
        """The type of an element, and its row in the cells of that type."""
        kind = [kind for kind, first in self.first.items() if first <= number][-1]
        return kind, number - self.first[kind]

    def group(self, name: str) -> Group:
        if name not in self.groups:
            known = ", ".join(sorted(self.groups)) or "none"
            raise MeshError(f"{self.name}: no group {name!r}; the groups of the mesh are: {known}")
        return self.groups[name]
