"""Rigid interfaces: nodes that follow a frame, and the model on the dofs that are left."""

from collections.abc import Mapping
from itertools import chain
from typing import Any

import numpy as np
import scipy.sparse as sp

from ..errors import InterfaceError
from ..mesh.mesh import IntArray
from ..mesh.nodes import Nodes, spider
from ..sparse import stacked
from ..threads import in_order
from .interfaces import Attachment

TIED_ROW_PARTS = 32  # only some of the rows of a matrix are held twice at once


def tie(nodes: Nodes, attachments: Mapping[str, Attachment]) -> tuple[Nodes, Any, dict[str, Any]]:
    """Eliminate the nodes that follow rigid frames: the nodes left, T, and the rows of every frame.

        u = T u_left,   K_left = T^T K T,   M_left = T^T M T
        u_i = [I, -(X_i - X_C)~; 0, I] q_C   of a tied node i

    u_left holds the free nodes in their order, then the frames with six dofs each. T (n_u, n_left)
    and the rows (3 or 6, n_left) are sparse; those of a rigid frame pick its dofs. Nodes have three
    dofs, or six whose rotations follow the frame as well. Source: docs/theory.md, Interfaces.
    """
    rigid = {name: attachment for name, attachment in attachments.items() if attachment.rigid}
    if rigid and nodes.generalized:
        raise InterfaceError(
            f"interfaces.{next(iter(rigid))}: expected kind average, found rigid, which a reduced "
            "model with generalized coordinates does not support"
        )
    free = np.flatnonzero(_owners(rigid, len(nodes.points)) < 0)
    left = Nodes(
        np.vstack([nodes.points[free], *(a.X for a in rigid.values())]),
        np.concatenate([nodes.rotations[free], np.ones(len(rigid), dtype=bool)]),
        nodes.generalized,
    )
    owner = nodes.owner
    kept = np.flatnonzero(np.isin(owner, free) | (owner < 0))
    old, new, values = [kept], [np.arange(len(kept))], [np.ones(len(kept))]
    for node, attachment in enumerate(rigid.values(), start=len(free)):
        arms = spider(nodes.points[attachment.nodes] - attachment.X)  # (n, 3, 6)
        frame = left.first[node] + np.arange(6)
        old.append(np.repeat(nodes.displacements[attachment.nodes].ravel(), 6))
        new.append(np.tile(frame, 3 * len(attachment.nodes)))
        values.append(arms.ravel())
        # Nodes of beams turn with the frame as well; those of solids have nothing to turn.
        turning = nodes.first[attachment.nodes[nodes.rotations[attachment.nodes]]]
        old.append((turning[:, None] + np.arange(3, 6)).ravel())
        new.append(np.tile(frame[3:], len(turning)))
        values.append(np.ones(3 * len(turning)))
    T = sp.coo_array(
        (np.concatenate(values), (np.concatenate(old), np.concatenate(new))),
        shape=(nodes.n_dofs, left.n_dofs),
    ).tocsr()

    frames = iter(range(len(free), len(left.points)))
    rows = {
        name: _pick(left, next(frames)) if a.rigid else a.rows @ T
        for name, a in attachments.items()
    }
    return left, T, rows


def reduced(matrix: Any, T: Any, n_tied: int) -> Any:
    """T^T matrix T, csc, of a symmetric one; the last n_tied columns of T are those of frames.

        T = [I; S] but for the order of rows:  [A_ff, A_f S; S^T A_f^T, S^T A S]

    Symmetric to the last bit, for nothing is summed but in the rows and columns of the frames.
    """
    n_free = T.shape[1] - n_tied
    free = T[:, :n_free].tocsc().indices
    S = T[:, n_free:].tocsr()
    pulled = (matrix @ S).tocsr()
    # The one block that is a sum of products, and so the one that rounding makes unsymmetric.
    corner = S.T @ pulled
    corner, border = 0.5 * (corner + corner.T), pulled[free]
    rows = matrix.T.tocsr()  # of a symmetric csc matrix: without a copy

    def piece(part: IntArray) -> Any:
        return sp.hstack([rows[free[part]][:, free], border[part]], format="csr")

    last = sp.hstack([border.T, corner], format="csr")
    parts = np.array_split(np.arange(n_free), TIED_ROW_PARTS)
    most = matrix.nnz + 2 * border.nnz + corner.nnz
    return stacked(chain(in_order(piece, parts), [last]), T.shape[1], most)


def _pick(nodes: Nodes, node: int) -> Any:
    columns = nodes.first[node] + np.arange(6)
    return sp.coo_array((np.ones(6), (np.arange(6), columns)), shape=(6, nodes.n_dofs)).tocsr()


def _owners(rigid: Mapping[str, Attachment], n_points: int) -> IntArray:
    """The number of the rigid frame of every point (n_points,), -1 for none; one at most."""
    owner = np.full(n_points, -1, dtype=np.int64)
    names = list(rigid)
    for number, (name, attachment) in enumerate(rigid.items()):
        taken = attachment.nodes[owner[attachment.nodes] >= 0]
        if len(taken):
            raise InterfaceError(
                f"interfaces.{name}: rigid interfaces must not share nodes, found point {taken[0]} "
                f"also in {names[owner[taken[0]]]}"
            )
        owner[attachment.nodes] = number
    return owner
