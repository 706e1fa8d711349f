"""The faces of solid elements: which there are, which lie on the boundary, which a group names."""

from dataclasses import dataclass

import numpy as np

from ..superelement.validation import Array
from .errors import MeshError
from .mesh import IntArray, Mesh

TETRA = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
TETRA10 = [[0, 2, 1, 6, 5, 4], [0, 1, 3, 4, 8, 7], [1, 2, 3, 5, 9, 8], [2, 0, 3, 6, 7, 9]]
HEXAHEDRON = [[0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]]
_MIDDLES = [[16, 15, 19, 11], [9, 18, 13, 17], [8, 17, 12, 16], [19, 14, 18, 10], [11, 10, 9, 8], [12, 13, 14, 15]]
HEXAHEDRON20 = [corners + middles for corners, middles in zip(HEXAHEDRON, _MIDDLES, strict=True)]
HEXAHEDRON27 = [[*facet, 20 + i] for i, facet in enumerate(HEXAHEDRON20)]

TRIANGLES = ("triangle", "triangle6")
QUADS = ("quad", "quad8", "quad9")

# Local facets of each solid in meshio's node order: corners, then the middles of the sides between them, then the
# middle of the facet.
LOCAL = {
    "tetra": (TETRA, TRIANGLES),
    "tetra10": (TETRA10, TRIANGLES),
    "hexahedron": (HEXAHEDRON, QUADS),
    "hexahedron20": (HEXAHEDRON20, QUADS),
    "hexahedron27": (HEXAHEDRON27, QUADS),
}
"""Facets, and the types of cells that can name them, by the type of the solid."""


@dataclass(frozen=True, eq=False)
class Facets:
    """Every face of the elements once: nodes (n, k), their first `corners` being corners.

    kinds are the types of cells that can name a facet, by its corners;
    sides (n_elements, n_local): the facet of each side of each element; boundary (n,): whether it has one element only.
    """

    nodes: IntArray
    corners: int
    kinds: tuple[str, ...]
    sides: IntArray
    boundary: np.ndarray[tuple[int], np.dtype[np.bool_]]

    def in_plane(self, points: Array, origin: Array, normal: Array, distance: float) -> IntArray:
        """Boundary facets (m, k) with all nodes within `distance` of a plane."""
        height = (points - origin) @ (normal / np.linalg.norm(normal))
        near = (np.abs(height[self.nodes]) <= distance).all(axis=1)
        return self.nodes[near & self.boundary]

    def matching(self, cells: IntArray) -> IntArray:
        """The facet (m,) that has the corners of each of the given cells (m, >= corners), or -1."""
        keys = np.sort(np.vstack([self.nodes[:, : self.corners], cells[:, : self.corners]]), axis=1)
        _, label = np.unique(keys, axis=0, return_inverse=True)
        label = label.ravel()
        facet_of = np.full(label.max() + 1, -1, dtype=np.int64)
        facet_of[label[: len(self.nodes)]] = np.arange(len(self.nodes))
        return facet_of[label[len(self.nodes) :]]


def facets_of(mesh: Mesh) -> Facets:
    """The facets of a mesh of solids; `MeshError` where neighbours disagree about the middle nodes between them."""
    local, kinds = LOCAL[mesh.body_type]
    corners = 3 if kinds is TRIANGLES else 4
    nodes = mesh.elements[:, np.array(local)]  # (elements, sides, k)
    flat = nodes.reshape(-1, nodes.shape[2])
    _, first, side, count = np.unique(
        np.sort(flat[:, :corners], axis=1), axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    ordered = np.sort(flat, axis=1)
    torn = (ordered != ordered[first[side.ravel()]]).any(axis=1)
    if torn.any():
        number = int(np.argmax(torn))
        raise MeshError(
            f"{mesh.name}: {int(torn.sum())} faces of elements share their corners but not their middle nodes with a "
            f"neighbour, first one of element {number // len(local)}, at {mesh.points[flat[number, 0]].tolist()}"
        )
    return Facets(flat[first], corners, kinds, side.reshape(nodes.shape[:2]), count == 1)
