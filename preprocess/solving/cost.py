"""Time and memory of a build from sizes alone: formulas fitted to measurements."""

from dataclasses import dataclass

from ..threads import threads

FACTOR_RATE = 28e9
"""Operations of a factorization per second and thread."""
ANALYSIS_RATE = 7e6
"""Entries of a matrix whose order of elimination is found per second."""
SOLVE_RATE = 12e9
"""Operations of a solve with many right-hand sides per second; one thread does them."""
PRODUCT_RATE = 5e9
"""Operations that make vectors orthogonal per second, with the estimates of the error in between.
"""
ASSEMBLY_RATE = 5e6
"""Entries of K and M that are assembled per second."""
ENTRY = 12
"""Bytes of an entry of a sparse matrix, with its row."""
REAL = 8
"""Bytes of a number."""
BLOCKS = 20
"""Krylov blocks to expect: 16 to 23 were taken by parts with 12 to 144 interface dofs, with the
defaults.
"""
WORK = 8
"""Blocks that a new one needs memory for beside the basis."""


@dataclass(frozen=True)
class Cost:
    """Seconds on the machine of the fit (cores of 3 GHz with AVX2), and bytes at the peak."""

    seconds: float
    bytes: float


def factorization_cost(n_u: int, nnz: int) -> Cost:
    """The cost of a sparse L D L^T of n_u unknowns in a cube, with nnz entries in the matrix.

    After nested dissection:

        nnz(L) = 22 n_u^(4/3),   flops = 32 n_u^2,   bytes = 10 nnz(L) + 21 nnz + 1200 n_u

    Fitted to what rslab 1.7 plans for cubes of all solid elements, of 8000 to 273 000 unknowns:
    bytes come out between 0.9 and 1.35 times the plan. Slender and flat bodies take less: a bar of
    4:1 three quarters of the bytes and half the operations, a plate of 50 x 50 x 3 elements half
    the bytes and a fifth of the operations.
    """
    seconds = 32.0 * n_u**2 / (FACTOR_RATE * threads()) + nnz / ANALYSIS_RATE
    return Cost(seconds, 10.0 * _entries(n_u) + 21.0 * nnz + 1200.0 * n_u)


def basis_bytes(n_u: int, n_c: int, blocks: int = BLOCKS) -> float:
    """Bytes of a growing basis: six rigid modes and `blocks` blocks of n_c vectors (n_u,)."""
    return float(REAL * n_u * (6 + n_c * (blocks + WORK)))


def krylov_cost(n_u: int, nnz: int, n_c: int, steps: int, blocks: int = BLOCKS) -> Cost:
    """The cost of a build with n_c interface dofs, `steps` steps and `blocks` blocks of Krylov
    vectors.

    Bytes are those of K, M and K + s M, the factor, the basis and the kernels; seconds those of
    assembly, factorization, 4 nnz(L) operations for each vector that is solved for, and 4 n_u r^2
    for r vectors made orthogonal. Bars of 107 000 and 285 000 unknowns took within a fifth of that
    after the factorization.
    """
    vectors = 6 + n_c * blocks
    factorization = factorization_cost(n_u, nnz)
    solves = 4.0 * _entries(n_u) * n_c * blocks / SOLVE_RATE
    products = 4.0 * n_u * vectors**2 / PRODUCT_RATE
    matrices = 3.0 * ENTRY * nnz
    kernels = 4.0 * REAL * n_c**2 * steps
    return Cost(
        nnz / ASSEMBLY_RATE + factorization.seconds + solves + products,
        matrices + factorization.bytes + basis_bytes(n_u, n_c, blocks) + kernels,
    )


def _entries(n_u: int) -> float:
    entries: float = 22.0 * n_u ** (4.0 / 3.0)
    return entries
