"""Compiled loops over the nodes of panels (n_nodes, 3, 16), on all threads.

numba compiles them when they are first needed, in some seconds.
"""

# mypy: allow-untyped-defs
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...superelement.validation import Array
from ..threads import threads

PANEL_WIDTH = 16  # vectors of a panel: of single precision, a register of AVX-512 or two of AVX2
PIECES_PER_THREAD = 4  # of work, for they take unequal times
Panel = NDArray[np.float32]


class Loops:
    """The loops of `compiled_loops`, each of them run in pieces by a pool of threads."""

    def __init__(self) -> None:
        self._compiled, self._pool = compiled_loops(), ThreadPoolExecutor(threads())

    def run(self, name: str, n_nodes: int, *arguments: Any) -> None:
        """All nodes, one after the other or at once."""
        loop = getattr(self._compiled, name)
        list(self._pool.map(lambda piece: loop(*arguments, *piece), _pieces(n_nodes)))

    def sum(self, name: str, n_nodes: int, *arguments: Any) -> Array:
        """The same; what the loop adds up for each vector (16,)."""
        loop, pieces = getattr(self._compiled, name), _pieces(n_nodes)
        sums = np.zeros((len(pieces), PANEL_WIDTH))
        list(self._pool.map(lambda total, piece: loop(*arguments, total, *piece), sums, pieces))
        return np.asarray(sums.sum(axis=0))


def _pieces(n_nodes: int) -> list[tuple[int, int]]:
    edges = np.linspace(0, n_nodes, PIECES_PER_THREAD * threads() + 1).astype(int).tolist()
    return list(pairwise(edges))


@cache
def compiled_loops() -> SimpleNamespace:
    """The loops by name; each takes the first and last node behind its arguments.

    Sums over nodes, `dots` (16,), are in double precision.

    multiply: Y = S P, P . Y, with blocks by rows      subtract: T = R - S X
    gather: Y += P X                                    dots: R . Z
    diagonal: Z = D R, R . Z, a block for every node    relax: X += weight D R
    advance: X += alpha P, R -= alpha Y                 turn: P = Z + beta P
    """
    import numba

    compiled = numba.njit(nogil=True, fastmath=True, boundscheck=False, error_model="numpy")

    @compiled
    def row(first, columns, blocks, X, i, y):
        """y (3, 16) = row i of S X"""
        y[:] = 0.0
        for p in range(first[i], first[i + 1]):
            j, a = columns[p], blocks[p]
            a0, a1, a2 = a[0], a[1], a[2]
            a3, a4, a5 = a[3], a[4], a[5]
            a6, a7, a8 = a[6], a[7], a[8]
            for c in range(PANEL_WIDTH):
                x0, x1, x2 = X[j, 0, c], X[j, 1, c], X[j, 2, c]
                y[0, c] += a0 * x0 + a1 * x1 + a2 * x2
                y[1, c] += a3 * x0 + a4 * x1 + a5 * x2
                y[2, c] += a6 * x0 + a7 * x1 + a8 * x2

    @compiled
    def multiply(first, columns, blocks, P, Y, dots, start, stop):
        y = np.empty((3, PANEL_WIDTH), dtype=np.float32)
        for i in range(start, stop):
            row(first, columns, blocks, P, i, y)
            for r in range(3):
                for c in range(PANEL_WIDTH):
                    Y[i, r, c] = y[r, c]
                    dots[c] += np.float64(y[r, c]) * np.float64(P[i, r, c])

    @compiled
    def subtract(first, columns, blocks, X, R, T, start, stop):
        y = np.empty((3, PANEL_WIDTH), dtype=np.float32)
        for i in range(start, stop):
            row(first, columns, blocks, X, i, y)
            for r in range(3):
                for c in range(PANEL_WIDTH):
                    T[i, r, c] = R[i, r, c] - y[r, c]

    @compiled
    def gather(first, columns, blocks, X, Y, start, stop):
        y = np.empty((3, PANEL_WIDTH), dtype=np.float32)
        for i in range(start, stop):
            row(first, columns, blocks, X, i, y)
            for r in range(3):
                for c in range(PANEL_WIDTH):
                    Y[i, r, c] += y[r, c]

    @compiled
    def diagonal(D, R, Z, dots, start, stop):
        for i in range(start, stop):
            d = D[i]
            for c in range(PANEL_WIDTH):
                r0, r1, r2 = R[i, 0, c], R[i, 1, c], R[i, 2, c]
                z0 = d[0] * r0 + d[1] * r1 + d[2] * r2
                z1 = d[3] * r0 + d[4] * r1 + d[5] * r2
                z2 = d[6] * r0 + d[7] * r1 + d[8] * r2
                Z[i, 0, c], Z[i, 1, c], Z[i, 2, c] = z0, z1, z2
                dots[c] += np.float64(r0 * z0 + r1 * z1 + r2 * z2)

    @compiled
    def relax(weight, D, R, X, start, stop):
        for i in range(start, stop):
            d = D[i]
            for c in range(PANEL_WIDTH):
                r0, r1, r2 = R[i, 0, c], R[i, 1, c], R[i, 2, c]
                X[i, 0, c] += weight * (d[0] * r0 + d[1] * r1 + d[2] * r2)
                X[i, 1, c] += weight * (d[3] * r0 + d[4] * r1 + d[5] * r2)
                X[i, 2, c] += weight * (d[6] * r0 + d[7] * r1 + d[8] * r2)

    @compiled
    def dots(R, Z, dots, start, stop):
        for i in range(start, stop):
            for r in range(3):
                for c in range(PANEL_WIDTH):
                    dots[c] += np.float64(R[i, r, c]) * np.float64(Z[i, r, c])

    @compiled
    def advance(alpha, P, Y, X, R, start, stop):
        for i in range(start, stop):
            for r in range(3):
                for c in range(PANEL_WIDTH):
                    X[i, r, c] += alpha[c] * P[i, r, c]
                    R[i, r, c] -= alpha[c] * Y[i, r, c]

    @compiled
    def turn(beta, Z, P, start, stop):
        for i in range(start, stop):
            for r in range(3):
                for c in range(PANEL_WIDTH):
                    P[i, r, c] = Z[i, r, c] + beta[c] * P[i, r, c]

    return SimpleNamespace(
        multiply=multiply,
        subtract=subtract,
        gather=gather,
        diagonal=diagonal,
        relax=relax,
        dots=dots,
        advance=advance,
        turn=turn,
    )
