"""Algebraic multigrid by smoothed aggregation, as a preconditioner of panels."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.linalg import cho_factor, cho_solve, eigvalsh_tridiagonal

from ...superelement.validation import Array
from ..mesh.mesh import IntArray
from ..processes import ALONE, Processes
from .loops import WIDTH, Loops, Panel
from .panels import Blocks, diagonal_inverses

COARSEST = 600
"""Nodes, or aggregates of six unknowns, of a level that is solved by a dense factor, at most."""
SWEEPS = 2
"""Sweeps of the smoother before and after the correction of a coarser level."""
SMOOTHED = 16.0
"""Part of the spectrum that the smoother is to damp: from its end to that end divided by this."""
LANCZOS = 16
"""Steps by which the largest eigenvalue is found, for sixteen random vectors at once."""
MARGIN = 1.05
"""What they may have missed of it: cycles bear a little more, then they are not positive."""


@dataclass(frozen=True, eq=False)
class Table:
    """A sparse matrix by rows of blocks of 3 by 3: first, columns, blocks as in `Blocks`."""

    first: IntArray
    columns: IntArray
    blocks: Panel

    @property
    def rows(self) -> int:
        return len(self.first) - 1


@dataclass(frozen=True, eq=False)
class Level:
    """A level: its matrix, the weights of its smoother, and the way to the next coarser one.

    prolong (n, n_coarse): P, of which restrict is the transpose.
    """

    S: Blocks
    weights: tuple[float, ...]
    prolong: Table
    restrict: Table


class Multigrid:
    """Z = T R by one V-cycle, symmetric and positive definite, for S (n_u, n_u) in blocks.

    The aggregates and their prolongation, which hold the rigid motions U (n_u, 6) of every
    aggregate, are PyAMG's; cycles run on panels. A sweep of the smoother is one of Jacobi with the
    blocks on the diagonal, its weights the inverse zeros of Chebyshev's polynomial on the upper
    part of the spectrum. Source: P. Vanek, J. Mandel, M. Brezina, Computing 56 (1996) 179-196;
    M. Adams et al., J. Comput. Phys. 188 (2003) 593-610. `LinAlgError` where a level is singular.
    """

    def __init__(self, S: Blocks, U: Array, loops: Loops) -> None:
        import pyamg

        A = sp.bsr_matrix((S.blocks.reshape(-1, 3, 3), S.columns, S.first))
        A.sort_indices()
        with _same_random_numbers():
            hierarchy = pyamg.smoothed_aggregation_solver(
                A,
                B=S.ordered(U).astype(np.float32),
                symmetry="symmetric",
                strength=("symmetric", {"theta": 0.0}),
                improve_candidates=None,
                presmoother=None,
                postsmoother=None,
                coarse_solver=None,
                max_coarse=COARSEST,
            )
        self._levels = []
        for number, level in enumerate(hierarchy.levels[:-1]):
            blocks = S if number == 0 else _blocks(level.A)
            weights = chebyshev_weights(largest_eigenvalue(blocks, loops))
            self._levels.append(Level(blocks, weights, _table(level.P), _table(level.P.T)))
        self._factor = coarsest_factor(hierarchy.levels[-1].A.toarray().astype(np.float64))

    def __call__(self, R: Panel, Z: Panel, loops: Loops) -> Array:
        self._cycle(0, R, Z, loops)
        return loops.sum("dots", len(R), R, Z)

    def _cycle(self, number: int, R: Panel, Z: Panel, loops: Loops) -> None:
        if number == len(self._levels):
            Z[:] = cho_solve(self._factor, R.reshape(-1, WIDTH)).reshape(Z.shape)
            return
        level = self._levels[number]
        S, n, T = level.S, level.S.n_nodes, np.empty_like(R)
        Z[:] = 0.0
        for sweep, weight in enumerate(level.weights):
            left = R if sweep == 0 else T
            if sweep:
                loops.run("subtract", n, S.first, S.columns, S.blocks, Z, R, T)
            loops.run("relax", n, np.float32(weight), S.inverses, left, Z)
        loops.run("subtract", n, S.first, S.columns, S.blocks, Z, R, T)
        coarse = np.zeros((level.restrict.rows, 3, WIDTH), dtype=np.float32)
        _add_product(level.restrict, T, coarse, loops)
        correction = np.empty_like(coarse)
        self._cycle(number + 1, coarse, correction, loops)
        _add_product(level.prolong, correction, Z, loops)
        for weight in reversed(level.weights):
            loops.run("subtract", n, S.first, S.columns, S.blocks, Z, R, T)
            loops.run("relax", n, np.float32(weight), S.inverses, T, Z)


@contextmanager
def _same_random_numbers() -> Iterator[None]:
    """For PyAMG, which draws from those that numpy has for all; they go on as if it had not."""
    before = np.random.get_state()  # noqa: NPY002
    np.random.seed(0)  # noqa: NPY002
    try:
        yield
    finally:
        np.random.set_state(before)  # noqa: NPY002


def coarsest_factor(S: Array) -> Any:
    """The factor of a dense matrix, symmetric but for rounding; `LinAlgError` if it has none."""
    if not np.isfinite(S).all():
        raise np.linalg.LinAlgError("the coarsest level of multigrid is singular")
    return cho_factor(0.5 * (S + S.T))


def _add_product(table: Table, X: Panel, Y: Panel, loops: Loops) -> None:
    loops.run("gather", table.rows, table.first, table.columns, table.blocks, X, Y)


def chebyshev_weights(largest: float) -> tuple[float, ...]:
    """The inverse zeros of Chebyshev's polynomial on [largest / SMOOTHED, largest]."""
    middle, half = 0.5 * largest * (1.0 + 1.0 / SMOOTHED), 0.5 * largest * (1.0 - 1.0 / SMOOTHED)
    zeros = middle + half * np.cos(np.pi * (np.arange(SWEEPS) + 0.5) / SWEEPS)
    return tuple((1.0 / zeros).tolist())


def largest_eigenvalue(S: Blocks, loops: Loops) -> float:
    """That of D^-1 S, by the numbers of conjugate gradients with D, the blocks on the diagonal."""
    rng = np.random.default_rng(0)
    R = rng.standard_normal((S.n_nodes, 3, WIDTH), dtype=np.float32)
    X, Y, Z = np.zeros_like(R), np.empty_like(R), np.empty_like(R)
    remaining = S.solve_diagonal(R, Z, loops)
    P = Z.copy()
    steps, ratios = [], []
    for _ in range(LANCZOS):
        step = remaining / S.multiply(P, Y, loops)
        loops.run("advance", S.n_nodes, step.astype(np.float32), P, Y, X, R)
        before, remaining = remaining, S.solve_diagonal(R, Z, loops)
        ratio = remaining / before
        loops.run("turn", S.n_nodes, ratio.astype(np.float32), Z, P)
        steps.append(step)
        ratios.append(ratio)
    return MARGIN * largest_of_gradients(np.array(steps), np.array(ratios))


def largest_of_gradients(steps: Array, ratios: Array, processes: Processes = ALONE) -> float:
    """The largest eigenvalue that conjugate gradients have seen, from below.

    alpha and beta of each step, for each of their vectors (n, k). They are Lanczos's method, whose
    matrix is tridiagonal: 1 / alpha_j + beta_(j-1) / alpha_(j-1), and sqrt(beta_j) / alpha_j beside
    it. `LinAlgError` where they did not get so far. Source: Y. Saad, Iterative Methods for Sparse
    Linear Systems (2003), section 6.7.3.
    """
    if not (np.isfinite(steps).all() and (steps > 0.0).all() and np.isfinite(ratios).all()):
        raise np.linalg.LinAlgError("a level of multigrid is not positive definite")
    diagonals = 1.0 / steps
    diagonals[1:] += ratios[:-1] / steps[:-1]
    beside = np.sqrt(ratios[:-1]) / steps[:-1]
    pairs = list(zip(diagonals.T, beside.T, strict=True))
    return processes.agreed(lambda: max(float(eigvalsh_tridiagonal(*pair)[-1]) for pair in pairs))


def _table(matrix: Any) -> Table:
    found = matrix.tocsr().tobsr((3, 3))
    blocks = np.ascontiguousarray(found.data.reshape(-1, 9), dtype=np.float32)
    return Table(found.indptr.astype(np.int64), found.indices.astype(np.int32), blocks)


def _blocks(matrix: Any) -> Blocks:
    table = _table(matrix)
    inverses = diagonal_inverses(table.first, table.columns, table.blocks)
    order = np.arange(3 * table.rows)
    return Blocks(len(order), 1.0, order, table.first, table.columns, table.blocks, inverses)
