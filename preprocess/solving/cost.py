"""Time and memory of a build from sizes alone: formulas fitted to measurements."""

import math
from dataclasses import dataclass

from ..threads import threads

FACTOR_RATE = 28e9  # operations of a factorization per second and thread
ANALYSIS_RATE = 7e6  # entries of a matrix whose order of elimination is found per second
SOLVE_RATE = 12e9
"""Operations of a solve with many right-hand sides per second; one thread does them."""
PRODUCT_RATE = 5e9
"""Operations that make vectors orthogonal per second, with the estimates of the error in between.
"""
ASSEMBLY_RATE = 5e6  # entries of K and M that are assembled per second
BLOCK_RATE = 16e9  # operations of products with panels, in single precision, per second and thread
STREAM_RATE = 10e9  # bytes that loops over panels read and write per second and thread
SETUP_RATE = 3e6  # entries of a matrix that multigrid is made of per second
PANEL_BYTES = 64  # of sixteen vectors of single precision, for an unknown
MAX_PLAIN_STEPS = 90  # of gradients, quicker than fewer ones with multigrid
CYCLES_PER_DIGIT = 3.6
ENTRY_BYTES = 12  # of a sparse matrix, with its row
NUMBER_BYTES = 8
EXPECTED_BLOCKS = 20  # of Krylov vectors: parts with 12 to 144 interface dofs took 16 to 23
VECTORS_PER_MODE = 4.0
"""of the space in which modes of a band are found: parts with 26 to 234 of them took 3 to 6"""
WORK_BLOCKS = 8  # that a new one needs memory for beside the basis


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


def basis_bytes(n_u: int, n_c: int, blocks: int = EXPECTED_BLOCKS) -> float:
    """Bytes of a growing basis: six rigid modes and `blocks` blocks of n_c vectors (n_u,)."""
    return float(NUMBER_BYTES * n_u * (6 + n_c * (blocks + WORK_BLOCKS)))


def factor_cost(n_u: int, nnz: int, n_c: int, blocks: int = EXPECTED_BLOCKS) -> Cost:
    """The cost of `blocks` solutions of n_c vectors by a factor, with the factor.

    A solution takes 4 nnz(L) operations for each vector; bytes are those of K + s M and the factor.
    """
    factorization = factorization_cost(n_u, nnz)
    solutions = 4.0 * _entries(n_u) * n_c * blocks / SOLVE_RATE
    return Cost(factorization.seconds + solutions, factorization.bytes + ENTRY_BYTES * nnz)


def gradient_steps(condition: float, accuracy: float) -> float:
    """Steps of conjugate gradients for a condition: sqrt(condition) / 2 log(2 / accuracy)."""
    return 0.5 * math.sqrt(condition) * math.log(2.0 / accuracy)


def gradient_cost(
    n_u: int, nnz: int, n_c: int, condition: float, accuracy: float, blocks: int = EXPECTED_BLOCKS
) -> Cost:
    """The cost of `blocks` solutions of n_c vectors by conjugate gradients.

    A step is one product with panels of sixteen vectors and loops that go thirteen times through
    one; a step with multigrid is as much as seven products and forty such loops. Bytes are those of
    the blocks and of seven panels; multigrid takes as much again for its levels, and twice the
    blocks while it is made.
    """
    # A panel that is not full costs as much as one that is.
    panels = math.ceil(n_c / 16)
    product, loop = 32.0 * nnz / BLOCK_RATE / threads(), PANEL_BYTES * n_u / STREAM_RATE / threads()
    steps, memory = gradient_steps(condition, accuracy), 4.5 * nnz + 7.0 * PANEL_BYTES * n_u
    if steps <= MAX_PLAIN_STEPS:
        return Cost(blocks * panels * steps * (product + 13.0 * loop), memory)
    steps = CYCLES_PER_DIGIT * math.log10(1.0 / accuracy)
    seconds = blocks * panels * steps * (7.0 * product + 40.0 * loop)
    return Cost(seconds + nnz / SETUP_RATE, memory + 13.5 * nnz)


def krylov_cost(
    n_u: int, nnz: int, n_c: int, steps: int, solutions: Cost, blocks: int = EXPECTED_BLOCKS
) -> Cost:
    """The cost of a build with n_c interface dofs, `steps` steps and `blocks` blocks of Krylov
    vectors, whose solutions cost as much as is given.

    Bytes are those of K and M, the solutions, the basis and the kernels; seconds those of assembly
    and solutions, and 4 n_u r^2 operations for r vectors made orthogonal. Bars of 107 000 and
    285 000 unknowns took within a fifth of that after the factorization.
    """
    vectors = 6 + n_c * blocks
    products = 4.0 * n_u * vectors**2 / PRODUCT_RATE
    kernels = 4.0 * NUMBER_BYTES * n_c**2 * steps
    return Cost(
        nnz / ASSEMBLY_RATE + solutions.seconds + products,
        2.0 * ENTRY_BYTES * nnz + solutions.bytes + basis_bytes(n_u, n_c, blocks) + kernels,
    )


def surface_cost(n_u: int, nnz: int, columns: int, fields: int, modes: float) -> Cost:
    """The cost of a build with surfaces of `columns` dofs and a number of modes in the band.

    A factor of K, a solution for each column and for each of `VECTORS_PER_MODE` vectors of a mode,
    and 4 n_u r^2 operations for r of these made orthogonal. Bytes are those of K and M, the factor,
    the vectors, the compliance, which is in memory three times with its file, and fields, twice.
    """
    vectors = VECTORS_PER_MODE * modes
    solutions = factor_cost(n_u, nnz, math.ceil(columns + vectors), 1)
    products = 4.0 * n_u * vectors**2 / PRODUCT_RATE
    return Cost(
        nnz / ASSEMBLY_RATE + solutions.seconds + products,
        2.0 * ENTRY_BYTES * nnz
        + solutions.bytes
        + NUMBER_BYTES * (n_u * vectors + 3 * columns**2 + 2 * fields * columns),
    )


def _entries(n_u: int) -> float:
    return float(22.0 * n_u ** (4.0 / 3.0))
