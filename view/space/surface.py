"""How the facets of a body are shaded: smooth, but for its sharp edges, which are drawn."""

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ...superelement.cells import IntArray
from ...superelement.cells import normals as normals_of
from ...superelement.validation import Array

SHARP = np.cos(np.radians(35.0))
"""of the angle between neighboring triangles from which on their edge is sharp"""
SIDES = {
    3: (0, 1, 2),
    4: (0, 1, 2, 3),
    6: (0, 3, 1, 4, 2, 5),
    8: (0, 4, 1, 5, 2, 6, 3, 7),
    9: (0, 4, 1, 5, 2, 6, 3, 7),
}
"""the points around a facet by its number of points, in meshio's order"""


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles with points that are doubled along sharp edges.

    copies (q,): which point of the body each one is; triangles (m, 3): rows of them; edges (e, 2):
    the sharp ones, as rows of points of the body; closed: it encloses something and turns outwards,
    so that its insides are never seen.
    """

    copies: IntArray
    triangles: IntArray
    edges: IntArray
    closed: bool
    _spread: sparse.csr_array

    def normals(self, points: Array) -> Array:
        """Unit normals (q, 3) at its points (q, 3), by the areas of the triangles there."""
        sums = self._spread @ normals_of(points, self.triangles)
        length = np.linalg.norm(sums, axis=1)[:, None]
        unit: Array = sums / np.where(length > 0.0, length, 1.0)
        return unit


def surface(points: Array, triangles: IntArray) -> Surface:
    """Triangles (m, 3) of points (p, 3) at rest, split along sharp edges."""
    sides, left, right, open_sides = _neighbors(triangles)
    normals = normals_of(points, triangles)
    lengths = np.linalg.norm(normals, axis=1)[:, None]
    normals = normals / np.where(lengths > 0.0, lengths, 1.0)
    smooth = (normals[left] * normals[right]).sum(axis=1) > SHARP
    m = len(triangles)
    joined = sparse.coo_array((np.ones(smooth.sum()), (left[smooth], right[smooth])), (m, m))
    _, patch = connected_components(joined, directed=False)
    corners = np.stack([triangles.ravel(), np.repeat(patch, 3)], axis=1)
    unique, which = np.unique(corners, axis=0, return_inverse=True)
    split = which.reshape(-1, 3)
    rows, columns = split.ravel(), np.repeat(np.arange(m), 3)
    spread = sparse.csr_array((np.ones(3 * m), (rows, columns)), shape=(len(unique), m))
    edges = np.vstack([sides[~smooth], open_sides])
    return Surface(unique[:, 0], split, edges, _closed(points, triangles, open_sides), spread)


def _closed(points: Array, triangles: IntArray, open_sides: IntArray) -> bool:
    """Whether triangles meet at all sides, run through once each way, around a volume above 0."""
    ends = np.concatenate([triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    ways = np.unique(ends, axis=0)
    centered = points - points.mean(axis=0)
    a, b, c = centered[triangles].transpose(1, 0, 2)
    volume = np.einsum("ij,ij->", a, np.cross(b, c))
    return not len(open_sides) and len(ways) == len(ends) and bool(volume > 0.0)


def _neighbors(triangles: IntArray) -> tuple[IntArray, IntArray, IntArray, IntArray]:
    """Sides (e, 2) of two triangles, these (e,) and (e,); and the sides of one alone."""
    ends = np.concatenate([triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    of = np.tile(np.arange(len(triangles)), 3)
    ends = np.sort(ends, axis=1)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    ends, of = ends[order], of[order]
    same = (ends[1:] == ends[:-1]).all(axis=1)
    met = np.zeros(len(ends), dtype=bool)
    met[1:] |= same
    met[:-1] |= same
    first = np.flatnonzero(same)
    return ends[first], of[first], of[first + 1], ends[~met]


def mesh_edges(cells: IntArray) -> IntArray:
    """The sides (e, 2) of facets (n, k), of which -1 fills short rows, each once."""
    lengths = (cells >= 0).sum(axis=1)
    found = [np.zeros((0, 2), dtype=np.int64)]
    for length, around in SIDES.items():
        if not (lengths == length).any():
            continue
        loop = cells[lengths == length][:, around]
        found.append(np.stack([loop, np.roll(loop, -1, axis=1)], axis=-1).reshape(-1, 2))
    unique: IntArray = np.unique(np.sort(np.concatenate(found), axis=1), axis=0)
    return unique
