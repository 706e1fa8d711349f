"""Sparse factorizations, by the first library that solves accurately."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

import numpy as np

from ...superelement.validation import Array
from ..errors import MeshError, MethodError
from ..memory import require
from ..threads import threads
from .cost import factorization_cost

Solve = Callable[[Array], Array]

MAX_FACTOR_RESIDUAL = 1e-10  # of a stable factorization it is some 1e-16, whatever the matrix
PLANNED_COLUMNS = 12  # right-hand sides with memory set aside: two interfaces of six dofs
COARSER_MESH_ADVICE = "use a coarser mesh, or a machine with more memory"
NO_NEEDS: Mapping[str, float] = {}


@dataclass(frozen=True, eq=False)
class Factor:
    """x = factor(b) solves A x = b for b (n,) or (n, k).

    backend: the library that made it; residual: as it was measured; passed_over: why others did
    not.
    """

    solve: Solve
    backend: str
    residual: float
    passed_over: tuple[str, ...] = ()

    def __call__(self, b: Array) -> Array:
        return self.solve(b)

    @property
    def summary(self) -> str:
        """The library and, where it was not the first choice, why."""
        return "; ".join([self.backend, *(f"not {reason}" for reason in self.passed_over)])


def factorize(
    matrix: Any, name: str, beside: Mapping[str, float] = NO_NEEDS, solvers: list[str] | None = None
) -> Factor:
    """Factorize a sparse symmetric positive definite matrix (n, n) with rslab, or the next library.

        max_i |A x - b|_i / (|A| |x| + |b|)_i <= 1e-10

    holds for a random b: the backward error of every equation, which no choice of units can hide.
    Refinement has nothing to add to it: rslab leaves 1e-16 to 4e-14 on mass, stiffness and what
    time steps make of them, for solids in any unit and for beams. `name` is what errors call the
    matrix; `beside`, what is to fit into the memory with the factor, in bytes; the summary of the
    factor is added to `solvers`. `MeshError` if the matrix is not positive definite, `MethodError`
    if no library solves with it, `MemoryShortageError` before anything is factorized that does not
    fit. Source of the residual: W. Oettli and W. Prager, Numerische Mathematik 6 (1964) 405-409.
    """
    A = matrix.tocsc()
    A.sort_indices()
    failures: list[str] = []
    for backend, attempt in _backends():
        try:
            solve = attempt(A, name, beside)
        except _BackendError as failure:
            failures.append(f"{backend}: {failure}")
            continue
        residual = _residual(A, solve)
        if residual <= MAX_FACTOR_RESIDUAL:
            factor = Factor(solve, backend, residual, tuple(failures))
            if solvers is not None:
                solvers.append(factor.summary)
            return factor
        failures.append(
            f"{backend}: relative residual {residual:.1e}, expected {MAX_FACTOR_RESIDUAL:g} at most"
        )
    raise MethodError(
        f"{name} ({A.shape[0]} unknowns) could not be factorized: {'; '.join(failures)}"
    )


class _BackendError(Exception):
    """A library gave up; the next one may not."""


def _backends() -> Iterator[tuple[str, Callable[[Any, str, Mapping[str, float]], Solve]]]:
    """The libraries that are installed, best first."""
    yield "rslab", _rslab
    if find_spec("sksparse") is not None:
        yield "cholmod", _cholmod
    yield "superlu", _superlu


def _rslab(A: Any, name: str, beside: Mapping[str, float] = NO_NEEDS) -> Solve:
    """L D L^T by supernodes, after nested dissection where that pays."""
    import rslab

    analysis = rslab.analyze(A, path="ldlt", threads=threads())
    _require(analysis.memory_plan(nrhs=PLANNED_COLUMNS)["peak_bytes"], A, name, beside)
    try:
        factor = analysis.factor(A)
    except RuntimeError as error:
        raise _BackendError(str(error)) from error
    _, negative, zero = factor.inertia
    if negative or zero:
        raise not_definite(A.shape[0], name, f"{negative} negative and {zero} zero pivots")
    return lambda b: factor.solve(b) if b.ndim == 1 else factor.solve_many(b)


def _cholmod(A: Any, name: str, beside: Mapping[str, float] = NO_NEEDS) -> Solve:
    """L L^T by supernodes. As quick as its BLAS: with the reference one of Debian, eight times
    slower than rslab.
    """
    from sksparse.cholmod import CholmodError, CholmodNotPositiveDefiniteError, analyze

    _require(factorization_cost(A.shape[0], A.nnz).bytes, A, name, beside)
    try:
        factor = analyze(A, mode="supernodal", ordering_method="metis").cholesky(A)
    except CholmodNotPositiveDefiniteError as error:
        raise not_definite(A.shape[0], name, str(error)) from error
    except CholmodError as error:
        raise _BackendError(str(error)) from error
    return lambda b: factor.solve_A(b)


def _superlu(A: Any, name: str, beside: Mapping[str, float] = NO_NEEDS) -> Solve:
    """L U after minimum degree, which fills more; both factors are kept, with their indices."""
    from scipy.sparse.linalg import splu

    _require(3.0 * factorization_cost(A.shape[0], A.nnz).bytes, A, name, beside)
    try:
        # Positive definite matrices need no pivoting: keeping the diagonal keeps the symmetric,
        # sparser ordering.
        factors = splu(
            A, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
    except RuntimeError as error:
        raise _BackendError(str(error)) from error
    return lambda b: factors.solve(b)


def _require(size: float, A: Any, name: str, beside: Mapping[str, float]) -> None:
    require(
        {f"the factorization of {name} ({A.shape[0]} unknowns)": size, **beside},
        COARSER_MESH_ADVICE,
    )


def not_definite(n_u: int, name: str, found: str) -> MeshError:
    """The error of a matrix (n_u, n_u) that is to be positive definite."""
    return MeshError(
        f"{name} ({n_u} unknowns): expected a positive definite matrix, found {found}: "
        "the body is a mechanism, or its material or mass is not sound"
    )


def _residual(A: Any, solve: Solve) -> float:
    """max_i |A x - b|_i / (|A| |x| + |b|)_i for a random b."""
    b = np.random.default_rng(0).standard_normal(A.shape[0])
    x = solve(b)
    worst = np.max(np.abs(A @ x - b) / (abs(A) @ np.abs(x) + np.abs(b)))
    return float(worst) if np.isfinite(worst) else np.inf
