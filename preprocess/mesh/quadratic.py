"""Quadratic tetrahedra from linear tetrahedra and wedges, which are too stiff in bending."""

from collections.abc import Mapping

import numpy as np

from ...superelement.validation import Array
from ..errors import MeshError
from .mesh import Group, IntArray, Mesh

TETRA_CELLS, WEDGE_CELLS = "tetra", "wedge"
CELL_EDGES = {
    "tetra": [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)],
    "triangle": [(0, 1), (1, 2), (2, 0)],
}
"""pairs of corners that middle nodes are between, in the order of quadratic cells"""
QUADRATIC_TYPES = {"tetra": "tetra10", "triangle": "triangle6"}
WEDGE_TURNS = np.array(
    [
        [0, 1, 2, 3, 4, 5],
        [1, 2, 0, 4, 5, 3],
        [2, 0, 1, 5, 3, 4],
        [3, 5, 4, 0, 2, 1],
        [4, 3, 5, 1, 0, 2],
        [5, 4, 3, 2, 1, 0],
    ]
)
"""the nodes of a wedge, renumbered so that each one in turn is the first"""
WEDGE_SPLITS = np.array(
    [[[0, 1, 2, 4], [0, 4, 2, 5], [0, 4, 5, 3]], [[0, 1, 2, 5], [0, 1, 5, 4], [0, 4, 5, 3]]]
)
"""three tetrahedra of a wedge whose face opposite of node 0 is cut from 2 to 4, or from 1 to 5"""


def quadratic(mesh: Mesh) -> Mesh:
    """The same body of tetrahedra with ten nodes.

    Wedges are cut into three tetrahedra, each of their faces from its node of the lowest number, so
    that neighbors fit; then every edge has a node in its middle. Groups keep what they have.
    `MeshError` for bodies of other elements. Source: Dompierre, Labbe, Vallet, Camarero, How to
    subdivide pyramids, prisms and hexahedra into tetrahedra, 1999.
    """
    if others := sorted(set(mesh.body_types) - {TETRA_CELLS, WEDGE_CELLS}):
        raise MeshError(
            f"{mesh.name}: order = 2 is for linear tetrahedra and wedges, found {', '.join(others)}"
        )
    cells, rows = _simplices(mesh)
    edges = np.concatenate(
        [
            np.sort(nodes[:, CELL_EDGES[kind]].reshape(-1, 2), axis=1)
            for kind, nodes in cells.items()
            if kind in CELL_EDGES
        ]
    )
    # Sorted pairs: neighbors run along a shared edge in opposite directions.
    edges, number = np.unique(edges, axis=0, return_inverse=True)
    middles = mesh.points[edges].mean(axis=1)
    raised, start = {}, 0
    for kind, nodes in cells.items():
        if kind not in CELL_EDGES:
            raised[kind] = nodes
            continue
        count = len(nodes) * len(CELL_EDGES[kind])
        own = number.ravel()[start : start + count].reshape(len(nodes), -1)
        raised[QUADRATIC_TYPES[kind]] = np.column_stack([nodes, len(mesh.points) + own])
        start += count
    body = Mesh(
        name=mesh.name,
        points=np.vstack([mesh.points, middles]),
        cells=raised,
        groups={name: _group(group, rows) for name, group in mesh.groups.items()},
        body_types=(QUADRATIC_TYPES[TETRA_CELLS],),
    )
    # facets that are no faces of the body have middle nodes of their own
    return body if body.used.all() else body.without_loose_nodes()


Rows = dict[str, tuple[str, IntArray]]
"""by type of cell the type of what it has become, and the rows (n, k) of that, k of each cell"""


def _simplices(mesh: Mesh) -> tuple[dict[str, IntArray], Rows]:
    """Cells with wedges as tetrahedra and quadrilaterals as triangles."""
    parts: dict[str, list[IntArray]] = {}
    rows: Rows = {}
    for kind, nodes in mesh.cells.items():
        into, pieces = kind, nodes[:, None]
        if kind == WEDGE_CELLS:
            into, pieces = TETRA_CELLS, _tetrahedra(nodes, mesh.points)
        elif kind == "quad":
            into, pieces = "triangle", _triangles(nodes)
        first = sum(map(len, parts.get(into, ())))
        n, k = pieces.shape[:2]
        parts.setdefault(into, []).append(pieces.reshape(n * k, -1))
        rows[kind] = into, first + np.arange(n * k).reshape(n, k)
    return {kind: np.concatenate(found) for kind, found in parts.items()}, rows


def _tetrahedra(wedges: IntArray, points: Array) -> IntArray:
    """The three tetrahedra (n, 3, 4) of each wedge (n, 6)."""
    turned = np.take_along_axis(wedges, WEDGE_TURNS[wedges.argmin(axis=1)], axis=1)
    # The lowest node of a face decides its diagonal, for both wedges beside it.
    from_1_to_5 = turned[:, [1, 5]].min(axis=1) < turned[:, [2, 4]].min(axis=1)
    split = WEDGE_SPLITS[from_1_to_5.astype(int)].reshape(len(wedges), -1)
    pieces = np.take_along_axis(turned, split, axis=1).reshape(-1, 3, 4)
    a, b, c, d = points[pieces].transpose(2, 0, 1, 3)
    inverted = np.einsum("nti,nti->nt", np.cross(b - a, c - a), d - a) < 0.0
    pieces[inverted] = pieces[inverted][:, [1, 0, 2, 3]]
    return pieces


def _triangles(quads: IntArray) -> IntArray:
    """The two triangles (n, 2, 3) of each quadrilateral (n, 4), cut from its lowest node."""
    cut = np.array([[[0, 1, 2], [0, 2, 3]], [[1, 2, 3], [1, 3, 0]]])
    chosen = cut[quads.argmin(axis=1) % 2].reshape(len(quads), -1)
    return np.take_along_axis(quads, chosen, axis=1).reshape(-1, 2, 3)


def _group(group: Group, rows: Rows) -> Group:
    found: dict[str, list[IntArray]] = {}
    for kind, members in group.cells.items():
        into, pieces = rows[kind]
        found.setdefault(QUADRATIC_TYPES.get(into, into), []).append(pieces[members].ravel())
    cells: Mapping[str, IntArray] = {
        kind: np.unique(np.concatenate(parts)) for kind, parts in found.items()
    }
    return Group(cells, group.points, group.loose)
