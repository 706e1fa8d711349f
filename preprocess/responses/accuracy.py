"""How accurate solutions must be, and what rounding leaves of the error."""

import numpy as np

from ...superelement import Modes
from ...superelement.validation import Array
from .band import LEAST_DAMPING
from .krylov import KrylovSpace
from .ritz import space_shapes

N_LOWEST_MODES = 6  # whose frequencies rounding disturbs most
SMALL_ERROR = 1e-3  # no larger error is put down to rounding
SOLUTION_ERROR_SHARE = 0.1  # of the tolerance, spent on solutions without a factor
ERROR_GAIN = 1e3
"""What the square of the error of solutions, in energy, is in the transfer function: five hundred
times as much was seen.
"""
MIN_SOLUTION_ERROR = 1e-11  # whatever is asked for


def solution_accuracy(tolerance: float, fields: bool) -> float:
    """The error of solutions, in energy, that takes its share of the tolerance.

    Transfer functions, which see loads where they act, err with its square; fields with itself.
    """
    share = SOLUTION_ERROR_SHARE * tolerance
    error = share / np.sqrt(ERROR_GAIN) if fields else np.sqrt(share / ERROR_GAIN)
    return max(MIN_SOLUTION_ERROR, float(error))


def unsolved_error(accuracy: float, fields: bool) -> float:
    """What solutions of an accuracy leave of the error, the other way round."""
    return float(np.sqrt(ERROR_GAIN) * accuracy if fields else ERROR_GAIN * accuracy**2)


def rounding_error(space: KrylovSpace, modes: Modes, Q: Array) -> float:
    """What rounding of the stiffness may make of the largest error, up to `SMALL_ERROR`.

        eps x^T D x / omega^2,    x: a mode,    D: the diagonal of K

    of a squared frequency, which counts 1 / (2 LEAST_DAMPING) times at a resonance. Elements that
    are far stiffer than the body, as short ones of a slender beam, have much of it.
    """
    structure, lowest = space.structure, np.argsort(modes.omega)[:N_LOWEST_MODES]
    X = space_shapes(space.basis, Q[:, lowest]).combined(np.eye(len(lowest)))
    stiffness = structure.total(np.einsum("i,ik,ik->k", structure.K.diagonal(), X, X))
    share = np.finfo(float).eps * float((stiffness / modes.omega[lowest] ** 2).max())
    return min(SMALL_ERROR, 0.5 * share / LEAST_DAMPING)
