"""Many vectors at once, and the products of K + s M with them, in 3 by 3 blocks and single precision.

The unknowns are taken three by three, a node each, and vectors sixteen by sixteen: a *panel* X
(n_nodes, 3, 16) holds sixteen of them side by side, so that a block of the matrix, once it is read,
serves all of them in vector registers.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import reverse_cuthill_mckee

from ...superelement.validation import Array
from ..mesh.mesh import IntArray
from ..threads import threads

WIDTH = 16
"""vectors of a panel: of single precision, a register of AVX-512 or two of AVX2"""
PIECES = 4
"""pieces of work for each thread, which need not be equal"""
ROWS = 2**13
"""nodes whose rows are put into blocks at once"""
Panel = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Blocks:
    """S = K + s M (n_u, n_u) in blocks of 3 by 3, of single precision, all of them: both halves.

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

    @property
    def n_nodes(self) -> int:
        return len(self.first) - 1

    @property
    def bytes(self) -> int:
        return self.blocks.nbytes + self.columns.nbytes + self.inverses.nbytes

    def panels(self, B: Array) -> list[Panel]:
        """The columns of B (n_u, k) in panels, zeros behind the last."""
        found = []
        for start in range(0, B.shape[1], WIDTH):
            part = B[:, start : start + WIDTH]
            panel = np.zeros((3 * self.n_nodes, WIDTH), dtype=np.float32)
            real = self.order < self.n_u
            panel[real, : part.shape[1]] = part[self.order[real]]
            found.append(panel.reshape(-1, 3, WIDTH))
        return found

    def vectors(self, panels: list[Panel], k: int) -> Array:
        """The columns (n_u, k) of panels."""
        X = np.empty((3 * self.n_nodes, k))
        for number, panel in enumerate(panels):
            part = X[:, WIDTH * number : WIDTH * (number + 1)]
            part[self.order] = panel.reshape(-1, WIDTH)[:, : part.shape[1]]
        return X[: self.n_u]


def in_blocks(K: Any, M: Any, shift: float) -> Blocks:
    """K + shift M, symmetric and sparse, in blocks; never whole in double precision."""
    n_u = K.shape[0]
    scale = float(np.mean(K.diagonal() + shift * M.diagonal()))
    # A symmetric matrix by columns is the same by rows.
    K, M = (_filled(matrix.tocsc().T) for matrix in (K, M))
    nodes = reverse_cuthill_mckee(K[::3, ::3], symmetric_mode=True).astype(np.int64)
    order = (3 * nodes[:, None] + np.arange(3)).ravel()
    place = np.empty(len(nodes), dtype=np.int32)
    place[nodes] = np.arange(len(nodes))
    parts = []
    for start in range(0, len(nodes), ROWS):
        part = order[3 * start : 3 * (start + ROWS)]
        parts.append(_blocks((K[part] + shift * M[part]) / scale, place))
    counts, columns, blocks = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    rows = np.repeat(np.arange(len(nodes), dtype=np.int32), counts)
    diagonal = blocks[rows == columns].reshape(-1, 3, 3).astype(np.float64)
    inverses = np.linalg.inv(diagonal).reshape(-1, 9).astype(np.float32)
    first = np.concatenate([[0], np.cumsum(counts)])
    return Blocks(n_u, scale, order, first, columns, blocks, inverses)


def _blocks(rows: Any, place: IntArray) -> tuple[IntArray, IntArray, Panel]:
    """Counts (n,), columns and blocks (m, 9) of the rows of n nodes, (3 n, n_u)."""
    found = rows.tobsr((3, 3))
    columns = place[found.indices]
    return np.diff(found.indptr), columns, found.data.reshape(-1, 9).astype(np.float32)


def _filled(matrix: Any) -> Any:
    """A matrix with rows and columns of the identity behind it, to a multiple of three."""
    missing = -matrix.shape[0] % 3
    if not missing:
        return matrix
    return sp.block_diag([matrix, sp.eye_array(missing)], format="csr")


@dataclass(frozen=True)
class Kernels:
    """Compiled loops over some of the nodes; sums over vectors are in double precision.

    multiply(first, columns, blocks, P, Y, dots, a, b): Y = S P, and dots += P . Y.
    step(alpha, P, Y, X, R, inverses, dots, a, b): X += alpha P, R -= alpha Y, dots += R . D^-1 R.
    turn(beta, R, inverses, P, a, b): P = D^-1 R + beta P.
    """

    multiply: Callable[..., None]
    step: Callable[..., None]
    turn: Callable[..., None]


@cache
def kernels() -> Kernels:
    """The loops, compiled when they are first needed, in some three seconds."""
    import numba

    compiled = numba.njit(nogil=True, fastmath=True, boundscheck=False)

    @compiled
    def multiply(first, columns, blocks, P, Y, dots, start, stop):  # type: ignore[no-untyped-def]
        y = np.zeros((3, WIDTH), dtype=np.float32)
        for i in range(start, stop):
            y[:] = 0.0
            for p in range(first[i], first[i + 1]):
                j, a = columns[p], blocks[p]
                a0, a1, a2, a3, a4, a5, a6, a7, a8 = (
                    a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8],
                )
                for c in range(WIDTH):
                    x0, x1, x2 = P[j, 0, c], P[j, 1, c], P[j, 2, c]
                    y[0, c] += a0 * x0 + a1 * x1 + a2 * x2
                    y[1, c] += a3 * x0 + a4 * x1 + a5 * x2
                    y[2, c] += a6 * x0 + a7 * x1 + a8 * x2
            for r in range(3):
                for c in range(WIDTH):
                    Y[i, r, c] = y[r, c]
                    dots[c] += np.float64(y[r, c]) * np.float64(P[i, r, c])

    @compiled
    def step(alpha, P, Y, X, R, inverses, dots, start, stop):  # type: ignore[no-untyped-def]
        for i in range(start, stop):
            d = inverses[i]
            for c in range(WIDTH):
                for r in range(3):
                    X[i, r, c] += alpha[c] * P[i, r, c]
                    R[i, r, c] -= alpha[c] * Y[i, r, c]
                r0, r1, r2 = R[i, 0, c], R[i, 1, c], R[i, 2, c]
                z0 = d[0] * r0 + d[1] * r1 + d[2] * r2
                z1 = d[3] * r0 + d[4] * r1 + d[5] * r2
                z2 = d[6] * r0 + d[7] * r1 + d[8] * r2
                dots[c] += np.float64(r0 * z0 + r1 * z1 + r2 * z2)

    @compiled
    def turn(beta, R, inverses, P, start, stop):  # type: ignore[no-untyped-def]
        for i in range(start, stop):
            d = inverses[i]
            for c in range(WIDTH):
                r0, r1, r2 = R[i, 0, c], R[i, 1, c], R[i, 2, c]
                P[i, 0, c] = d[0] * r0 + d[1] * r1 + d[2] * r2 + beta[c] * P[i, 0, c]
                P[i, 1, c] = d[3] * r0 + d[4] * r1 + d[5] * r2 + beta[c] * P[i, 1, c]
                P[i, 2, c] = d[6] * r0 + d[7] * r1 + d[8] * r2 + beta[c] * P[i, 2, c]

    return Kernels(multiply, step, turn)
