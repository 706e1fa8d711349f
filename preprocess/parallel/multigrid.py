"""Algebraic multigrid over processes, as a preconditioner of many columns at once."""

from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np
from petsc4py import PETSc
from scipy.linalg import cho_solve

from ...superelement.validation import Array
from ..assembly.structure import Structure
from ..processes import Processes
from ..solving.multigrid import (
    LANCZOS,
    MARGIN,
    chebyshev_weights,
    coarsest_factor,
    largest_of_gradients,
)
from .matrices import product, shifted

COARSEST = 600
"""Unknowns of a level that is solved by a dense factor, at most."""
PREFIX = "duhamel_multigrid_"
"""of the options that PETSc is given"""
COLUMNS = 6
"""random vectors at once by which the largest eigenvalue is found"""


@dataclass(frozen=True, eq=False)
class Level:
    """A level: its matrix, the own entries of its inverse diagonal (n, 1), the weights of its
    smoother, and the way to the next coarser one, prolong P and restrict P^T.
    """

    S: Any
    inverse: Array
    weights: tuple[float, ...]
    prolong: Any
    restrict: Any


class Multigrid:
    """Z = T R by one V-cycle, symmetric and positive definite, for S = K + s M; own rows (n, k).

    The aggregates and their prolongation, which hold the rigid motions of every aggregate, are
    those of PETSc's GAMG; cycles run on all columns at once. A sweep of the smoother is one of
    Jacobi, weighted as in one process (solving/multigrid.py). `LinAlgError`, in all processes,
    where a level is singular, for an aggregate has too few nodes for its rigid motions.
    """

    def __init__(self, structure: Structure, shift: float) -> None:
        S = shifted(structure.K, structure.M, shift)
        hierarchy = _hierarchy(S, structure.U)
        self._levels = []
        for number in range(hierarchy.getMGLevels() - 1, 0, -1):
            matrix, _ = hierarchy.getMGSmoother(number).getOperators()
            inverse = _inverse_diagonal(matrix)
            prolong = hierarchy.getMGInterpolation(number)
            largest = _largest_eigenvalue(matrix, inverse, structure.processes)
            weights = chebyshev_weights(largest)
            restrict = prolong.transpose(PETSc.Mat())
            self._levels.append(Level(matrix, inverse, weights, prolong, restrict))
        coarsest, _ = hierarchy.getMGCoarseSolve().getOperators()
        self._coarsest = _Coarsest(coarsest, structure.processes)
        self._hierarchy = hierarchy

    def __call__(self, R: Array) -> Array:
        return self._cycle(0, R)

    def _cycle(self, number: int, R: Array) -> Array:
        if number == len(self._levels):
            return self._coarsest(R)
        level = self._levels[number]
        Z = level.weights[0] * (level.inverse * R)
        for weight in level.weights[1:]:
            Z += weight * (level.inverse * (R - product(level.S, Z)))
        coarse = product(level.restrict, R - product(level.S, Z))
        Z += product(level.prolong, self._cycle(number + 1, coarse))
        for weight in reversed(level.weights):
            Z += weight * (level.inverse * (R - product(level.S, Z)))
        return Z


class _Coarsest:
    """x = S^-1 b on the coarsest level, by a factor that every process has; own rows b (n, k)."""

    def __init__(self, S: Any, processes: Processes) -> None:
        self._comm = S.comm.tompi4py()
        first, columns, values = S.getValuesCSR()
        begin, end = S.getOwnershipRange()
        self._own = slice(begin, end)
        own = np.zeros((end - begin, S.size[1]))
        own[np.repeat(np.arange(end - begin), np.diff(first)), columns] = values
        whole = np.concatenate(self._comm.allgather(own))
        factor = None
        with suppress(np.linalg.LinAlgError):
            factor = coarsest_factor(whole)
        if processes.largest(factor is None):
            raise np.linalg.LinAlgError("the coarsest level of multigrid is singular")
        self._factor = factor

    def __call__(self, b: Array) -> Array:
        x: Array = cho_solve(self._factor, np.concatenate(self._comm.allgather(b)))
        return x[self._own]


def _hierarchy(S: Any, U: Array) -> Any:
    """The levels that GAMG makes of S, with rigid motions U (n_own, 6)."""
    S.setBlockSize(3)
    modes = []
    for column in U.T:
        mode = S.createVecRight()
        mode.setArray(column)
        modes.append(mode)
    S.setNearNullSpace(PETSc.NullSpace().create(vectors=modes, comm=S.comm))
    options = PETSc.Options(PREFIX)
    options["pc_gamg_coarse_eq_limit"] = COARSEST
    hierarchy = PETSc.PC().create(S.comm)
    hierarchy.setOptionsPrefix(PREFIX)
    hierarchy.setType("gamg")
    hierarchy.setOperators(S)
    hierarchy.setFromOptions()
    hierarchy.setUp()
    for mode in modes:
        mode.destroy()
    return hierarchy


def _inverse_diagonal(S: Any) -> Array:
    vector = S.getDiagonal()
    with np.errstate(divide="ignore"):
        found: Array = 1.0 / np.array(vector.getArray())[:, None]
    vector.destroy()
    return found


def _largest_eigenvalue(S: Any, inverse: Array, processes: Processes) -> float:
    """That of D^-1 S, D being its diagonal, as in one process."""

    def dots(A: Array, B: Array) -> Array:
        return processes.total(np.einsum("ik,ik->k", A, B))

    R = np.random.default_rng(S.comm.rank).standard_normal((len(inverse), COLUMNS))
    Z = inverse * R
    P, remaining = Z, dots(R, Z)
    steps: list[Array] = []
    ratios: list[Array] = []
    for _ in range(LANCZOS):
        Y = product(S, P)
        steps.append(remaining / dots(P, Y))
        R = R - steps[-1] * Y
        Z = inverse * R
        before, remaining = remaining, dots(R, Z)
        ratios.append(remaining / before)
        P = Z + ratios[-1] * P
    return MARGIN * largest_of_gradients(np.array(steps), np.array(ratios), processes)
