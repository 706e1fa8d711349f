"""LU factors of a dense matrix that is not symmetric, with exchanges of rows, in panels of columns.

P A = L U, L with a unit diagonal, both in place of A. All that a panel changes to its right is done
at once: rank-one updates alone would read the whole matrix for each column.
"""

from ..arrays import Array, Index
from ..compiler.marks import compiled
from .vectors import inner

PANEL_COLUMNS = 16
"""columns of a panel, a multiple of four"""


@compiled
def factorize_lu(count: int, A: Array, pivots: Index) -> bool:
    """Factors of the first `count` rows and columns of A; False where it is singular.

    pivots (count,): the row that each was exchanged with.
    """
    for first in range(0, count, PANEL_COLUMNS):
        last = min(first + PANEL_COLUMNS, count)
        if not _factorize_panel(first, last, count, A, pivots):
            return False
        # Rows of U beside the panel, and then all that is left: in panels it stays in the cache.
        for a in range(first + 1, last):
            for p in range(first, a):
                if A[a, p] != 0.0:
                    factor = A[a, p]
                    for k in range(last, count):
                        A[a, k] -= factor * A[p, k]
        for b in range(last, count):
            for p in range(first, last - 3, 4):
                f, g, u, v = A[b, p], A[b, p + 1], A[b, p + 2], A[b, p + 3]
                for k in range(last, count):
                    A[b, k] -= f * A[p, k] + g * A[p + 1, k] + u * A[p + 2, k] + v * A[p + 3, k]
    return True


@compiled
def _factorize_panel(first: int, last: int, count: int, A: Array, pivots: Index) -> bool:
    """LU factors of the columns from first to last; False where they are singular."""
    for a in range(first, last):
        # Without exchanges pivots may vanish, for the matrix need not be definite.
        best = a
        for b in range(a + 1, count):
            if abs(A[b, a]) > abs(A[best, a]):
                best = b
        pivots[a] = best
        if not abs(A[best, a]) > 0.0:
            return False
        if best != a:
            for b in range(count):
                A[a, b], A[best, b] = A[best, b], A[a, b]
        for b in range(a + 1, count):
            if A[b, a] != 0.0:
                A[b, a] /= A[a, a]
                factor = A[b, a]
                for k in range(a + 1, last):
                    A[b, k] -= factor * A[a, k]
    return True


@compiled
def substitute_lu(count: int, A: Array, pivots: Index, x: Array) -> None:
    """x <- A^-1 x"""
    for a in range(count):
        x[a], x[pivots[a]] = x[pivots[a]], x[a]
    for a in range(count):
        x[a] -= inner(A[a, :a], x[:a])
    for a in range(count - 1, -1, -1):
        x[a] = (x[a] - inner(A[a, a + 1 : count], x[a + 1 : count])) / A[a, a]
