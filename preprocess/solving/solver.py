"""What solves with the matrices of time steps."""

from collections.abc import Callable

from ..assembly.structure import Structure
from .cost import basis_bytes
from .factor import Solve, factorize

Solver = Callable[[Structure, float, str, float], Solve]
"""x = S^-1 b for S = K + s M, from a structure, s, what errors call S, and the accuracy of x"""


def factorized(structure: Structure, shift: float, name: str, accuracy: float) -> Solve:
    """By a factor, which is more accurate than is asked for."""
    beside = {"the Krylov basis": basis_bytes(structure.n_u, structure.P_C.shape[0])}
    return factorize(structure.K + shift * structure.M, name, beside)
