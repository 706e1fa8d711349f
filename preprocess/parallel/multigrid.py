"""Algebraic multigrid over processes, as a preconditioner of many columns at once."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from petsc4py import PETSc
from scipy.linalg import cho_solve

from ...superelement.validation import Array
from ..assembly.structure import Structure
from ..processes import Processes
from ..solving.gradients import Columns
from ..solving.multigrid import Multigrid, chebyshev_weights, coarsest_factor, largest_eigenvalue
from .matrices import product, shifted

MAX_COARSEST_UNKNOWNS = 600  # of a level that is solved by a dense factor
OPTIONS_PREFIX = "duhamel_multigrid_"  # of what PETSc is told
RANDOM_COLUMNS = 6  # vectors at once by which the largest eigenvalue is found


@dataclass(frozen=True, eq=False)
class SpreadLevel:
    """A `Level` of PETSc's matrices. inverse: own entries of 1 / D (n, 1); transposed: P^T."""

    S: Any
    inverse: Array
    weights: tuple[float, ...]
    prolongation: Any
    transposed: Any

    def residual(self, R: Array, Z: Array, T: Array) -> None:
        np.subtract(R, product(self.S, Z), out=T)

    def relax(self, weight: float, R: Array, Z: Array) -> None:
        Z += weight * (self.inverse * R)

    def restrict(self, T: Array) -> Array:
        return product(self.transposed, T)

    def prolong(self, correction: Array, Z: Array) -> None:
        Z += product(self.prolongation, correction)


def spread_multigrid(structure: Structure, shift: float) -> Callable[[Array], Array]:
    """R -> Z = T R by multigrid for S = K + s M; own rows (n, k).

    The aggregates and their prolongation, which hold the rigid motions of every aggregate, are
    those of PETSc's GAMG; cycles run on all columns at once. `LinAlgError`, in all processes,
    where a level is singular, for an aggregate has too few nodes for its rigid motions.
    """
    processes = structure.processes
    hierarchy = _hierarchy(shifted(structure.K, structure.M, shift), structure.U)
    levels = []
    for number in range(hierarchy.getMGLevels() - 1, 0, -1):
        S, _ = hierarchy.getMGSmoother(number).getOperators()
        inverse = _inverse_diagonal(S)
        prolongation = hierarchy.getMGInterpolation(number)
        system = Columns(partial(product, S), partial(np.multiply, inverse), processes)
        R = np.random.default_rng(S.comm.rank).standard_normal((len(inverse), RANDOM_COLUMNS))
        weights = chebyshev_weights(largest_eigenvalue(system, R, processes))
        transposed = prolongation.transpose(PETSc.Mat())
        levels.append(SpreadLevel(S, inverse, weights, prolongation, transposed))
    coarsest, _ = hierarchy.getMGCoarseSolve().getOperators()
    cycle = Multigrid(levels, _Coarsest(coarsest, processes))

    def precondition(R: Array) -> Array:
        Z = np.empty_like(R)
        cycle(R, Z)
        return Z

    return precondition


class _Coarsest:
    """Z = S^-1 R on the coarsest level, by a factor that every process has; own rows (n, k)."""

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

    def __call__(self, R: Array, Z: Array) -> None:
        whole = np.concatenate(self._comm.allgather(R))
        Z[:] = cho_solve(self._factor, whole)[self._own]


def _hierarchy(S: Any, U: Array) -> Any:
    """The levels that GAMG makes of S, with rigid motions U (n_own, 6)."""
    S.setBlockSize(3)
    modes = []
    for column in U.T:
        mode = S.createVecRight()
        mode.setArray(column)
        modes.append(mode)
    S.setNearNullSpace(PETSc.NullSpace().create(vectors=modes, comm=S.comm))
    options = PETSc.Options(OPTIONS_PREFIX)
    options["pc_gamg_coarse_eq_limit"] = MAX_COARSEST_UNKNOWNS
    hierarchy = PETSc.PC().create(S.comm)
    hierarchy.setOptionsPrefix(OPTIONS_PREFIX)
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
