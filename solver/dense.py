"""Small dense linear systems in place, without allocation."""

from .compiled import Array, compiled


@compiled
def solve_in_place(A: Array, B: Array) -> bool:
    """B <- A^-1 B by Gaussian elimination with partial pivoting; A (n, n) is overwritten. False if A is singular."""
    n, columns = B.shape
    for k in range(n):
        pivot = k
        largest = abs(A[k, k])
        for i in range(k + 1, n):
            if abs(A[i, k]) > largest:
                pivot, largest = i, abs(A[i, k])
        if largest == 0.0:
            return False
        row, right = A[k, k:], B[k]
        if pivot != k:
            other, other_right = A[pivot, k:], B[pivot]
            for j in range(len(row)):
                row[j], other[j] = other[j], row[j]
            for j in range(len(right)):
                right[j], other_right[j] = other_right[j], right[j]
        inverse = 1.0 / row[0]
        for i in range(k + 1, n):
            factor = A[i, k] * inverse
            if factor != 0.0:
                other, other_right = A[i, k:], B[i]
                for j in range(1, len(row)):
                    other[j] -= factor * row[j]
                for j in range(len(right)):
                    other_right[j] -= factor * right[j]
    for k in range(n - 1, -1, -1):
        inverse = 1.0 / A[k, k]
        right = B[k]
        for j in range(columns):
            right[j] *= inverse
        for i in range(k):
            factor = A[i, k]
            if factor != 0.0:
                other_right = B[i]
                for j in range(columns):
                    other_right[j] -= factor * right[j]
    return True
