"""Gaussian elimination of a matrix of blocks with a fixed pattern (pattern.py), in place and without allocation.

    P_k D_k = L_k U_k,   then for all later nodes i, j beside k:   A_ij <- A_ij - (A_ik U_k^-1) (L_k^-1 P_k A_kj)

with row exchanges P_k inside diagonal blocks alone. The factors replace the matrix: of D_k its L_k below and U_k above
the diagonal (which holds reciprocals), right of it L_k^-1 P_k A_kj, below it A_ik U_k^-1.
"""

from .compiled import Array, Index, compiled
from .system import Pattern


@compiled
def factorise(pattern: Pattern, S: Array, pivots: Index) -> bool:
    """Replace S by its factors; `pivots`: with which row of its block each row was exchanged. False if singular."""
    for k in range(len(pattern.size)):
        if not _factorise_rows(pattern, k, S, pivots):
            return False
        _eliminate_below(pattern, k, S)
    return True


@compiled
def substitute(pattern: Pattern, S: Array, pivots: Index, x: Array) -> None:
    """x <- S^-1 x from the factors in S."""
    for k in range(len(pattern.size)):
        _go_forward(pattern, k, S, pivots, x)
    for k in range(len(pattern.size) - 1, -1, -1):
        _go_back(pattern, k, S, x)


@compiled
def _factorise_rows(pattern: Pattern, k: int, S: Array, pivots: Index) -> bool:
    """Of the diagonal block and those to its right."""
    n, width, start, first = pattern.size[k], pattern.width[k], pattern.row[k], pattern.first[k]
    for p in range(n):
        pivot, largest = p, abs(S[start + p * width + p])
        for i in range(p + 1, n):
            if abs(S[start + i * width + p]) > largest:
                pivot, largest = i, abs(S[start + i * width + p])
        if not largest > 0.0:
            return False
        pivots[first + p] = pivot
        own = start + p * width
        if pivot != p:
            other = start + pivot * width
            for j in range(width):
                S[own + j], S[other + j] = S[other + j], S[own + j]
        S[own + p] = 1.0 / S[own + p]
        for i in range(p + 1, n):
            row = start + i * width
            factor = S[row + p] * S[own + p]
            S[row + p] = factor
            if factor != 0.0:
                for j in range(p + 1, width):
                    S[row + j] -= factor * S[own + j]
    return True


@compiled
def _eliminate_below(pattern: Pattern, k: int, S: Array) -> None:
    n, width, start, row = pattern.size[k], pattern.width[k], pattern.row[k], pattern.lower[k]
    segment = pattern.segment
    for a in range(pattern.later_range[k], pattern.later_range[k + 1]):
        for i in range(pattern.size[pattern.later[a]]):
            for p in range(n):
                own = start + p * width
                factor = S[row + p] * S[own + p]
                S[row + p] = factor
                if factor != 0.0:
                    for j in range(p + 1, n):
                        S[row + j] -= factor * S[own + j]
            for s in range(pattern.segment_range[a], pattern.segment_range[a + 1]):
                target = segment[s, 0] + i * segment[s, 1]
                length = segment[s, 3]
                for p in range(n):
                    factor = S[row + p]
                    if factor != 0.0:
                        source = start + p * width + segment[s, 2]
                        for j in range(length):
                            S[target + j] -= factor * S[source + j]
            row += n


@compiled
def _go_forward(pattern: Pattern, k: int, S: Array, pivots: Index, x: Array) -> None:
    n, width, start, first = pattern.size[k], pattern.width[k], pattern.row[k], pattern.first[k]
    for p in range(n):
        pivot = first + pivots[first + p]
        x[first + p], x[pivot] = x[pivot], x[first + p]
    for p in range(1, n):
        total = 0.0
        for j in range(p):
            total += S[start + p * width + j] * x[first + j]
        x[first + p] -= total
    row = pattern.lower[k]
    for a in range(pattern.later_range[k], pattern.later_range[k + 1]):
        i = pattern.later[a]
        for z in range(pattern.first[i], pattern.first[i + 1]):
            total = 0.0
            for j in range(n):
                total += S[row + j] * x[first + j]
            x[z] -= total
            row += n


@compiled
def _go_back(pattern: Pattern, k: int, S: Array, x: Array) -> None:
    n, width, start, first = pattern.size[k], pattern.width[k], pattern.row[k], pattern.first[k]
    for p in range(n - 1, -1, -1):
        own = start + p * width
        total = x[first + p]
        for j in range(p + 1, n):
            total -= S[own + j] * x[first + j]
        column = own + n
        for a in range(pattern.later_range[k], pattern.later_range[k + 1]):
            i = pattern.later[a]
            later = pattern.first[i]
            for j in range(pattern.size[i]):
                total -= S[column + j] * x[later + j]
            column += pattern.size[i]
        x[first + p] = total * S[own + p]
