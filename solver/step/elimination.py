"""Gaussian elimination of a matrix of blocks with a fixed pattern, in place.

    P_k D_k = L_k U_k,   then for all later nodes i, j beside k:
    A_ij <- A_ij - (A_ik U_k^-1) (L_k^-1 P_k A_kj)

with row exchanges P_k inside diagonal blocks alone. The factors replace the matrix: of D_k its L_k
below and U_k above the diagonal (which holds reciprocals), right of it L_k^-1 P_k A_kj, below it
A_ik U_k^-1.
"""

from ..arrays import Array, Index
from ..compiler.marks import compiled, entry
from .records.matrix import Pattern
from .vectors import inner


@entry
def factorize(pattern: Pattern, S: Array, pivots: Index) -> bool:
    """Replace S by its factors; False if it is singular.

    pivots (n,): the row of its block that each row was exchanged with.
    """
    for k in range(len(pattern.size)):
        if not _factorize_rows(pattern, k, S, pivots):
            return False
        _eliminate_below(pattern, k, S)
    return True


@entry
def substitute(pattern: Pattern, S: Array, pivots: Index, x: Array) -> None:
    """x <- S^-1 x from the factors in S."""
    for k in range(len(pattern.size)):
        _go_forward(pattern, k, S, pivots, x)
    # From the roots back to the leaves: a node depends on later ones alone.
    for k in range(len(pattern.size) - 1, -1, -1):
        _go_back(pattern, k, S, x)


@compiled
def _factorize_rows(pattern: Pattern, k: int, S: Array, pivots: Index) -> bool:
    """Factorize the diagonal block of node k, and apply it to the blocks on its right."""
    n, width, start, first = pattern.size[k], pattern.width[k], pattern.row[k], pattern.first[k]
    for p in range(n):
        pivot, largest = p, abs(S[start + p * width + p])
        for i in range(p + 1, n):
            # Exchanges stay within a block: the pattern of all other blocks is fixed before the
            # run.
            if abs(S[start + i * width + p]) > largest:
                pivot, largest = i, abs(S[start + i * width + p])
        if not largest > 0.0:  # also where it is not a number
            return False
        pivots[first + p] = pivot
        row_p = start + p * width
        if pivot != p:
            other = start + pivot * width
            for j in range(width):
                S[row_p + j], S[other + j] = S[other + j], S[row_p + j]
        # Multiplications by the reciprocal are quicker than divisions, here and in `substitute`.
        S[row_p + p] = 1.0 / S[row_p + p]
        for i in range(p + 1, n):
            row = start + i * width
            factor = S[row + p] * S[row_p + p]
            S[row + p] = factor
            if factor != 0.0:
                _subtract(factor, S[row_p + p + 1 : row_p + width], S[row + p + 1 : row + width])
    return True


@compiled
def _eliminate_below(pattern: Pattern, k: int, S: Array) -> None:
    n, width, start, row = pattern.size[k], pattern.width[k], pattern.row[k], pattern.lower[k]
    segment = pattern.segment
    for a in range(pattern.later_range[k], pattern.later_range[k + 1]):
        for i in range(pattern.size[pattern.later[a]]):
            for p in range(n):
                row_p = start + p * width
                factor = S[row + p] * S[row_p + p]
                S[row + p] = factor
                # Rows of axes that do not interact are zeros; skipping them is cheaper than the
                # product.
                if factor != 0.0:
                    _subtract(factor, S[row_p + p + 1 : row_p + n], S[row + p + 1 : row + n])
            for s in range(pattern.segment_range[a], pattern.segment_range[a + 1]):
                length = segment[s, 3]
                start_of_row = segment[s, 0] + i * segment[s, 1]
                target = S[start_of_row : start_of_row + length]
                for p in range(n):
                    factor = S[row + p]
                    if factor != 0.0:
                        source = start + p * width + segment[s, 2]
                        _subtract(factor, S[source : source + length], target)
            row += n


@compiled
def _go_forward(pattern: Pattern, k: int, S: Array, pivots: Index, x: Array) -> None:
    n, width, start, first = pattern.size[k], pattern.width[k], pattern.row[k], pattern.first[k]
    for p in range(n):
        pivot = first + pivots[first + p]
        x[first + p], x[pivot] = x[pivot], x[first + p]
    for p in range(1, n):
        row_p = start + p * width
        x[first + p] -= inner(S[row_p : row_p + p], x[first : first + p])
    row = pattern.lower[k]
    for a in range(pattern.later_range[k], pattern.later_range[k + 1]):
        i = pattern.later[a]
        for z in range(pattern.first[i], pattern.first[i + 1]):
            x[z] -= inner(S[row : row + n], x[first : first + n])
            row += n


@compiled
def _go_back(pattern: Pattern, k: int, S: Array, x: Array) -> None:
    n, width, start, first = pattern.size[k], pattern.width[k], pattern.row[k], pattern.first[k]
    for p in range(n - 1, -1, -1):
        row_p = start + p * width
        total = x[first + p] - inner(S[row_p + p + 1 : row_p + n], x[first + p + 1 : first + n])
        column = row_p + n
        for a in range(pattern.later_range[k], pattern.later_range[k + 1]):
            i = pattern.later[a]
            total -= inner(
                S[column : column + pattern.size[i]], x[pattern.first[i] : pattern.first[i + 1]]
            )
            column += pattern.size[i]
        x[first + p] = total * S[row_p + p]


@compiled
def _subtract(factor: float, source: Array, target: Array) -> None:
    for j in range(len(target)):
        target[j] -= factor * source[j]
