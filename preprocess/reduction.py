"""Rigid interfaces: nodes that follow a frame, and the model on the dofs that are left."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import scipy.sparse as sp

from .errors import InterfaceError
from .interfaces import Attachment
from .mesh import IntArray
from .nodes import Nodes, spider


def tie(nodes: Nodes, attachments: Mapping[str, Attachment]) -> tuple[Nodes, Any, dict[str, Any]]:
    """The nodes that are left once tied ones follow their frames, T, and the rows of every attachment on what is left.

        u = T u_left,   u_i = [I, -(X_i - X_C)~] q_C for a tied node i;   then K_left = T^T K T and M_left = T^T M T

    u_left holds the free nodes in their order, then the frames with six dofs each. T (n_u, n_left) and
    the rows (3 or 6, n_left) are sparse; those of a rigid frame pick its dofs. For solids, whose nodes have three
    dofs. Source: methods 5.1.
    """
    _check_apart(attachments)
    rigid = [attachment for attachment in attachments.values() if len(attachment.tied)]
    free = np.setdiff1d(np.arange(len(nodes.points)), [node for a in rigid for node in a.tied])
    left = Nodes(
        np.vstack([nodes.points[free], *(a.X for a in rigid)]),
        np.repeat([False, True], [len(free), len(rigid)]),
    )
    old, new, values = (
        [nodes.displacements[free].ravel()],
        [left.displacements[: len(free)].ravel()],
        [np.ones(3 * len(free))],
    )
    for place, attachment in enumerate(rigid, start=len(free)):
        arms = spider(nodes.points[attachment.tied] - attachment.X)  # (n, 3, 6)
        frame = left.first[place] + np.arange(6)
        old.append(np.repeat(nodes.displacements[attachment.tied].ravel(), 6))
        new.append(np.tile(frame, 3 * len(attachment.tied)))
        values.append(arms.ravel())
    T = sp.coo_array(
        (np.concatenate(values), (np.concatenate(old), np.concatenate(new))), shape=(nodes.n_dofs, left.n_dofs)
    ).tocsr()

    frames = iter(range(len(free), len(left.points)))
    rows = {name: _pick(left, next(frames)) if len(a.tied) else a.rows @ T for name, a in attachments.items()}
    return left, T, rows


def _pick(nodes: Nodes, node: int) -> Any:
    columns = nodes.first[node] + np.arange(6)
    return sp.coo_array((np.ones(6), (np.arange(6), columns)), shape=(6, nodes.n_dofs)).tocsr()


def _check_apart(attachments: Mapping[str, Attachment]) -> None:
    """A node can follow one frame only."""
    owner: dict[int, str] = {}
    for name, attachment in attachments.items():
        taken: IntArray = attachment.tied
        for node in taken.tolist():
            if node in owner:
                raise InterfaceError(
                    f"interfaces.{name}: rigid interfaces must not share nodes, found point {node} "
                    f"also in {owner[node]}"
                )
            owner[node] = name
