"""The faces of solid elements, each once, with the elements beside it, and the boundary."""

from dataclasses import dataclass
from itertools import accumulate

import numpy as np

from ..errors import MeshError
from .cells import FACET_FAMILIES, FACET_TYPES, SOLID_TYPES
from .mesh import IntArray, Mesh

Patch = dict[str, IntArray]
"""Facets by type, as nodes (m, k)."""
Chosen = np.ndarray[tuple[int], np.dtype[np.bool_]]
MAX_ROW_KEY = int(np.iinfo(np.int64).max)


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

    @property
    def first(self) -> dict[str, int]:
        """The number of the first facet of each type."""
        counts = [len(nodes) for nodes in self.nodes.values()]
        return dict(zip(self.nodes, accumulate(counts, initial=0), strict=False))

    def patch(self, numbers: IntArray) -> Patch:
        """The nodes of some facets; types without any are left out."""
        patch = {}
        for kind, first in self.first.items():
            nodes = self.nodes[kind]
            rows = numbers[(numbers >= first) & (numbers < first + len(nodes))] - first
            if len(rows):
                patch[kind] = nodes[rows]
        return patch

    def within(self, chosen: Chosen) -> Chosen:
        """True (count,) for facets with all nodes among the chosen (n_points,)."""
        inside: Chosen = np.concatenate(
            [chosen[nodes].all(axis=1) for nodes in self.nodes.values()]
        )
        return inside

    def matching(self, kind: str, cells: IntArray) -> IntArray:
        """The facet (m,) with the corners of each of the cells (m, k) of a type, -1 for none."""
        # Groups of linear facets may name the faces of quadratic elements: corners tell them.
        corners = FACET_TYPES[kind].corners
        for facet_kind, first in self.first.items():
            if FACET_TYPES[facet_kind].corners == corners:
                rows = _rows(self.nodes[facet_kind][:, :corners], cells[:, :corners])
                return np.where(rows < 0, -1, rows + first)
        return np.full(len(cells), -1)


def facets_of(mesh: Mesh) -> Facets:
    """The facets of a mesh of solids; `MeshError` where neighbors do not fit each other.

    Neighbors must share the middle nodes of the face between them, and no triangle may cover half
    a quadrilateral.
    """
    kinds = list(
        dict.fromkeys(kind for solid in mesh.body_types for kind in SOLID_TYPES[solid].facets)
    )
    if not any(family.issuperset(kinds) for family in FACET_FAMILIES):
        raise MeshError(
            f"{mesh.name}: expected elements that fit each other, found "
            f"{', '.join(mesh.body_types)}, whose faces are {', '.join(kinds)}: mesh all of the "
            "body with one order of elements"
        )
    nodes, boundary = {}, []
    sides: dict[str, list[IntArray]] = {solid: [] for solid in mesh.body_types}
    first = 0
    for kind in kinds:
        faces = {}  # by type of element: (elements, sides, k)
        for solid in mesh.body_types:
            local = SOLID_TYPES[solid].facets.get(kind)
            if local is not None:
                faces[solid] = mesh.cells[solid][:, local]
        nodes[kind], numbers, count = _each_once(mesh, kind, faces)
        boundary.append(count == 1)
        for solid in faces:
            sides[solid].append(first + numbers[solid])
        first += len(count)
    joined = {solid: np.hstack(numbers) for solid, numbers in sides.items()}
    facets = Facets(nodes, np.concatenate(boundary), joined)
    _check_halves(mesh, facets)
    return facets


def _each_once(
    mesh: Mesh, kind: str, faces: dict[str, IntArray]
) -> tuple[IntArray, dict[str, IntArray], IntArray]:
    """Facets of one type from the faces (elements, sides, k) of each type of element.

    Their nodes (n, k); by type of element the facet on each side (elements, sides); and the number
    of elements (n,) that have each facet.
    """
    flat = np.concatenate([sides.reshape(-1, sides.shape[2]) for sides in faces.values()])
    _, one, facet, count = np.unique(
        _keys(flat[:, : FACET_TYPES[kind].corners]),
        return_index=True,
        return_inverse=True,
        return_counts=True,
    )
    owners, numbers, start = [], {}, 0
    for solid, sides in faces.items():
        n, n_sides, _ = sides.shape
        owners.append(np.repeat(mesh.first[solid] + np.arange(n), n_sides))
        numbers[solid] = facet[start : start + n * n_sides].reshape(n, n_sides)
        start += n * n_sides
    _check_middles(mesh, flat, flat[one[facet]], np.concatenate(owners))
    return flat[one], numbers, count


def _check_middles(mesh: Mesh, sides: IntArray, facets: IntArray, owners: IntArray) -> None:
    """The sides (m, k) of elements `owners` (m,) must have all nodes of their facets."""
    torn = (np.sort(sides, axis=1) != np.sort(facets, axis=1)).any(axis=1)
    if torn.any():
        side = int(np.argmax(torn))
        kind, row = mesh.element(int(owners[side]))
        raise MeshError(
            f"{mesh.name}: {int(torn.sum())} faces of elements share their corners but not their "
            f"middle nodes with a neighbor, first one of {kind} element {row}, at "
            f"{mesh.points[sides[side, 0]].tolist()}"
        )


def _check_halves(mesh: Mesh, facets: Facets) -> None:
    """No triangle of the boundary may have its corners among those of a quadrilateral of the
    boundary.
    """
    outer = facets.patch(np.flatnonzero(facets.boundary))
    triangles = [nodes[:, :3] for kind, nodes in outer.items() if FACET_TYPES[kind].corners == 3]
    quads = [nodes[:, :4] for kind, nodes in outer.items() if FACET_TYPES[kind].corners == 4]
    if not (triangles and quads):
        return
    # The four triangles that two diagonals cut off: either diagonal may have been used.
    halves = quads[0][:, [[0, 1, 2], [0, 2, 3], [0, 1, 3], [1, 2, 3]]]
    halved = (_rows(triangles[0], halves.reshape(-1, 3)) >= 0).reshape(-1, 4).any(axis=1)
    if halved.any():
        corners = mesh.points[quads[0][int(np.argmax(halved))]]
        raise MeshError(
            f"{mesh.name}: {halved.sum()} quadrilateral faces are bounded by triangles of their "
            f"neighbors, first one at {corners.mean(axis=0).tolist()}: what lies on both sides "
            "of it can slide and overlap; put wedges between, "
            "or mesh both sides with elements whose faces fit"
        )


def _rows(table: IntArray, wanted: IntArray) -> IntArray:
    """The row (m,) of the table (n, k) with the numbers of each wanted one (m, k), -1 for none.

    Numbers count in any order.
    """
    named = np.zeros(1 + max(int(table.max(initial=0)), int(wanted.max(initial=0))), dtype=bool)
    named[wanted] = True
    # Groups are small beside the mesh: few rows are left to sort.
    candidates = np.flatnonzero(named[table].all(axis=1))
    keys = _keys(np.vstack([table[candidates], wanted]))
    _, label = np.unique(keys, return_inverse=True)
    row = np.full(label.max(initial=-1) + 1, -1, dtype=np.int64)
    row[label[: len(candidates)]] = candidates
    return row[label[len(candidates) :]]


def _keys(table: IntArray) -> IntArray:
    """A number (n,) for each row (n, k) of numbers of 0 or more, the same where the numbers are.

    They count in any order. Keys are ordered as the sorted rows are.
    """
    first, *others = np.sort(table, axis=1).T
    digits = int(table.max(initial=0)) + 1
    keys, most = first, digits
    for column in others:
        # Numbered anew, keys stay below 64 bits however large the mesh is.
        if most * digits > MAX_ROW_KEY:
            distinct, keys = np.unique(keys, return_inverse=True)
            most = len(distinct)
        keys, most = keys * digits + column, most * digits
    return np.asarray(keys)
