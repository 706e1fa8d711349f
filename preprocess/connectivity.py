"""Whether the elements of a mesh hang together as one body."""

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from ..superelement.validation import Array
from .errors import MeshError
from .facets import Facets
from .mesh import IntArray, Mesh
from .nodes import spider


def check_used(mesh: Mesh) -> None:
    """Every point must be a node of an element, or it has no mass."""
    unused = np.ones(len(mesh.points), dtype=bool)
    unused[mesh.elements] = False
    if unused.any():
        point = int(np.flatnonzero(unused)[0])
        raise MeshError(
            f"{mesh.name}: {unused.sum()} nodes without mass: they belong to no {mesh.body_type} element, "
            f"first point {point} at {mesh.points[point].tolist()}"
        )


def check_connected(mesh: Mesh) -> None:
    """All elements must be in one piece."""
    pieces, label = _clusters(mesh.elements, len(mesh.points))
    if pieces > 1:
        sizes = np.bincount(label).tolist()
        places = [mesh.points[mesh.elements[np.argmax(label == piece), 0]].tolist() for piece in range(pieces)]
        raise MeshError(
            f"{mesh.name}: expected one connected body, found {pieces} pieces of {_listing(sizes)} elements, "
            f"which hold the points {_listing(places)}"
        )


def check_no_mechanism(mesh: Mesh, facets: Facets) -> None:
    """Solids that share a facet move as one; those that share an edge or a node alone may swing against each other.

    Without strain every element moves rigidly, so the rigid motions q_a of pieces held together by facets must agree,
    [I, -X~] (q_a - q_b) = 0, at every node X that they share: six motions in all are a free body, more a mechanism.
    """
    pieces, label = _clusters(facets.sides, len(facets.nodes))
    if pieces == 1:
        return
    motions, joints = _motions(mesh, pieces, label)
    if motions > 6:
        raise MeshError(
            f"{mesh.name}: the body is a mechanism: it has {motions} motions without strain, expected 6; {pieces} "
            f"pieces of {_listing(np.bincount(label).tolist())} elements hang together at single nodes or edges only, "
            f"at {_listing(joints.tolist())}"
        )


def _motions(mesh: Mesh, pieces: int, label: IntArray) -> tuple[int, Array]:
    """The number of motions without strain, and the points where pieces meet."""
    of_node = np.repeat(label, mesh.elements.shape[1])
    pairs = np.unique(np.stack([mesh.elements.ravel(), of_node], axis=1), axis=0)
    same = pairs[1:, 0] == pairs[:-1, 0]
    nodes, one, other = pairs[1:][same, 0], pairs[:-1][same, 1], pairs[1:][same, 1]
    arms = spider((mesh.points[nodes] - mesh.points.mean(axis=0)) / mesh.size)
    rows = np.zeros((len(nodes), 3, pieces, 6))
    rows[np.arange(len(nodes)), :, one] = arms
    rows[np.arange(len(nodes)), :, other] -= arms
    return 6 * pieces - int(np.linalg.matrix_rank(rows.reshape(-1, 6 * pieces))), mesh.points[np.unique(nodes)]


def _clusters(members: IntArray, n_members: int) -> tuple[int, IntArray]:
    """Elements that share members (n, k), all of them used, in one cluster: how many, and which of each (n,)."""
    n, k = members.shape
    # One graph of elements and members: its edges are fewer than those between elements that touch.
    edges = (np.repeat(np.arange(n), k), n + members.ravel())
    graph = sp.coo_array((np.ones(n * k), edges), shape=(n + n_members, n + n_members))
    count, label = connected_components(graph, directed=False)
    return int(count), label[:n].astype(np.int64)


def _listing(items: Sequence[object]) -> str:
    return ", ".join(str(item) for item in items[:4]) + (", ..." if len(items) > 4 else "")
