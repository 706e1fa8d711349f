"""Checks that the elements of a mesh are one body, without mechanisms."""

from collections.abc import Mapping, Sequence

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from ...superelement.validation import Array
from ..errors import MeshError
from .facets import Facets
from .mesh import IntArray, Mesh
from .nodes import spider


def check_connected(mesh: Mesh) -> None:
    """All elements must be in one piece."""
    pieces, label = _clusters(mesh.elements, len(mesh.points))
    if pieces > 1:
        sizes = np.bincount(label).tolist()
        firsts = [mesh.element(int(np.argmax(label == piece))) for piece in range(pieces)]
        points = [mesh.points[mesh.elements[kind][row, 0]].tolist() for kind, row in firsts]
        raise MeshError(
            f"{mesh.name}: expected one connected body, found {pieces} pieces of "
            f"{_listing(sizes)} elements, which hold the points {_listing(points)}"
        )


def check_no_mechanism(mesh: Mesh, facets: Facets) -> None:
    """`MeshError` for solids joined at edges or single nodes alone that can swing.

    Without strain every element moves rigidly, so the rigid motions q_a of pieces held together by
    facets must agree, [I, -X~] (q_a - q_b) = 0, at every node X that they share: six motions in all
    are a free body, more a mechanism.
    """
    # Most bodies hang together by facets, and need no rank of a matrix.
    pieces, label = _clusters(facets.sides, facets.count)
    if pieces == 1:
        return
    motions, joints = _motions(mesh, pieces, label)
    if motions > 6:
        raise MeshError(
            f"{mesh.name}: the body is a mechanism: it has {motions} motions without strain, "
            f"expected 6; {pieces} pieces of {_listing(np.bincount(label).tolist())} elements "
            f"hang together at single nodes or edges only, at {_listing(joints.tolist())}"
        )


def _motions(mesh: Mesh, pieces: int, label: IntArray) -> tuple[int, Array]:
    """The number of motions without strain, and the points where pieces meet."""
    element, node = _incidence(mesh.elements)
    pairs = np.unique(np.stack([node, label[element]], axis=1), axis=0)
    same = pairs[1:, 0] == pairs[:-1, 0]
    nodes, one, other = pairs[1:][same, 0], pairs[:-1][same, 1], pairs[1:][same, 1]
    # In units of the mesh, so that translations and rotations have one rank tolerance.
    arms = spider((mesh.points[nodes] - mesh.points.mean(axis=0)) / mesh.size)
    rows = np.zeros((len(nodes), 3, pieces, 6))
    rows[np.arange(len(nodes)), :, one] = arms
    rows[np.arange(len(nodes)), :, other] -= arms
    return 6 * pieces - int(np.linalg.matrix_rank(rows.reshape(-1, 6 * pieces))), mesh.points[
        np.unique(nodes)
    ]


def _clusters(members: Mapping[str, IntArray], n_members: int) -> tuple[int, IntArray]:
    """The number of clusters of elements that share members, and that of every element.

    members (n, k) by type of element, all of them used; clusters (n_elements,).
    """
    n = sum(len(rows) for rows in members.values())
    element, member = _incidence(members)
    # One graph of elements and members: its edges are fewer than those between elements that touch.
    graph = sp.coo_array(
        (np.ones(len(element)), (element, n + member)), shape=(n + n_members, n + n_members)
    )
    count, label = connected_components(graph, directed=False)
    return int(count), label[:n].astype(np.int64)


def _incidence(members: Mapping[str, IntArray]) -> tuple[IntArray, IntArray]:
    """Pairs of an element's number and a member of it, from the members (n, k) of each type of
    element.
    """
    per_element = np.concatenate([np.full(len(rows), rows.shape[1]) for rows in members.values()])
    return np.repeat(np.arange(len(per_element)), per_element), np.concatenate(
        [r.ravel() for r in members.values()]
    )


def _listing(items: Sequence[object]) -> str:
    return ", ".join(str(item) for item in items[:4]) + (", ..." if len(items) > 4 else "")
