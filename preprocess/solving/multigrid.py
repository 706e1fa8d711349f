"""The V-cycle of algebraic multigrid, for vectors of any kind; its smoother and coarsest level."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any, Generic, Protocol

import numpy as np
from scipy.linalg import cho_factor, eigvalsh_tridiagonal

from ...superelement.validation import Array
from ..processes import ONE_PROCESS, Processes
from .gradients import System, Vectors, descend

SMOOTHER_SWEEPS = 2  # before and after the correction of a coarser level
SMOOTHED_RANGE = 16.0
"""The smoother is to damp the spectrum from its end to that end divided by this."""
LANCZOS_STEPS = 16  # by which the largest eigenvalue is found, for some random vectors at once
EIGENVALUE_MARGIN = 1.05
"""What they may have missed of it: cycles bear a little more, then they are not positive."""


class Level(Protocol[Vectors]):
    """A level but the coarsest: its matrix S, the diagonal D of that, and the prolongation P."""

    @property
    def weights(self) -> Sequence[float]:
        """Of the sweeps of the smoother, as `chebyshev_weights` has them."""

    def residual(self, R: Vectors, Z: Vectors, T: Vectors) -> None:
        """T = R - S Z."""

    def relax(self, weight: float, R: Vectors, Z: Vectors) -> None:
        """Z += weight D^-1 R."""

    def restrict(self, T: Vectors) -> Vectors:
        """P^T T."""

    def prolong(self, correction: Vectors, Z: Vectors) -> None:
        """Z += P correction."""


@dataclass(frozen=True, eq=False)
class Multigrid(Generic[Vectors]):
    """Z = T R by one V-cycle, symmetric and positive definite.

    A sweep of the smoother is one of Jacobi, its weights the inverse zeros of Chebyshev's
    polynomial on the upper part of the spectrum. coarsest: Z = S^-1 R on the last level. Source:
    P. Vanek, J. Mandel, M. Brezina, Computing 56 (1996) 179-196; M. Adams et al., J. Comput. Phys.
    188 (2003) 593-610.
    """

    levels: Sequence[Level[Vectors]]
    coarsest: Callable[[Vectors, Vectors], None]

    def __call__(self, R: Vectors, Z: Vectors) -> None:
        self._cycle(0, R, Z)

    def _cycle(self, number: int, R: Vectors, Z: Vectors) -> None:
        if number == len(self.levels):
            self.coarsest(R, Z)
            return
        level, T = self.levels[number], np.empty_like(R)
        Z[:] = 0.0
        level.relax(level.weights[0], R, Z)
        for weight in level.weights[1:]:
            level.residual(R, Z, T)
            level.relax(weight, T, Z)
        level.residual(R, Z, T)
        coarse = level.restrict(T)
        correction = np.empty_like(coarse)
        self._cycle(number + 1, coarse, correction)
        level.prolong(correction, Z)
        for weight in reversed(level.weights):
            level.residual(R, Z, T)
            level.relax(weight, T, Z)


def coarsest_factor(S: Array) -> Any:
    """The factor of a dense matrix, symmetric but for rounding; `LinAlgError` if it has none."""
    if not np.isfinite(S).all():
        raise np.linalg.LinAlgError("the coarsest level of multigrid is singular")
    return cho_factor(0.5 * (S + S.T))


def chebyshev_weights(largest: float) -> tuple[float, ...]:
    """The inverse zeros of Chebyshev's polynomial on [largest / SMOOTHED_RANGE, largest]."""
    smallest = largest / SMOOTHED_RANGE
    middle, half = 0.5 * (largest + smallest), 0.5 * (largest - smallest)
    zeros = middle + half * np.cos(np.pi * (np.arange(SMOOTHER_SWEEPS) + 0.5) / SMOOTHER_SWEEPS)
    return tuple((1.0 / zeros).tolist())


def largest_eigenvalue(
    system: System[Vectors], R: Vectors, processes: Processes = ONE_PROCESS
) -> float:
    """That of T S, with a margin, from random vectors R, which are used up.

    By Lanczos's method, whose tridiagonal matrix the steps alpha_j of conjugate gradients and their
    beta_j give: 1 / alpha_j + beta_(j-1) / alpha_(j-1), and sqrt(beta_j) / alpha_j beside it.
    `LinAlgError` where S is not positive definite. Source: Y. Saad, Iterative Methods for Sparse
    Linear Systems (2003), section 6.7.3.
    """
    steps = list(islice(descend(system, R, np.zeros_like(R)), LANCZOS_STEPS))
    lengths, remaining = (np.array([step[n] for step in steps]) for n in (0, 1))
    if not (np.isfinite(lengths).all() and (lengths > 0.0).all()):
        raise np.linalg.LinAlgError("a level of multigrid is not positive definite")
    ratios = remaining[1:] / remaining[:-1]
    diagonals = 1.0 / lengths
    diagonals[1:] += ratios / lengths[:-1]
    beside = np.sqrt(ratios) / lengths[:-1]
    pairs = list(zip(diagonals.T, beside.T, strict=True))
    largest = processes.agreed(
        lambda: max(float(eigvalsh_tridiagonal(*pair)[-1]) for pair in pairs)
    )
    return EIGENVALUE_MARGIN * largest
