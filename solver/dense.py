"""Small dense linear systems in place, without allocation."""

from .compiled import Array, compiled


@compiled
def solve_in_place(A: Array, B: Array) -> bool:
    """B <- A^-1 B by Gaussian elimination with partial pivoting; A (n, n) is overwritten. False if A is singular."""
    n, columns = B.shape
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(A[i, k]) > abs(A[pivot, k]):
                pivot = i
        if A[pivot, k] == 0.0:
            return False
        if pivot != k:
            for j in range(k, n):
                A[k, j], A[pivot, j] = A[pivot, j], A[k, j]
            for j in range(columns):
                B[k, j], B[pivot, j] = B[pivot, j], B[k, j]
        inverse = 1.0 / A[k, k]
        for i in range(k + 1, n):
            factor = A[i, k] * inverse
            if factor != 0.0:
                for j in range(k + 1, n):
                    A[i, j] -= factor * A[k, j]
                for j in range(columns):
                    B[i, j] -= factor * B[k, j]
    for k in range(n - 1, -1, -1):
        inverse = 1.0 / A[k, k]
        for j in range(columns):
            B[k, j] *= inverse
        for i in range(k):
            factor = A[i, k]
            if factor != 0.0:
                for j in range(columns):
                    B[i, j] -= factor * B[k, j]
    return True
