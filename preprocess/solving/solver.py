"""The choice between a factor and conjugate gradients, for the matrices of time steps."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ...superelement.validation import Array
from ..assembly.structure import Structure
from .cost import basis_bytes
from .factor import Solve, factorize
from .gradients import ConjugateGradients
from .panels import in_blocks

Kind = Literal["auto", "factor", "iterative"]
Solver = Callable[[Structure, float, str, float], Solve]
"""x = S^-1 b for S = K + s M, from a structure, s, what errors call S, and the accuracy of x"""


def solver_of(kind: Kind) -> Solver:
    return iterated if kind == "iterative" else factorized


def factorized(structure: Structure, shift: float, name: str, accuracy: float) -> Solve:
    """By a factor, which is more accurate than is asked for."""
    beside = {"the Krylov basis": basis_bytes(structure.n_u, structure.P_C.shape[0])}
    return factorize(structure.K + shift * structure.M, name, beside)


def iterated(structure: Structure, shift: float, name: str, accuracy: float) -> Solve:
    """By conjugate gradients."""
    K, M = structure.K, structure.M

    def product(X: Array) -> Array:
        found: Array = K @ X + shift * (M @ X)
        return found

    return ConjugateGradients(name, in_blocks(K, M, shift), product, accuracy)
