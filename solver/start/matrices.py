"""Matrices of the start: dense for small models, sparse for large ones, behind the same operators.

Small models are started by numpy alone: to load scipy would take longer than all of their start.
"""

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

import numpy as np

from ..arrays import Array, Index
from ..step.system import System

Matrix: TypeAlias = Any
"""an array (n, m), or scipy's csr_array"""
# Below, dense matrices cost less than loading scipy.
MAX_DENSE_UNKNOWNS = 240
# Rounding leaves pivots of dependent rows far below, some 1e-16; pivots are squares of distances.
MIN_CLEAR_PIVOT = 1e-10


def is_small(system: System) -> bool:
    return 6 * len(system.bodies.mass) + len(system.elastic.active) <= MAX_DENSE_UNKNOWNS


def from_entries(
    entries: Array, rows: Index, columns: Index, shape: tuple[int, int], small: bool
) -> Matrix:
    """A matrix of entries that may repeat: they add up."""
    if small:
        dense = np.zeros(shape)
        np.add.at(dense, (rows, columns), entries)
        return dense
    from scipy.sparse import coo_array

    return coo_array((entries, (rows, columns)), shape=shape).tocsr()


def block_diagonal(blocks: Sequence[Array], small: bool) -> Matrix:
    """Square blocks along the diagonal; none: (0, 0)."""
    if small:
        sizes = [len(block) for block in blocks]
        dense = np.zeros((sum(sizes), sum(sizes)))
        first = 0
        for block, n in zip(blocks, sizes, strict=True):
            dense[first : first + n, first : first + n] = block
            first += n
        return dense
    from scipy.sparse import block_diag, csr_array

    return csr_array(block_diag([np.zeros((0, 0)), *blocks]))


def beside(left: Matrix, right: Matrix) -> Matrix:
    """[left, right]"""
    if isinstance(left, np.ndarray):
        return np.hstack([left, right])
    from scipy.sparse import csr_array, hstack

    return csr_array(hstack([left, right]))


def above(top: Matrix, bottom: Matrix) -> Matrix:
    """[top; bottom]"""
    if isinstance(top, np.ndarray):
        return np.vstack([top, bottom])
    from scipy.sparse import csr_array, vstack

    return csr_array(vstack([top, bottom]))


def dense_of(matrix: Matrix) -> Array:
    dense: Array = matrix if isinstance(matrix, np.ndarray) else matrix.toarray()
    return dense


def solve(matrix: Matrix, right: Array) -> Array:
    """matrix^-1 right for a regular matrix."""
    if isinstance(matrix, np.ndarray):
        return np.linalg.solve(matrix, right).astype(np.float64, copy=False)
    from scipy.sparse.linalg import splu

    solution: Array = splu(matrix.tocsc()).solve(right)
    return solution


def unit_rows(J: Matrix) -> tuple[Matrix, Array]:
    """The rows scaled to unit length, and their scales; rows of zeros stay."""
    squares = J * J if isinstance(J, np.ndarray) else J.multiply(J)
    length = np.sqrt(np.asarray(squares.sum(axis=1)))
    scale = 1.0 / np.where(length > 0.0, length, 1.0)
    return scale[:, None] * J, scale


def factorize_square(J: Matrix) -> Callable[[Array], Array] | None:
    """A function that solves J J^T x = b; None unless the rows of J are clearly independent.

    J: one or more rows of unit length. A pivot of the elimination is the square of the
    distance of a row from the space of those before it.
    """
    if isinstance(J, np.ndarray):
        square = J @ J.T
        try:
            pivots = np.diagonal(np.linalg.cholesky(square)) ** 2
        except np.linalg.LinAlgError:
            return None
        return (lambda b: np.linalg.solve(square, b)) if pivots.min() > MIN_CLEAR_PIVOT else None
    from scipy.sparse.linalg import splu

    options = {"SymmetricMode": True}
    try:
        # Symmetric and definite: pivots on the diagonal, ordered by a minimum degree of A^T + A.
        factors = splu((J @ J.T).tocsc(), "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
    except RuntimeError:  # exactly singular
        return None
    solver: Callable[[Array], Array] = factors.solve
    return solver if float(factors.U.diagonal().min()) > MIN_CLEAR_PIVOT else None
