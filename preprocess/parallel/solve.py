"""Linear systems S x = b with S = K + s M spread over processes."""

from collections.abc import Callable
from typing import Any

import numpy as np
from petsc4py import PETSc

from ...superelement.validation import Array
from ..assembly.structure import Structure
from ..errors import MeshError, MethodError
from ..solving.factor import Solve
from ..solving.solver import Solver
from .matrices import SpreadMass, SpreadMatrix
from .ranks import Ranks

MOST = 5000
"""Steps of conjugate gradients; a body that needs more is left to the factor."""


class NotConvergedError(Exception):
    """Conjugate gradients that do not reach their accuracy in `MOST` steps."""


class ConjugateGradients:
    """x = solve(b) with |b - S x| <= accuracy |b| in the norm of D^-1, for the own rows b (n, k).

    All columns at once, with D, the diagonal of S, as preconditioner: so the number of processes
    changes rounding alone. Source: M. R. Hestenes, E. Stiefel, J. Res. Nat. Bur. Standards 49
    (1952) 409-436. Raises `NotConvergedError`.
    """

    def __init__(self, structure: Structure, shift: float, accuracy: float) -> None:
        self._K, self._M, self._shift = structure.K, structure.M, shift
        self._total, self._accuracy = structure.total, accuracy
        self._inverse = 1.0 / (self._K.diagonal() + shift * self._M.diagonal())[:, None]

    def __call__(self, b: Array) -> Array:
        R = np.array(b.reshape(len(b), -1), order="F")
        X, P = np.zeros_like(R), self._inverse * R
        left = self._dots(R, P)
        enough = self._accuracy**2 * left
        for _ in range(MOST):
            if (left <= enough).all():
                return X.reshape(b.shape, order="F")
            Y = self._K @ P + self._shift * (self._M @ P)
            step = _ratio(left, self._dots(P, Y))
            X += step * P
            R -= step * Y
            Z = self._inverse * R
            before, left = left, self._dots(R, Z)
            P *= _ratio(left, before)
            P += Z
        raise NotConvergedError

    def _dots(self, A: Array, B: Array) -> Array:
        return self._total(np.einsum("ik,ik->k", A, B))


def _ratio(a: Array, b: Array) -> Array:
    """a / b (k,), zero where nothing is left."""
    return np.divide(a, b, out=np.zeros_like(a), where=b > 0.0)


class Factor:
    """x = solve(b) by the factor L L^T of S that MUMPS makes, for the own rows b (n, k).

    `MeshError` if S is not positive definite, `MethodError` if MUMPS cannot factorize it.
    """

    def __init__(self, K: SpreadMatrix, M: SpreadMass, shift: float, name: str, ranks: Ranks):
        self._comm, self._shape = ranks.comm, K.shape
        mass = M.assembled()
        self._S = K.mat.copy()
        self._S.axpy(shift, mass)
        mass.destroy()
        self._S.setOption(PETSc.Mat.Option.SPD, True)
        self._solver = PETSc.KSP().create(comm=ranks.comm)
        self._solver.setType("preonly")
        self._solver.setOperators(self._S)
        factorization = self._solver.getPC()
        factorization.setType("cholesky")
        factorization.setFactorSolverType("mumps")
        try:
            self._solver.setUp()
        except PETSc.Error as error:
            raise MethodError(f"{name} ({K.shape[0]} unknowns): MUMPS: {error}") from error
        code, detail = (factorization.getFactorMatrix().getMumpsInfog(k) for k in (1, 2))
        if code == -10 or code == -40:
            raise MeshError(
                f"{name} ({K.shape[0]} unknowns): expected a positive definite matrix, found a "
                "pivot that is not: the body is a mechanism, or its material or mass is not sound"
            )
        if code < 0:
            raise MethodError(
                f"{name} ({K.shape[0]} unknowns): MUMPS failed with INFOG(1) = {code}, "
                f"INFOG(2) = {detail}"
            )

    def __call__(self, b: Array) -> Array:
        columns = np.array(b.reshape(len(b), -1), order="F")
        found = np.zeros_like(columns)
        right, left = (self._dense(array) for array in (columns, found))
        self._solver.matSolve(right, left)
        result = np.array(left.getDenseArray(), order="F").reshape(b.shape, order="F")
        right.destroy()
        left.destroy()
        return result

    def _dense(self, columns: Array) -> Any:
        n, k = columns.shape
        dense = PETSc.Mat().createDense(
            ((n, self._shape[0]), (None, k)), array=columns, comm=self._comm
        )
        dense.assemble()
        return dense


def spread_solver(ranks: Ranks, choice: str) -> Solver:
    """The solver that a body file names by impulse.solver.

    "auto": conjugate gradients, and the factor where they do not converge.
    """

    def solver(structure: Structure, shift: float, name: str, accuracy: float) -> Solve:
        def factor() -> Solve:
            return Factor(structure.K, structure.M, shift, name, ranks)

        if choice == "factor":
            return factor()
        iterative = ConjugateGradients(structure, shift, accuracy)
        return _Patient(iterative, factor) if choice == "auto" else iterative

    return solver


class _Patient:
    """Conjugate gradients, and a factor once they do not converge."""

    def __init__(self, iterative: Solve, factor: Callable[[], Solve]) -> None:
        self._solve, self._factor = iterative, factor

    def __call__(self, b: Array) -> Array:
        try:
            return self._solve(b)
        except NotConvergedError:
            self._solve = self._factor()
            return self._solve(b)
