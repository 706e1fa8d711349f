"""Ways to search for an optimum: downhill from a point, or in all of the bounds first.

Each takes a problem and where to begin, and says how it ended. A failed run has a large objective,
before which searches draw back.
"""

from typing import Any, NamedTuple

import numpy as np

from ..files.arrays import Array
from .optimize_problem import FIRST_STEP, OptimizeProblem

FAILED = 1e3
"""the objective of a run that failed, in sizes of a first step, above the last one"""
CLOSE_ENOUGH = 1e-7
"""of the objective in its scale, at which a search ends"""
MOST_ITERATIONS = 200
POPULATION = 8
"""of a global search, for each parameter"""
GLOBAL_TOLERANCE = 0.02
"""of the spread of a population over its mean, at which it has drawn together"""
EQUALITY_BAND = 1e-2
"""of a limit, within which a global search takes an equality for kept"""


class Ending(NamedTuple):
    """Whether a search found that it cannot improve, and its own words."""

    converged: bool
    told: str


class SmoothProblem:
    """A problem as the minimizers of scipy take it.

        minimize F(x)  or  z with F_j(x) <= z      subject to  g(x) <= 0, h(x) = 0

    Points are x, or (x, z) where the objective is the largest of several numbers.
    """

    def __init__(self, problem: OptimizeProblem, begin: Array) -> None:
        self._problem = problem
        self._objective = problem.is_objective
        self._below = ~self._objective & ~problem.is_equality
        self._equal = problem.is_equality
        self.has_level = int(self._objective.sum()) > 1
        first = problem.numbers(begin)
        assert first is not None
        self._last = first
        level = [first[self._objective].max()] if self.has_level else []
        self.begin = np.concatenate([begin, level])
        free = [-np.inf, np.inf]
        self.bounds = np.vstack([problem.bounds.T, *([free] if self.has_level else [])])
        self.has_equalities = bool(self._equal.any())
        self.has_limits = self.has_level or bool(self._below.any())

    def inner(self, point: Array) -> Array:
        return point[: len(point) - self.has_level].copy()

    def objective(self, point: Array) -> float:
        numbers, has_failed = self._numbers(point)
        level = point[-1] if self.has_level else numbers[self._objective][0]
        return float(level + FAILED * has_failed)

    def objective_slope(self, point: Array) -> Array:
        if self.has_level:
            level: Array = np.eye(len(point))[-1]
            return level
        found: Array = self._slopes(point)[self._objective][0]
        return found

    def limits(self, point: Array) -> Array:
        """Not above 0 (m,)."""
        numbers, _ = self._numbers(point)
        over = numbers[self._objective] - point[-1] if self.has_level else np.zeros(0)
        return np.concatenate([over, numbers[self._below]])

    def limit_slopes(self, point: Array) -> Array:
        slopes = self._slopes(point)
        if not self.has_level:
            return slopes[self._below]
        over = np.column_stack([slopes[self._objective], -np.ones(self._objective.sum())])
        below = np.column_stack([slopes[self._below], np.zeros(self._below.sum())])
        return np.vstack([over, below])

    def equalities(self, point: Array) -> Array:
        return self._numbers(point)[0][self._equal]

    def equality_slopes(self, point: Array) -> Array:
        found = self._slopes(point)[self._equal]
        return np.column_stack([found, np.zeros(len(found))]) if self.has_level else found

    def _numbers(self, point: Array) -> tuple[Array, bool]:
        found = self._problem.numbers(self.inner(point))
        if found is not None:
            self._last = found
        return self._last, found is None

    def _slopes(self, point: Array) -> Array:
        return self._problem.slopes(self.inner(point))


def slsqp(problem: OptimizeProblem, begin: Array) -> Ending:
    """Sequential quadratic programming."""
    from scipy.optimize import Bounds, minimize

    smooth = SmoothProblem(problem, begin)
    constraints: list[Any] = []
    if smooth.has_limits:
        constraints.append(
            {
                "type": "ineq",
                "fun": lambda point: -smooth.limits(point),
                "jac": lambda point: -smooth.limit_slopes(point),
            }
        )
    if smooth.has_equalities:
        constraints.append({"type": "eq", "fun": smooth.equalities, "jac": smooth.equality_slopes})
    found = minimize(
        smooth.objective,
        smooth.begin,
        jac=smooth.objective_slope,
        bounds=Bounds(*smooth.bounds.T),
        constraints=constraints,
        method="SLSQP",
        options={"maxiter": MOST_ITERATIONS, "ftol": CLOSE_ENOUGH},
    )
    return Ending(found.status == 0, f"SLSQP: {found.message}")


def differential_evolution(problem: OptimizeProblem, begin: Array) -> Ending:
    """A population that draws together in the bounds; it ends at no optimum, only near one."""
    from scipy.optimize import Bounds, NonlinearConstraint
    from scipy.optimize import differential_evolution as evolve

    is_objective, is_equality = problem.is_objective, problem.is_equality

    def objectives(points: Array) -> Array:
        found = problem.many(_columns(points))
        return np.array([np.inf if one is None else one[is_objective].max() for one in found])

    def misses(points: Array) -> Array:
        found = problem.many(_columns(points))
        return np.array([[FAILED if one is None else missed(one) for one in found]])

    def missed(numbers: Array) -> float:
        equal = np.maximum(np.abs(numbers[is_equality]) - EQUALITY_BAND, 0.0)
        below = numbers[~is_objective & ~is_equality]
        return float(np.maximum(below, 0.0).sum() + equal.sum())

    limits = () if is_objective.all() else (NonlinearConstraint(misses, -np.inf, 0.0),)
    found = evolve(
        objectives,
        Bounds(*problem.bounds),
        popsize=POPULATION,
        tol=GLOBAL_TOLERANCE,
        atol=GLOBAL_TOLERANCE * FIRST_STEP,
        rng=np.random.default_rng(problem.goals.table.seed),
        polish=False,
        init="sobol",
        updating="deferred",
        vectorized=True,
        constraints=limits,
        x0=begin,
    )
    return Ending(False, f"differential evolution: {found.message}")


def least_violation(problem: OptimizeProblem, begin: Array) -> None:
    """Go where limits are missed least, in the sense of least squares."""
    from scipy.optimize import least_squares

    rows, equal = ~problem.is_objective, problem.is_equality[~problem.is_objective]

    def missed(point: Array) -> Array:
        numbers = problem.numbers(point)
        if numbers is None:
            return np.full(int(rows.sum()), np.inf)
        return np.where(equal, numbers[rows], np.maximum(numbers[rows], 0.0))

    def slopes(point: Array) -> Array:
        found = problem.slopes(point)[rows]
        return np.where((equal | (missed(point) > 0.0))[:, None], found, 0.0)

    low, high = problem.bounds
    margin = 1e-9 * np.where(np.isfinite(high - low), high - low, 0.0)
    least_squares(
        missed,
        np.clip(begin, low + margin, high - margin),
        slopes,
        (low, high),
        max_nfev=MOST_ITERATIONS,
    )


def _columns(points: Array) -> list[Array]:
    return [column.copy() for column in np.atleast_2d(points.T)]
