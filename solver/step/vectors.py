"""Three-vectors as tuples, which the compiler keeps in registers."""

from ..arrays import Array
from ..compiler.marks import compiled

Vector = tuple[float, float, float]

ZERO_VECTOR = (0.0, 0.0, 0.0)
UNIT_AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@compiled
def row(A: Array, i: int) -> Vector:
    return A[i, 0], A[i, 1], A[i, 2]


@compiled
def triple(a: Array, k: int) -> Vector:
    return a[k], a[k + 1], a[k + 2]


@compiled
def multiply(M: Array, a: Vector) -> Vector:
    return (
        M[0, 0] * a[0] + M[0, 1] * a[1] + M[0, 2] * a[2],
        M[1, 0] * a[0] + M[1, 1] * a[1] + M[1, 2] * a[2],
        M[2, 0] * a[0] + M[2, 1] * a[1] + M[2, 2] * a[2],
    )


@compiled
def add_to_row(A: Array, i: int, first: int, a: Vector) -> None:
    """A[i, first : first + 3] += a"""
    A[i, first] += a[0]
    A[i, first + 1] += a[1]
    A[i, first + 2] += a[2]


@compiled
def add(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@compiled
def subtract(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@compiled
def scale(s: float, a: Vector) -> Vector:
    return s * a[0], s * a[1], s * a[2]


@compiled
def dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled
def magnitude(a: Vector) -> float:
    """The sum of the absolute components."""
    return abs(a[0]) + abs(a[1]) + abs(a[2])


@compiled
def cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@compiled
def rotate(R: Array, i: int, a: Vector) -> Vector:
    """R[i] a"""
    return (
        R[i, 0, 0] * a[0] + R[i, 0, 1] * a[1] + R[i, 0, 2] * a[2],
        R[i, 1, 0] * a[0] + R[i, 1, 1] * a[1] + R[i, 1, 2] * a[2],
        R[i, 2, 0] * a[0] + R[i, 2, 1] * a[1] + R[i, 2, 2] * a[2],
    )


@compiled
def rotate_back(R: Array, i: int, a: Vector) -> Vector:
    """R[i]^T a"""
    return (
        R[i, 0, 0] * a[0] + R[i, 1, 0] * a[1] + R[i, 2, 0] * a[2],
        R[i, 0, 1] * a[0] + R[i, 1, 1] * a[1] + R[i, 2, 1] * a[2],
        R[i, 0, 2] * a[0] + R[i, 1, 2] * a[1] + R[i, 2, 2] * a[2],
    )


@compiled
def inner(a: Array, b: Array) -> float:
    """a . b of arrays of any length."""
    total = 0.0
    for j in range(len(a)):
        total += a[j] * b[j]
    return total
