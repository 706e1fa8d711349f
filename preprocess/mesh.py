"""Meshes and their named groups."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..superelement.validation import Array
from .errors import MeshError

IntArray = NDArray[np.int64]

LINES = ("line",)
SOLIDS = ("tetra", "tetra10", "hexahedron", "hexahedron20", "hexahedron27")
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

    `body_type` is the type of the cells that make the body: lines or one of the solid cells.
    """

    name: str
    points: Array
    cells: Mapping[str, IntArray]
    groups: Mapping[str, Group]
    body_type: str

    @property
    def size(self) -> float:
        """The diagonal of the bounding box [m]."""
        return float(np.linalg.norm(np.ptp(self.points, axis=0)))

    @property
    def elements(self) -> IntArray:
        """The cells that make the body."""
        return self.cells[self.body_type]

    def group(self, name: str) -> Group:
        if name not in self.groups:
            known = ", ".join(sorted(self.groups)) or "none"
            raise MeshError(f"{self.name}: no group {name!r}; the groups of the mesh are: {known}")
        return self.groups[name]
