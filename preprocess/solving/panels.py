"""Many vectors at once, and products of K + s M with them in blocks of single precision.

The unknowns are taken three by three, a node each, and vectors sixteen by sixteen: a *panel* X
(n_nodes, 3, 16) holds sixteen of them side by side, so that a block of the matrix, once it is read,
serves all of them in vector registers.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import reverse_cuthill_mckee

from ...superelement.validation import Array
from ..mesh.mesh import IntArray
from .loops import PANEL_WIDTH, Loops, Panel

NODES_AT_ONCE = 2**13  # whose rows are put into blocks


@dataclass(frozen=True, eq=False)
class Blocks:
    """S = K + s M (n_u, n_u) in blocks of 3 by 3, of single precision, all of them: both halves.

    scale: the mean of its diagonal, by which the blocks are divided.

    Nodes are put into the order of Cuthill and McKee, so that neighbors are near in memory:
    order (n_u,), the unknown that each row stands for, the last up to two being fillers of an n_u
    that is no multiple of 3. first (n_nodes + 1,), columns (n_blocks,), blocks (n_blocks, 9);
    inverses (n_nodes, 9) of the blocks on the diagonal.

    With the symmetric half a product would read half as much, and write to rows of other threads;
    with sixteen vectors, arithmetic takes as long as reading.
    """

    n_u: int
    scale: float
    order: IntArray
    first: IntArray
    columns: IntArray
    blocks: Panel
    inverses: Panel
    loops: Loops

    @property
    def n_nodes(self) -> int:
        return len(self.first) - 1

    def ordered(self, B: Array, width: int) -> Panel:
        """The rows of B (n_u, k) in the order of the nodes (3 n_nodes, width), else zeros."""
        real = self.order < self.n_u
        found = np.zeros((len(self.order), width), dtype=np.float32)
        found[real, : B.shape[1]] = B[self.order[real]]
        return found

    def panels(self, B: Array) -> list[Panel]:
        """The columns of B (n_u, k) in panels, zeros behind the last."""
        starts = range(0, B.shape[1], PANEL_WIDTH)
        parts = (B[:, start : start + PANEL_WIDTH] for start in starts)
        return [self.ordered(part, PANEL_WIDTH).reshape(-1, 3, PANEL_WIDTH) for part in parts]

    def vectors(self, panels: list[Panel], k: int) -> Array:
        """The columns (n_u, k) of panels."""
        X = np.empty((3 * self.n_nodes, k))
        for number, panel in enumerate(panels):
            part = X[:, PANEL_WIDTH * number : PANEL_WIDTH * (number + 1)]
            part[self.order] = panel.reshape(-1, PANEL_WIDTH)[:, : part.shape[1]]
        return X[: self.n_u]


class PanelSystem:
    """A `System` of panels, for S / scale. cycle(R, Z): Z = T R by multigrid, if there is one; else
    T are the inverse blocks on the diagonal.
    """

    def __init__(self, S: Blocks, cycle: Callable[[Panel, Panel], None] | None = None) -> None:
        self._S, self._cycle, self._run, self._sum = S, cycle, S.loops.run, S.loops.sum
        self._Y, self._Z = np.empty((2, S.n_nodes, 3, PANEL_WIDTH), dtype=np.float32)

    def multiply(self, P: Panel) -> tuple[Panel, Array]:
        S, Y = self._S, self._Y
        return Y, self._sum("multiply", S.n_nodes, S.first, S.columns, S.blocks, P, Y)

    def precondition(self, R: Panel) -> tuple[Panel, Array]:
        S, Z = self._S, self._Z
        if self._cycle is None:
            return Z, self._sum("diagonal", S.n_nodes, S.inverses, R, Z)
        self._cycle(R, Z)
        return Z, self._sum("dots", S.n_nodes, R, Z)

    def advance(self, alpha: Array, P: Panel, Y: Panel, X: Panel, R: Panel) -> None:
        self._run("advance", self._S.n_nodes, alpha.astype(np.float32), P, Y, X, R)

    def turn(self, beta: Array, Z: Panel, P: Panel) -> None:
        self._run("turn", self._S.n_nodes, beta.astype(np.float32), Z, P)


def in_blocks(K: Any, M: Any, shift: float) -> Blocks:
    """K + shift M, symmetric and sparse, in blocks; never whole in double precision."""
    n_u = K.shape[0]
    scale = float(np.mean(K.diagonal() + shift * M.diagonal()))
    # A symmetric matrix by columns is the same by rows.
    K, M = (_filled(matrix.tocsc().T) for matrix in (K, M))
    nodes = reverse_cuthill_mckee(K[::3, ::3], symmetric_mode=True).astype(np.int64)
    order = (3 * nodes[:, None] + np.arange(3)).ravel()
    place = np.empty(len(nodes), dtype=np.int64)
    place[nodes] = np.arange(len(nodes))
    parts = []
    for start in range(0, len(nodes), NODES_AT_ONCE):
        part = order[3 * start : 3 * (start + NODES_AT_ONCE)]
        parts.append(_blocks((K[part] + shift * M[part]) / scale, place))
    counts, columns, blocks = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    first = np.concatenate([[0], np.cumsum(counts)])
    inverses = diagonal_inverses(first, columns, blocks)
    return Blocks(n_u, scale, order, first, columns, blocks, inverses, Loops())


def diagonal_inverses(first: IntArray, columns: IntArray, blocks: Panel) -> Panel:
    """The inverses (n_nodes, 9) of the blocks on the diagonal."""
    rows = np.repeat(np.arange(len(first) - 1, dtype=np.int32), np.diff(first))
    diagonal = blocks[rows == columns].reshape(-1, 3, 3).astype(np.float64)
    return np.linalg.inv(diagonal).reshape(-1, 9).astype(np.float32)


def _blocks(rows: Any, place: IntArray) -> tuple[IntArray, IntArray, Panel]:
    """Counts (n,), columns and blocks (m, 9) of the rows of n nodes, (3 n, n_u)."""
    found = rows.tobsr((3, 3))
    columns = place[found.indices].astype(np.int32)
    return np.diff(found.indptr), columns, found.data.reshape(-1, 9).astype(np.float32)


def _filled(matrix: Any) -> Any:
    """A matrix with rows and columns of the identity behind it, to a multiple of three."""
    missing = -matrix.shape[0] % 3
    if not missing:
        return matrix
    return sp.block_diag([matrix, sp.eye_array(missing)], format="csr")
