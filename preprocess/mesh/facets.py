"""The faces of solid elements: which there are, which lie on the boundary, which a group names."""

from dataclasses import dataclass

import numpy as np

from ..errors import MeshError
from .mesh import IntArray, Mesh

TETRA = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
TETRA10 = [[0, 2, 1, 6, 5, 4], [0, 1, 3, 4, 8, 7], [1, 2, 3, 5, 9, 8], [2, 0, 3, 6, 7, 9]]
HEXAHEDRON = [[0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]]
_MIDDLES = [
    [16, 15, 19, 11],
    [9, 18, 13, 17],
    [8, 17, 12, 16],
    [19, 14, 18, 10],
    [11, 10, 9, 8],
    [12, 13, 14, 15],
]
HEXAHEDRON20 = [corners + middles for corners, middles in zip(HEXAHEDRON, _MIDDLES, strict=True)]
HEXAHEDRON27 = [[*facet, 20 + i] for i, facet in enumerate(HEXAHEDRON20)]

WEDGE_TRIANGLES = [[0, 2, 1], [3, 4, 5]]
WEDGE_QUADS = [[0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]]

# Local facets in meshio's order of nodes: corners, then the middles of the sides between them, then
# the middle.
LOCAL = {
    "tetra": {"triangle": TETRA},
    "tetra10": {"triangle6": TETRA10},
    "hexahedron": {"quad": HEXAHEDRON},
    "hexahedron20": {"quad8": HEXAHEDRON20},
    "hexahedron27": {"quad9": HEXAHEDRON27},
    "wedge": {"triangle": WEDGE_TRIANGLES, "quad": WEDGE_QUADS},
}
"""The facets of each type of solid, by their own type."""
CORNERS = {"triangle": 3, "triangle6": 3, "quad": 4, "quad8": 4, "quad9": 4}
FAMILIES = ({"triangle", "quad"}, {"triangle6", "quad8"}, {"triangle6", "quad9"})
"""Facets that may bound one body: those with the same nodes on their sides."""

Patch = dict[str, IntArray]
"""Facets by type, as nodes (m, k)."""
Chosen = np.ndarray[tuple[int], np.dtype[np.bool_]]


@dataclass(frozen=True, eq=False)
class Facets:
    """Every face of the elements once; facets are counted through their types in the order of
    `nodes`.

    nodes: (n, k) by type of facet, corners first; boundary (count,): whether a facet has one
    element only; sides: by type of element (n_elements, n_local), the number of the facet on each
    side.
    """

    nodes: Patch
    boundary: Chosen
    sides: dict[str, IntArray]

    @property
    def count(self) -> int:
        return len(self.boundary)

    def patch(self, numbers: IntArray) -> Patch:
        """The nodes of some facets; types without any are left out."""
        found, first = {}, 0
        for kind, nodes in self.nodes.items():
            rows = numbers[(numbers >= first) & (numbers < first + len(nodes))] - first
            if len(rows):
                found[kind] = nodes[rows]
            first += len(nodes)
        return found

    def within(self, chosen: Chosen) -> Chosen:
        """Which facets (count,) have all their nodes among the chosen (n_points,)."""
        inside: Chosen = np.concatenate(
            [chosen[nodes].all(axis=1) for nodes in self.nodes.values()]
        )
        return inside

    def matching(self, kind: str, cells: IntArray) -> IntArray:
        """The number (m,) of the facet with the corners of each of the cells (m, k) of a type, or
        -1 where none has.
        """
        first = 0
        for own, nodes in self.nodes.items():
            if CORNERS[own] == CORNERS[kind]:
                rows = _rows(nodes[:, : CORNERS[own]], cells[:, : CORNERS[own]])
                return np.where(rows < 0, -1, rows + first)
            first += len(nodes)
        return np.full(len(cells), -1)


def facets_of(mesh: Mesh) -> Facets:
    """The facets of a mesh of solids; `MeshError` where neighbours do not fit each other.

    Neighbours must share the middle nodes of the face between them, and no triangle may cover half
    a quadrilateral.
    """
    kinds = list(dict.fromkeys(kind for solid in mesh.body_types for kind in LOCAL[solid]))
    if not any(family.issuperset(kinds) for family in FAMILIES):
        raise MeshError(
            f"{mesh.name}: expected elements that fit each other, found "
            f"{', '.join(mesh.body_types)}, whose faces are {', '.join(kinds)}: mesh all of the "
            "body with one order of elements"
        )
    nodes, boundary = {}, []
    sides: dict[str, list[IntArray]] = {solid: [] for solid in mesh.body_types}
    first = 0
    for kind in kinds:
        local = {
            solid: np.array(LOCAL[solid][kind]) for solid in mesh.body_types if kind in LOCAL[solid]
        }
        per_solid = {
            solid: mesh.cells[solid][:, faces] for solid, faces in local.items()
        }  # (elements, sides, k)
        flat = np.concatenate([faces.reshape(-1, faces.shape[2]) for faces in per_solid.values()])
        _, one, facet, count = np.unique(
            np.sort(flat[:, : CORNERS[kind]], axis=1),
            axis=0,
            return_index=True,
            return_inverse=True,
            return_counts=True,
        )
        facet = facet.ravel()
        owners = [
            np.repeat(np.arange(len(f)) + mesh.first[solid], f.shape[1])
            for solid, f in per_solid.items()
        ]
        _check_middles(mesh, flat, flat[one[facet]], np.concatenate(owners))
        nodes[kind] = flat[one]
        boundary.append(count == 1)
        ends = np.cumsum([f.shape[0] * f.shape[1] for f in per_solid.values()])[:-1]
        for (solid, faces), numbers in zip(
            per_solid.items(), np.split(facet + first, ends), strict=True
        ):
            sides[solid].append(numbers.reshape(faces.shape[:2]))
        first += len(one)
    facets = Facets(
        nodes, np.concatenate(boundary), {solid: np.hstack(parts) for solid, parts in sides.items()}
    )
    _check_halves(mesh, facets)
    return facets


def _check_middles(mesh: Mesh, sides: IntArray, facets: IntArray, owners: IntArray) -> None:
    """The sides (m, k) of elements `owners` (m,) must have all the nodes of their facets, not only
    the corners.
    """
    torn = (np.sort(sides, axis=1) != np.sort(facets, axis=1)).any(axis=1)
    if torn.any():
        side = int(np.argmax(torn))
        kind, row = mesh.element(int(owners[side]))
        raise MeshError(
            f"{mesh.name}: {int(torn.sum())} faces of elements share their corners but not their "
            f"middle nodes with a neighbour, first one of {kind} element {row}, at "
            f"{mesh.points[sides[side, 0]].tolist()}"
        )


def _check_halves(mesh: Mesh, facets: Facets) -> None:
    """No triangle of the boundary may have its corners among those of a quadrilateral of the
    boundary.
    """
    outer = facets.patch(np.flatnonzero(facets.boundary))
    triangles = [nodes[:, :3] for kind, nodes in outer.items() if CORNERS[kind] == 3]
    quads = [nodes[:, :4] for kind, nodes in outer.items() if CORNERS[kind] == 4]
    if not (triangles and quads):
        return
    halves = quads[0][:, [[0, 1, 2], [0, 2, 3], [0, 1, 3], [1, 2, 3]]]
    found = (_rows(triangles[0], halves.reshape(-1, 3)) >= 0).reshape(-1, 4).any(axis=1)
    if found.any():
        corners = mesh.points[quads[0][int(np.argmax(found))]]
        raise MeshError(
            f"{mesh.name}: {found.sum()} quadrilateral faces are bounded by triangles of their "
            f"neighbours, first one at {corners.mean(axis=0).tolist()}: what lies on both sides "
            "of it can slide and overlap; put wedges between, "
            "or mesh both sides with elements whose faces fit"
        )


def _rows(table: IntArray, wanted: IntArray) -> IntArray:
    """The row (m,) of the table (n, k) with the numbers of each wanted one (m, k) in any order; -1
    where none has.
    """
    _, label = np.unique(np.sort(np.vstack([table, wanted]), axis=1), axis=0, return_inverse=True)
    label = label.ravel()
    row = np.full(label.max() + 1, -1, dtype=np.int64)
    row[label[: len(table)]] = np.arange(len(table))
    return row[label[len(table) :]]
