"""Checks that the elements of a mesh are one body, without mechanisms."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from ...superelement.validation import Array
from ..errors import MeshError
from .facets import Facets
from .mesh import IntArray, Mesh
from .mixed import MixedMesh
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
    motions, joints = _Held.between(mesh, label).motions(mesh, pieces)
    if motions > 6:
        raise MeshError(
            f"{mesh.name}: the body is a mechanism: it has {motions} motions without strain, "
            f"expected 6; {pieces} pieces of {_listing(np.bincount(label).tolist())} elements "
            f"hang together at single nodes or edges only, at {_listing(joints.tolist())}"
        )


def check_no_mixed_mechanism(mesh: MixedMesh) -> None:
    """`MeshError` for solids and shells that can swing against each other.

    Nodes that both share have one displacement, and the joined ends of shells turn with the solid.
    """
    solids, label = _clusters(mesh.facets.sides, mesh.facets.count)
    shells, of_shells = _clusters(mesh.shells.elements, len(mesh.shells.points))
    held = _Held.between(mesh.solids, label)
    piece_at = np.zeros(len(mesh.solids.points), dtype=np.int64)
    at, owner = _pieces_at_nodes(mesh.solids, label).T
    piece_at[at] = owner
    row = np.full(len(mesh.whole.points), -1)
    row[mesh.of_solids] = np.arange(len(mesh.of_solids))
    # Shells that share a node turn together there, so each cluster of them is one piece.
    points, pieces = _pieces_at_nodes(mesh.shells, of_shells).T
    nodes = row[mesh.of_shells[points]]
    met = nodes >= 0
    both = _Held(
        np.concatenate([held.nodes, nodes[met]]),
        np.concatenate([held.one, piece_at[nodes[met]]]),
        np.concatenate([held.other, solids + pieces[met]]),
        np.concatenate([held.turning, mesh.joined[points[met]]]),
    )
    motions, joints = both.motions(mesh.solids, solids + shells)
    if motions > 6:
        raise MeshError(
            f"{mesh.whole.name}: the body is a mechanism: it has {motions} motions without strain, "
            f"expected 6; solids in {solids} pieces and shells in {shells} hang together at nodes "
            f"at {_listing(joints.tolist())}"
        )


@dataclass(frozen=True, eq=False)
class _Held:
    """What pieces have in common at nodes (n,): one's and the other's displacement are the same.

    And their rotations where turning (n,).
    """

    nodes: IntArray
    one: IntArray
    other: IntArray
    turning: NDArray[np.bool_]

    @classmethod
    def between(cls, mesh: Mesh, label: IntArray) -> "_Held":
        """Of pieces of solids, from the number of the piece of every element."""
        pairs = _pieces_at_nodes(mesh, label)
        same = pairs[1:, 0] == pairs[:-1, 0]
        nodes = pairs[1:][same, 0]
        return cls(nodes, pairs[1:][same, 1], pairs[:-1][same, 1], np.zeros(len(nodes), dtype=bool))

    def motions(self, mesh: Mesh, pieces: int) -> tuple[int, Array]:
        """The number of motions without strain, and the points where pieces meet."""
        # In units of the mesh, so that translations and rotations have one rank tolerance.
        arms = np.zeros((len(self.nodes), 6, 6))
        arms[:, :3] = spider((mesh.points[self.nodes] - mesh.points.mean(axis=0)) / mesh.size)
        arms[:, 3:, 3:] = self.turning[:, None, None] * np.eye(3)
        rows = np.zeros((len(self.nodes), 6, pieces, 6))
        rows[np.arange(len(self.nodes)), :, self.one] = arms
        rows[np.arange(len(self.nodes)), :, self.other] -= arms
        rank = int(np.linalg.matrix_rank(rows.reshape(-1, 6 * pieces))) if len(rows) else 0
        return 6 * pieces - rank, mesh.points[np.unique(self.nodes)]


def _pieces_at_nodes(mesh: Mesh, label: IntArray) -> IntArray:
    """Pairs (m, 2) of a node and a piece that has it, each once."""
    element, node = _incidence(mesh.elements)
    return np.asarray(np.unique(np.stack([node, label[element]], axis=1), axis=0))


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
