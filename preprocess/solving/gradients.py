"""Conjugate gradients for vectors of any kind, and the errors that they are stopped by."""

from collections.abc import Callable, Iterator
from copy import copy
from dataclasses import dataclass
from itertools import islice
from typing import Any, Generic, Literal, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from ...superelement.validation import Array
from ..errors import MethodError
from ..processes import ONE_PROCESS, Processes

MIN_WINDOW = 3
"""Steps at least, a sixth of all beyond, whose gain of energy tells how fast the error falls."""
MAX_GAIN_RATIO = 0.999  # of two windows: a larger one says nothing of what is to come
NEGLIGIBLE_REMAINDER = 1e-12
"""R . T R over the first one that is rounding, where a matrix may give a direction no energy."""
MAX_CG_STEPS = 1000
"""Where a matrix takes more, as that of elements 1:250 flat, what is left is underestimated."""

Vectors = TypeVar("Vectors", bound=NDArray[Any])


class System(Protocol[Vectors]):
    """S X = B for k vectors side by side, and T near to S^-1; both symmetric, positive definite.

    Inner products are those of each vector (k,). What a call returns may be overwritten by the
    next call of the same method.
    """

    def multiply(self, P: Vectors) -> tuple[Vectors, Array]:
        """Y = S P, and the inner products P . Y."""

    def precondition(self, R: Vectors) -> tuple[Vectors, Array]:
        """Z = T R, and the inner products R . Z."""

    def advance(self, alpha: Array, P: Vectors, Y: Vectors, X: Vectors, R: Vectors) -> None:
        """X += alpha P, R -= alpha Y."""

    def turn(self, beta: Array, Z: Vectors, P: Vectors) -> None:
        """P = Z + beta P."""


@dataclass(frozen=True, eq=False)
class Columns:
    """A `System` of the columns of arrays (n, k) in double precision; own rows of each process.

    order: in which the product is quickest.
    """

    product: Callable[[Array], Array]
    inverse: Callable[[Array], Array]
    processes: Processes = ONE_PROCESS
    order: Literal["C", "F"] = "C"

    def multiply(self, P: Array) -> tuple[Array, Array]:
        Y = self.product(P)
        return Y, self._dots(P, Y)

    def precondition(self, R: Array) -> tuple[Array, Array]:
        Z = self.inverse(R)
        return Z, self._dots(R, Z)

    def advance(self, alpha: Array, P: Array, Y: Array, X: Array, R: Array) -> None:
        X += alpha * P
        R -= alpha * Y

    def turn(self, beta: Array, Z: Array, P: Array) -> None:
        P *= beta
        P += Z

    def _dots(self, A: Array, B: Array) -> Array:
        return self.processes.total(np.einsum("ik,ik->k", A, B))


class Step(NamedTuple):
    """A step of conjugate gradients: its length alpha, R . T R before it, and P . S P (k,)."""

    length: Array
    remaining: Array
    energies: Array


def descend(system: System[Vectors], R: Vectors, X: Vectors) -> Iterator[Step]:
    """Steps of conjugate gradients without end, which add S^-1 R to X and leave in R the residual.

    Source: M. R. Hestenes, E. Stiefel, J. Res. Nat. Bur. Standards 49 (1952) 409-436.
    """
    Z, remaining = system.precondition(R)
    P = copy(Z)
    while True:
        Y, energies = system.multiply(P)
        length = ratio(remaining, energies)
        system.advance(length, P, Y, X, R)
        yield Step(length, remaining, energies)
        before = remaining
        Z, remaining = system.precondition(R)
        system.turn(ratio(remaining, before), Z, P)


def ratio(a: Array, b: Array) -> Array:
    """a / b (k,), zero where nothing is left."""
    return np.divide(a, b, out=np.zeros_like(a), where=b > 0.0)


@dataclass(frozen=True, eq=False)
class Solution(Generic[Vectors]):
    """X, what each step took off the square of the error in energy, and what is left of it (k,)."""

    X: Vectors
    gains: list[Array]
    left: Array

    @property
    def energy(self) -> Array:
        """X . S X (k,)."""
        return np.asarray(np.sum(self.gains, axis=0))


def energy_left(gains: list[Array]) -> Array:
    """The square of the error in energy (k,) that is left, by the rate of the last gains.

    The gains of two windows of steps give the rate. Source: Z. Strakos, P. Tichy, Electron. Trans.
    Numer. Anal. 13 (2002) 56-80.
    """
    window = max(MIN_WINDOW, len(gains) // 6)
    if len(gains) < 2 * window:
        return np.where(gains[-1] > 0.0, np.inf, 0.0)
    last = np.sum(gains[-window:], axis=0)
    rate = np.minimum(ratio(last, np.sum(gains[-2 * window : -window], axis=0)), MAX_GAIN_RATIO)
    return np.asarray(last * rate / (1.0 - rate))


class NotConvergedError(MethodError):
    """Conjugate gradients that do not reach their accuracy."""


def given_up(name: str, n_u: int, after: str) -> NotConvergedError:
    """The error where something is not enough to solve with the matrix `name`."""
    return NotConvergedError(
        f"{name} ({n_u} unknowns): {after} are not enough: the body is a mechanism, its elements "
        'far too flat, or the step too long; try impulse.solver = "factor"'
    )


@dataclass(frozen=True)
class Goal:
    """When solutions are right, and which matrix errors are told of.

    relative: the error that is allowed, over the size of the solution, both in energy. left: what
    tells the square of the error from the gains of all steps.
    """

    name: str
    n_u: int
    relative: float
    max_steps: int = MAX_CG_STEPS
    left: Callable[[list[Array]], Array] = energy_left


def converge(
    system: System[Vectors], R: Vectors, goal: Goal, enough: Array | float = 0.0
) -> Solution[Vectors]:
    """S^-1 R, with R used up. enough (k,): squares of errors in energy that are allowed anyway.

    `NotConvergedError` after too many steps, or where the matrix is not positive definite.
    """
    X, steps, gains = np.zeros_like(R), [], []
    for step in islice(descend(system, R, X), goal.max_steps):
        steps.append(step)
        gains.append(step.length * step.remaining)
        negligible = NEGLIGIBLE_REMAINDER * np.abs(steps[0].remaining)
        if (~(step.energies > 0.0) & ~(np.abs(step.remaining) <= negligible)).any():
            digits = "single" if R.dtype == np.float32 else "double"
            raise given_up(goal.name, goal.n_u, f"the digits of {digits} precision")
        left = goal.left(gains)
        if (left <= np.maximum(enough, goal.relative**2 * np.sum(gains, axis=0))).all():
            return Solution(X, gains, left)
    raise given_up(goal.name, goal.n_u, f"{goal.max_steps} steps of conjugate gradients")


class ColumnGradients:
    """x = solve(b) with S x = b for b (n,) or (n, k), all columns at once; each process its rows.

    Of each solution so far, iterations: its steps; first_errors: the largest error that the first
    of them has left, relative in energy. `NotConvergedError` if it does not converge.
    """

    def __init__(self, system: Columns, goal: Goal) -> None:
        self._system, self._goal = system, goal
        self.iterations: list[int] = []
        self.first_errors: list[float] = []

    def __call__(self, b: Array) -> Array:
        R = np.array(b.reshape(len(b), -1), order=self._system.order)
        found = converge(self._system, R, self._goal)
        left = ratio(found.energy - found.gains[0], found.energy)
        self.iterations.append(len(found.gains))
        self.first_errors.append(float(np.sqrt(left).max()))
        return found.X.reshape(b.shape)
