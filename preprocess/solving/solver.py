"""The choice between a factor and conjugate gradients, for the matrices of time steps."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

import numpy as np

from ...files.memory import available
from ...superelement.validation import Array
from ..assembly.structure import Structure
from ..body.impulse import SolverName
from ..memory import require
from .aggregates import panel_multigrid
from .cost import (
    EXPECTED_BLOCKS,
    MAX_PLAIN_STEPS,
    Cost,
    basis_bytes,
    factor_cost,
    gradient_cost,
    gradient_steps,
)
from .factor import COARSER_MESH_ADVICE, Solve, factorize
from .gradients import NotConvergedError, given_up
from .mixed import MIXED_BYTES_RATIO, MIXED_SECONDS_RATIO, MixedFactor, single_factor
from .panels import in_blocks
from .refined import RefinedGradients

SolverFactory = Callable[[Structure, float, str, float, int], Solve]
"""x = S^-1 b for S = K + s M, from a structure, s, what errors call S, the accuracy of x, and the
number of blocks to expect
"""
COMPACT_SHARE = 0.5  # of a factor's by its formula, which is that of a cube
MIN_MIXED_UNKNOWNS = 150_000
"""Unknowns from which on a factor is one in single precision, unless the body file asks for one."""
MAX_QUICK_ERROR = 1e-3
"""Error, relative in energy, of solutions that a space may be made of and corrected afterwards."""
JACOBI_EIGENVALUE = 3.0  # the largest of D^-1 S, about


def solver_of(kind: SolverName) -> SolverFactory:
    """What makes solutions as a body file names it, or for "auto" what costs less."""
    match kind:
        case "factor":
            return factorized
        case "iterative":
            return iterated
        case "auto":
            return cheaper


def factorized(
    structure: Structure, shift: float, name: str, accuracy: float, blocks: int = EXPECTED_BLOCKS
) -> Solve:
    """By a factor, which is more accurate than is asked for."""
    S = structure.K + shift * structure.M
    return factorize(S, name, _basis(structure), structure.solvers)


def mixed(
    structure: Structure, shift: float, name: str, accuracy: float, blocks: int = EXPECTED_BLOCKS
) -> Solve:
    """By a factor in single precision and conjugate gradients, or by one in double where the matrix
    asks too much of that.
    """
    K, M = structure.K, structure.M
    factor = partial(factorized, structure, shift, name, accuracy)
    needed = MIXED_BYTES_RATIO * factor_cost(structure.n_u, K.nnz, structure.P_C.shape[0]).bytes
    require({f"the factor of {name} ({structure.n_u} unknowns)": needed}, COARSER_MESH_ADVICE)
    single = single_factor(K + shift * M)
    if single is None:
        return factor()
    structure.solvers.append("rslab in single precision, refined")
    product = partial(shifted_product, K, M, shift)
    return Patient(MixedFactor(name, structure.n_u, product, single, accuracy), factor)


def iterated(
    structure: Structure, shift: float, name: str, accuracy: float, blocks: int = EXPECTED_BLOCKS
) -> Solve:
    """By conjugate gradients, with multigrid where they would take many steps without."""
    K, M = structure.K, structure.M
    what = f"solving with {name} ({structure.n_u} unknowns) without a factor"
    require({what: costs(structure, shift, accuracy).iterative.bytes}, COARSER_MESH_ADVICE)
    single = in_blocks(K, M, shift)
    multigrid = None
    if gradient_steps(condition(structure, shift), accuracy) > MAX_PLAIN_STEPS:
        try:
            multigrid = panel_multigrid(single, structure.U)
        except np.linalg.LinAlgError as error:
            raise given_up(name, structure.n_u, "the digits of single precision") from error
    structure.solvers.append("conjugate gradients" + (" with multigrid" if multigrid else ""))
    product = partial(shifted_product, K, M, shift)
    return RefinedGradients(name, single, product, accuracy, multigrid)


def cheaper(
    structure: Structure, shift: float, name: str, accuracy: float, blocks: int = EXPECTED_BLOCKS
) -> Solve:
    """By whichever takes less time, among those that memory has room for.

    By a factor, too, once gradients do not converge and it has room.
    """
    both = costs(structure, shift, accuracy, blocks)
    by_factor = factorized if structure.n_u < MIN_MIXED_UNKNOWNS else mixed
    factor = partial(by_factor, structure, shift, name, accuracy)
    if both.cheaper == "factor":
        return factor()
    try:
        iterative = iterated(structure, shift, name, accuracy)
    except NotConvergedError:
        if not both.factor_fits:
            raise
        return factor()
    return Patient(iterative, factor) if both.factor_fits else iterative


class Patient:
    """x = solve(b) by conjugate gradients, and by a factor once they do not converge."""

    def __init__(self, iterative: Solve, factor: Callable[[], Solve]) -> None:
        self._solve, self._factor = iterative, factor

    def __call__(self, b: Array) -> Array:
        try:
            return self._solve(b)
        except NotConvergedError:
            self._solve = self._factor()
            return self._solve(b)

    @property
    def quick(self) -> Solve | None:
        """Solutions at half the work, right to `MAX_QUICK_ERROR`; None where there are no such."""
        solve = self._solve
        if isinstance(solve, Patient):
            return solve.quick
        return (
            solve.once
            if isinstance(solve, MixedFactor) and solve.first_error <= MAX_QUICK_ERROR
            else None
        )


@dataclass(frozen=True)
class Costs:
    """What the solutions of a build cost with a factor and without, and the room for them.

    room: what memory has, and what it has left for a factor beside the basis, which without one
    may be in a file.
    """

    factor: Cost
    iterative: Cost
    room: float
    beside_basis: float

    @property
    def factor_fits(self) -> bool:
        """Whether memory has room for a factor beside the basis."""
        return self.factor.bytes <= self.beside_basis

    @property
    def cheaper(self) -> Literal["factor", "iterative"]:
        """Whichever takes less time, among those that there is room for."""
        quick = COMPACT_SHARE * self.factor.seconds <= self.iterative.seconds
        if not self.factor_fits:
            return "iterative"
        return "factor" if quick or self.iterative.bytes > self.room else "iterative"


def costs(
    structure: Structure, shift: float, accuracy: float, blocks: int = EXPECTED_BLOCKS
) -> Costs:
    """The costs for a structure; the room is what memory has left beside the basis."""
    sizes = structure.n_u, structure.K.nnz, structure.P_C.shape[0]
    factor = factor_cost(*sizes, blocks)
    if structure.n_u >= MIN_MIXED_UNKNOWNS:
        factor = Cost(MIXED_SECONDS_RATIO * factor.seconds, MIXED_BYTES_RATIO * factor.bytes)
    return Costs(
        factor,
        gradient_cost(*sizes, condition(structure, shift), accuracy, blocks),
        free := available(),
        free - sum(_basis(structure).values()),
    )


def condition(structure: Structure, shift: float) -> float:
    """About the condition of D^-1 S, D being the diagonal of S = K + s M.

        lambda_max max (U^T D U) / s

    for rigid motions U, which S leaves s of and nothing less; lambda_max is about 3 for all
    elements.
    """
    D = structure.K.diagonal() + shift * structure.M.diagonal()
    weight = structure.total(structure.U.T @ (D[:, None] * structure.U))
    largest = structure.processes.agreed(lambda: float(np.linalg.eigvalsh(weight)[-1]))
    return JACOBI_EIGENVALUE * largest / shift


def shifted_product(K: Any, M: Any, shift: float, X: Array) -> Array:
    """S X with S = K + s M, in double precision."""
    return np.asarray(K @ X + shift * (M @ X))


def _basis(structure: Structure) -> dict[str, float]:
    """What is to fit into the memory beside the solutions."""
    return {"the Krylov basis": basis_bytes(structure.n_u, structure.P_C.shape[0])}
