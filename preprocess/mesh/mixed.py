"""A mesh of solids and shells as two meshes, and where the shells stand on the solids."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from ...superelement.validation import Array
from ..errors import MeshError
from .cells import CELL_DIMENSIONS
from .divided import divided
from .facets import Facets, facets_of
from .mesh import NO_NODES, Group, IntArray, Mesh

MAX_SKIN_ANGLE = np.radians(30.0)
"""Angle between a skin and its neighbor up to which the neighbor is the same sheet, not a web."""
_SKIN = "\0skin"
"""a group that goes with the cells as they are divided"""
Chosen = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class MixedMesh:
    """Solids and shells, each as a mesh.

    whole: all nodes, with the elements of both; of_solids (n_s,) and of_shells (n_h,): the node of
    the whole that each point is. A *skin* is a shell on a face of a solid, whose nodes it shares.
    Where another shell ends on a solid, its point stands apart from the node there: joined (n_h,)
    is true of these. sides: by type of shell, rows and corners (m, 2) at which sides on a solid
    begin, which the shell there does not pass as a sheet.
    """

    whole: Mesh
    solids: Mesh
    facets: Facets
    of_solids: IntArray
    shells: Mesh
    of_shells: IntArray
    joined: Chosen
    sides: Mapping[str, IntArray]

    @property
    def on_solids(self) -> Chosen:
        """True (n,) for nodes of solids."""
        found = np.zeros(len(self.whole.points), dtype=np.bool_)
        found[self.of_solids] = True
        return found


def mixed(mesh: Mesh) -> MixedMesh:
    """The solids and shells of a mesh; `MeshError` for a shell that touches a solid at one node."""
    alone = replace(mesh, shells={})
    solids, of_solids = alone.without_loose_nodes(), np.flatnonzero(alone.used)
    facets = facets_of(solids)
    surface = replace(mesh.only(mesh.shells), body_types=tuple(mesh.shells), shells={})
    on_faces = Group(_skins(surface, facets, of_solids), NO_NODES)
    groups = {**surface.groups, _SKIN: on_faces}
    surface = divided(replace(surface, groups=groups))
    skins = surface.groups[_SKIN].cells
    groups = {name: group for name, group in surface.groups.items() if name != _SKIN}
    surface = replace(surface, groups=groups)
    whole = _whole(mesh, surface)

    on_solids = np.zeros(len(surface.points), dtype=np.bool_)
    on_solids[of_solids] = True
    touching = _Touching.of(surface, skins, on_solids, facets, of_solids)
    cells = {kind: nodes.copy() for kind, nodes in surface.cells.items()}
    apart, n = np.flatnonzero(touching.apart), len(surface.points)
    new_row = np.arange(n)
    new_row[apart] = n + np.arange(len(apart))
    for kind, nodes in cells.items():
        webs = np.setdiff1d(np.arange(len(nodes)), skins.get(kind, NO_NODES))
        nodes[webs] = new_row[nodes[webs]]
    labels = surface.labels
    shells = replace(
        surface,
        points=np.vstack([surface.points, surface.points[apart]]),
        cells=cells,
        labels=None if labels is None else np.concatenate([labels, labels[apart]]),
    )
    used = np.flatnonzero(shells.used)
    return MixedMesh(
        whole=whole,
        solids=solids,
        facets=facets,
        of_solids=of_solids,
        shells=shells.without_loose_nodes(),
        of_shells=np.concatenate([np.arange(n), apart])[used],
        joined=used >= n,
        sides=touching.sides,
    )


def _whole(mesh: Mesh, surface: Mesh) -> Mesh:
    """All nodes with the elements of both: other triangles and quadrangles are left out."""
    others = {
        kind: np.arange(len(cells))
        for kind, cells in mesh.cells.items()
        if kind in mesh.body_types or CELL_DIMENSIONS.get(kind, 3) < 2
    }
    rest = replace(mesh, shells={}).only(others)
    groups = {
        name: replace(group, cells={**group.cells, **surface.groups[name].cells})
        for name, group in rest.groups.items()
    }
    return replace(
        rest,
        points=surface.points,
        cells={**rest.cells, **surface.elements},
        groups=groups,
        body_types=(*mesh.body_types, *surface.body_types),
        labels=surface.labels,
    )


def _skins(surface: Mesh, facets: Facets, of_solids: IntArray) -> dict[str, IntArray]:
    """The rows of the shells that lie on a face of a solid, by type."""
    row = np.full(len(surface.points), -1)
    row[of_solids] = np.arange(len(of_solids))
    found = {}
    for kind, cells in surface.elements.items():
        rows = np.flatnonzero((row[cells] >= 0).all(axis=1))
        skins = rows[facets.matching(kind, row[cells[rows]]) >= 0]
        if kind == "quad8" and len(skins):
            middle = surface.points[cells[skins[0]]].mean(axis=0).tolist()
            raise MeshError(
                f"{surface.name}: {len(skins)} shells with eight nodes lie on faces of solids, "
                f"first at {middle}: they are divided at a node in their middle, which the solid "
                "lacks: expected nine nodes (hexahedra with 27), or elements of first order"
            )
        if len(skins):
            found[kind] = skins
    return found


@dataclass(frozen=True, eq=False)
class _Touching:
    """Where shells end on solids: nodes (n,) whose shells stand apart, and `MixedMesh.sides`."""

    apart: Chosen
    sides: dict[str, IntArray]

    @classmethod
    def of(
        cls,
        surface: Mesh,
        skins: Mapping[str, IntArray],
        on_solids: Chosen,
        facets: Facets,
        of_solids: IntArray,
    ) -> "_Touching":
        n = len(surface.points)
        skin_sides, skin_normals = [np.zeros((0, 2), dtype=np.int64)], [np.zeros((0, 3))]
        webs: dict[str, IntArray] = {}
        for kind, cells in surface.elements.items():
            rows = skins.get(kind, NO_NODES)
            webs[kind] = np.setdiff1d(np.arange(len(cells)), rows)
            skin_sides.append(_sides(cells[rows]).reshape(-1, 2))
            normals = _normals(surface.points[cells[rows]])
            skin_normals.append(np.repeat(normals, cells.shape[1], axis=0))
        of_skin = _BySide(np.concatenate(skin_sides), np.concatenate(skin_normals), n)
        faces = _Faces(facets, of_solids, n)
        sheet, ends, corner = (np.zeros(n, dtype=np.bool_) for _ in range(3))
        sides = {}
        for kind, rows in webs.items():
            cells = surface.cells[kind][rows]
            pairs = _sides(cells)
            touches: Chosen = np.all(on_solids[pairs], axis=2)
            touches[touches] = faces.have(pairs[touches])
            goes_on = np.zeros_like(touches)
            normals = np.broadcast_to(
                _normals(surface.points[cells])[:, None], (*pairs.shape[:2], 3)
            )
            goes_on[touches] = of_skin.goes_on(pairs[touches], normals[touches])
            sheet[pairs[goes_on]] = True
            stands = touches & ~goes_on
            ends[pairs[stands]] = True
            corner[cells] = True
            place = np.argwhere(stands)
            sides[kind] = np.stack([rows[place[:, 0]], place[:, 1]], axis=1)
        skin = np.zeros(n, dtype=np.bool_)
        for kind, rows in skins.items():
            skin[surface.cells[kind][rows]] = True
        lone = np.flatnonzero(corner & on_solids & ~(sheet | ends | skin))
        if len(lone):
            raise MeshError(
                f"{surface.name}: expected shells that meet solids along sides, found {len(lone)} "
                "nodes at which a shell touches a solid alone, as a hinge, first at "
                f"{surface.points[lone[0]].tolist()}"
            )
        return cls(ends & ~sheet, sides)


def _sides(cells: IntArray) -> IntArray:
    """The nodes (m, k, 2) of the sides of shells (m, k)."""
    return np.stack([cells, np.roll(cells, -1, axis=1)], axis=2)


def _normals(X: Array) -> Array:
    """Unit normals (m, 3) of shells X (m, k, 3), by their diagonals."""
    after = np.roll(X, -1, axis=1) - X
    normals = np.cross(after, np.roll(after, -1, axis=1)).sum(axis=1)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.asarray(normals / np.maximum(length, np.finfo(float).tiny))


class _BySide:
    """Skins by their sides (m, 2), with their normals (m, 3)."""

    def __init__(self, sides: IntArray, normals: Array, n: int) -> None:
        self._n = n
        keys = self._keys(sides)
        order = np.argsort(keys, kind="stable")
        self._sorted, self._normals = keys[order], normals[order]

    def _keys(self, sides: IntArray) -> IntArray:
        low, high = np.sort(sides, axis=1).T
        return np.asarray(low * self._n + high)

    def goes_on(self, sides: IntArray, normals: Array) -> Chosen:
        """Whether a skin goes on smoothly beyond these sides (m, 2) of shells with normals."""
        keys = self._keys(sides)
        first, last = (np.searchsorted(self._sorted, keys, side) for side in ("left", "right"))
        found = np.zeros(len(sides), dtype=np.bool_)
        # A side inside a skin has two neighbors, and a web on it may lie in the plane of neither.
        for i in np.flatnonzero(last > first):
            cosines = self._normals[first[i] : last[i]] @ normals[i]
            found[i] = bool((np.abs(cosines) > np.cos(MAX_SKIN_ANGLE)).any())
        return found


class _Faces:
    """Which nodes are on one face of a solid."""

    def __init__(self, facets: Facets, of_solids: IntArray, n: int) -> None:
        rows, columns = [], []
        for kind, first in facets.first.items():
            nodes = facets.nodes[kind]
            rows.append(of_solids[nodes].ravel())
            columns.append(np.repeat(first + np.arange(len(nodes)), nodes.shape[1]))
        places = np.concatenate(rows), np.concatenate(columns)
        self._on = sp.csr_array((np.ones(len(places[0])), places), shape=(n, facets.count))

    def have(self, pairs: IntArray) -> Chosen:
        """Whether the nodes of pairs (m, 2) are on a face in common."""
        shared = self._on[pairs[:, 0]].multiply(self._on[pairs[:, 1]])
        return np.asarray(shared.sum(axis=1) > 0).ravel()
