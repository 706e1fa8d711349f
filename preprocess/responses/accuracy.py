"""How accurate solutions must be, and what rounding leaves of the error."""

import numpy as np

from ...superelement import Modes
from ...superelement.validation import Array
from .band import LEAST_DAMPING
from .krylov import KrylovSpace
from .ritz import space_shapes

LOWEST = 6
"""Modes, the lowest, whose frequencies rounding disturbs most."""
SMALL_ERROR = 1e-3
"""No larger error is put down to rounding."""
UNSOLVED = 0.1
"""Share of the tolerance that may be spent on solutions without a factor."""
AMPLIFIED = 1e3
"""What the square of the error of solutions, in energy, is in the transfer function: five hundred
times as much was seen.
"""
FINEST = 1e-11
"""The accuracy that solutions can reach, whatever is asked for."""


def solution_accuracy(tolerance: float, fields: bool) -> float:
    """The error of solutions, in energy, that takes its share of the tolerance.

    Transfer functions, which see loads where they act, err with its square; fields with itself.
    """
    share = UNSOLVED * tolerance
    error = share / np.sqrt(AMPLIFIED) if fields else np.sqrt(share / AMPLIFIED)
    return max(FINEST, float(error))


def unsolved_error(accuracy: float, fields: bool) -> float:
    """What solutions of an accuracy leave of the error, the other way round."""
    return float(np.sqrt(AMPLIFIED) * accuracy if fields else AMPLIFIED * accuracy**2)


def rounding_error(space: KrylovSpace, modes: Modes, Q: Array) -> float:
    """What rounding of the stiffness may make of the largest error, up to `SMALL_ERROR`.

        eps x^T D x / omega^2,    x: a mode,    D: the diagonal of K

    of a squared frequency, which counts 1 / (2 LEAST_DAMPING) times at a resonance. Elements that
    are far stiffer than the body, as short ones of a slender beam, have much of it.
    """
    structure, lowest = space.structure, np.argsort(modes.omega)[:LOWEST]
    X = space_shapes(space.basis, Q[:, lowest]).combined(np.eye(len(lowest)))
    stiffness = structure.total(np.einsum("i,ik,ik->k", structure.K.diagonal(), X, X))
    share = np.finfo(float).eps * float((stiffness / modes.omega[lowest] ** 2).max())
    return min(SMALL_ERROR, 0.5 * share / LEAST_DAMPING)
