"""Linear systems S x = b with S = K + s M spread over processes."""

from contextlib import suppress
from functools import partial

import numpy as np
from petsc4py import PETSc

from ...files.memory import available
from ...superelement.validation import Array
from ..assembly.structure import Structure
from ..body.impulse import SolverName
from ..errors import MemoryShortageError, MethodError
from ..solving.cost import MAX_PLAIN_STEPS, basis_bytes, factor_cost, gradient_cost, gradient_steps
from ..solving.factor import COARSER_MESH_ADVICE, MAX_FACTOR_RESIDUAL, Factor, Solve, not_definite
from ..solving.gradients import ColumnGradients, Columns, Goal
from ..solving.refined import SHARE_OF_ACCURACY
from ..solving.solver import COMPACT_SHARE, Patient, SolverFactory, condition, shifted_product
from .matrices import SpreadMass, SpreadMatrix, dense_columns, shifted
from .multigrid import spread_multigrid
from .ranks import Ranks

SPREAD_SLOWDOWN = 3.5  # of gradients beside their formula, that of single precision
STIFFNESS_ROW_ENTRIES = 80  # of a solid, about
NO_ROOM = (-8, -9, -13, -17, -19, -20)
"""INFOG(1) of MUMPS where it is short of memory, or of a buffer."""
PETSC_VERSION = "PETSc " + ".".join(map(str, PETSc.Sys.getVersion()))


def factorized(structure: Structure, shift: float, name: str, ranks: Ranks) -> Factor:
    """The factor L L^T of S by MUMPS.

        |S x - b| <= 1e-10 (|S| |x| + |b|)    largest entries, and the largest sum of a row of |S|

    holds for a random b. `MeshError` if S is not positive definite, `MemoryShortageError` if it
    does not fit, `MethodError` if MUMPS cannot factorize it, or is not so accurate.
    """
    solve = _Mumps(structure.K, structure.M, shift, name, ranks)
    b = np.random.default_rng(ranks.comm.rank).standard_normal(len(structure.U))
    x = solve(b)
    left = shifted_product(structure.K, structure.M, shift, x) - b
    size, of_x, of_b = (
        ranks.largest(float(np.abs(found).max(initial=0.0))) for found in (left, x, b)
    )
    residual = size / (solve.norm * of_x + of_b)
    if not residual <= MAX_FACTOR_RESIDUAL:
        raise MethodError(
            f"{name} ({structure.n_u} unknowns) could not be factorized: mumps: relative residual "
            f"{residual:.1e}, expected {MAX_FACTOR_RESIDUAL:g} at most"
        )
    factor = Factor(solve, f"mumps, {PETSC_VERSION}", residual)
    structure.solvers.append(factor.summary)
    return factor


class _Mumps:
    """x = solve(b) by the factor that MUMPS makes, for the own rows b (n,) or (n, k)."""

    def __init__(self, K: SpreadMatrix, M: SpreadMass, shift: float, name: str, ranks: Ranks):
        self._S = shifted(K, M, shift)
        self.norm = float(self._S.norm(PETSc.NormType.INFINITY))
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
        # PETSc does not raise for these: the numbers of MUMPS say what has happened.
        code, detail = (factorization.getFactorMatrix().getMumpsInfog(k) for k in (1, 2))
        if code == -10 or code == -40:
            raise not_definite(K.shape[0], name, "a pivot that is not")
        if code in NO_ROOM:
            raise MemoryShortageError(
                f"{name} ({K.shape[0]} unknowns): MUMPS has no room for the factor (INFOG(1) = "
                f"{code}): {COARSER_MESH_ADVICE}",
                np.inf,
                available(),
            )
        if code < 0:
            raise MethodError(
                f"{name} ({K.shape[0]} unknowns): MUMPS failed with INFOG(1) = {code}, "
                f"INFOG(2) = {detail}"
            )

    def __call__(self, b: Array) -> Array:
        right = dense_columns(b, self._S)
        left = dense_columns(np.zeros_like(b), self._S)
        self._solver.matSolve(right, left)
        result = np.array(left.getDenseArray(), order="F").reshape(b.shape, order="F")
        right.destroy()
        left.destroy()
        return result


def spread_solver(ranks: Ranks, kind: SolverName) -> SolverFactory:
    """The solver that a body file names by impulse.solver.

    "auto": the factor, where it takes less time and every machine has room for its share, else
    conjugate gradients; and the factor where those do not converge.
    """

    def solver(
        structure: Structure, shift: float, name: str, accuracy: float, blocks: int
    ) -> Solve:
        # What the solver before has left, which PETSc keeps until all processes ask for it.
        PETSc.garbage_cleanup(ranks.comm)

        def factor() -> Solve:
            return factorized(structure, shift, name, ranks)

        fits = kind == "auto" and _factor_fits(structure)
        if kind == "factor" or (fits and _factor_is_quicker(structure, shift, accuracy, blocks)):
            return factor()
        iterative = iterated(structure, shift, name, accuracy)
        return Patient(iterative, factor) if fits else iterative

    return solver


def iterated(structure: Structure, shift: float, name: str, accuracy: float) -> ColumnGradients:
    """Conjugate gradients, with multigrid where they would take many steps without and it can be
    had; else with the diagonal of S.
    """
    K, M = structure.K, structure.M
    precondition: Solve = partial(np.multiply, 1.0 / (K.diagonal() + shift * M.diagonal())[:, None])
    multigrid = ""
    if gradient_steps(condition(structure, shift), accuracy) > MAX_PLAIN_STEPS:
        with suppress(np.linalg.LinAlgError):
            precondition, multigrid = spread_multigrid(structure, shift), " with multigrid"
    structure.solvers.append(f"conjugate gradients{multigrid}, {PETSC_VERSION}")
    product = partial(shifted_product, K, M, shift)
    system = Columns(product, precondition, structure.processes, order="F")
    return ColumnGradients(system, Goal(name, structure.n_u, SHARE_OF_ACCURACY * accuracy))


def _factor_fits(structure: Structure) -> bool:
    """Whether every machine has room for its share of a factor and of the basis."""
    n_u, n_c = structure.n_u, structure.P_C.shape[0]
    needed = factor_cost(n_u, STIFFNESS_ROW_ENTRIES * n_u, n_c).bytes + basis_bytes(n_u, n_c)
    share = structure.n_here / n_u
    return structure.processes.largest(share * needed / available()) < 1.0


def _factor_is_quicker(structure: Structure, shift: float, accuracy: float, blocks: int) -> bool:
    sizes = structure.n_u, STIFFNESS_ROW_ENTRIES * structure.n_u, structure.P_C.shape[0]
    kappa = condition(structure, shift)

    def quicker() -> bool:
        gradients = gradient_cost(*sizes, kappa, accuracy, blocks)
        return (
            COMPACT_SHARE * factor_cost(*sizes, blocks).seconds
            <= SPREAD_SLOWDOWN * gradients.seconds
        )

    return structure.processes.agreed(quicker)
