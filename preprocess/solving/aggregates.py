"""Levels of multigrid for panels, by PyAMG's smoothed aggregation."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.linalg import cho_solve

from ...superelement.validation import Array
from ..mesh.mesh import IntArray
from .loops import PANEL_WIDTH, Loops, Panel
from .multigrid import Multigrid, chebyshev_weights, coarsest_factor, largest_eigenvalue
from .panels import Blocks, PanelSystem, diagonal_inverses

MAX_COARSEST_NODES = 600
"""Nodes, or aggregates of six unknowns, of a level that is solved by a dense factor."""


@dataclass(frozen=True, eq=False)
class BlockTable:
    """A sparse matrix by rows of blocks of 3 by 3: first, columns, blocks as in `Blocks`."""

    first: IntArray
    columns: IntArray
    blocks: Panel

    @property
    def rows(self) -> int:
        return len(self.first) - 1

    def add_product(self, X: Panel, Y: Panel, loops: Loops) -> None:
        """Y += A X."""
        loops.run("gather", self.rows, self.first, self.columns, self.blocks, X, Y)


@dataclass(frozen=True, eq=False)
class PanelLevel:
    """A `Level` whose D is the blocks on the diagonal of S. transposed: P^T."""

    S: Blocks
    weights: tuple[float, ...]
    prolongation: BlockTable
    transposed: BlockTable

    def residual(self, R: Panel, Z: Panel, T: Panel) -> None:
        S = self.S
        S.loops.run("subtract", S.n_nodes, S.first, S.columns, S.blocks, Z, R, T)

    def relax(self, weight: float, R: Panel, Z: Panel) -> None:
        self.S.loops.run("relax", self.S.n_nodes, np.float32(weight), self.S.inverses, R, Z)

    def restrict(self, T: Panel) -> Panel:
        coarse = np.zeros((self.transposed.rows, 3, PANEL_WIDTH), dtype=np.float32)
        self.transposed.add_product(T, coarse, self.S.loops)
        return coarse

    def prolong(self, correction: Panel, Z: Panel) -> None:
        self.prolongation.add_product(correction, Z, self.S.loops)


def panel_multigrid(S: Blocks, U: Array) -> Multigrid[Panel]:
    """Multigrid for S (n_u, n_u) in blocks.

    The aggregates and their prolongation, which hold the rigid motions U (n_u, 6) of every
    aggregate, are PyAMG's. `LinAlgError` where a level is singular.
    """
    import pyamg

    A = sp.bsr_matrix((S.blocks.reshape(-1, 3, 3), S.columns, S.first))
    A.sort_indices()
    with _same_random_numbers():
        hierarchy = pyamg.smoothed_aggregation_solver(
            A,
            B=S.ordered(U, U.shape[1]),
            symmetry="symmetric",
            strength=("symmetric", {"theta": 0.0}),
            improve_candidates=None,
            presmoother=None,
            postsmoother=None,
            coarse_solver=None,
            max_coarse=MAX_COARSEST_NODES,
        )
    levels = []
    for number, level in enumerate(hierarchy.levels[:-1]):
        blocks = S if number == 0 else _blocks(level.A, S.loops)
        weights = chebyshev_weights(largest_block_eigenvalue(blocks))
        levels.append(PanelLevel(blocks, weights, _table(level.P), _table(level.P.T)))
    factor = coarsest_factor(hierarchy.levels[-1].A.toarray().astype(np.float64))
    return Multigrid(levels, partial(_solve_coarsest, factor))


def largest_block_eigenvalue(S: Blocks) -> float:
    """That of D^-1 S with D the blocks on the diagonal of S, with a margin."""
    rng = np.random.default_rng(0)
    R = rng.standard_normal((S.n_nodes, 3, PANEL_WIDTH), dtype=np.float32)
    return largest_eigenvalue(PanelSystem(S), R)


def _solve_coarsest(factor: Any, R: Panel, Z: Panel) -> None:
    Z[:] = cho_solve(factor, R.reshape(-1, PANEL_WIDTH)).reshape(Z.shape)


@contextmanager
def _same_random_numbers() -> Iterator[None]:
    """For PyAMG, which draws from those that numpy has for all; they go on as if it had not."""
    before = np.random.get_state()  # noqa: NPY002
    np.random.seed(0)  # noqa: NPY002
    try:
        yield
    finally:
        np.random.set_state(before)  # noqa: NPY002


def _table(matrix: Any) -> BlockTable:
    found = matrix.tocsr().tobsr((3, 3))
    blocks = np.ascontiguousarray(found.data.reshape(-1, 9), dtype=np.float32)
    return BlockTable(found.indptr.astype(np.int64), found.indices.astype(np.int32), blocks)


def _blocks(matrix: Any, loops: Loops) -> Blocks:
    table = _table(matrix)
    inverses = diagonal_inverses(table.first, table.columns, table.blocks)
    order = np.arange(3 * table.rows)
    return Blocks(len(order), 1.0, order, table.first, table.columns, table.blocks, inverses, loops)
