"""Ways to search for an optimum: downhill from a point, or in all of the bounds first.

Each takes a problem and where to begin, and says how it ended. A failed run has a large objective,
before which searches draw back.
"""

from typing import Any, NamedTuple

import numpy as np

from ..files.arrays import Array
from .optimize_problem import FIRST_STEP, OptimizeProblem

FAILURE_PENALTY = 1e3
"""the objective of a run that failed, in sizes of a first step, above the last one"""
CLOSE_ENOUGH = 1e-7
"""of the objective in its scale, at which a search ends"""
MOST_ITERATIONS = 200
POPULATION_SHARE = 8
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

    Points are x, or (x, z) where the objective is the largest of several numbers. of_violation:
    minimize z >= 0 with g(x), h(x), -h(x) <= z instead.
    """

    def __init__(self, problem: OptimizeProblem, begin: Array, of_violation: bool) -> None:
        self._problem, self._of_violation = problem, of_violation
        first = problem.numbers(begin)
        assert first is not None
        self._last = first
        terms, below, equal = self._parts(first)
        self.has_level = of_violation or len(terms) > 1
        self.has_limits, self.has_equalities = self.has_level or len(below) > 0, len(equal) > 0
        level = [max(terms.max(), 0.0) if of_violation else terms.max()] if self.has_level else []
        self.begin = np.concatenate([begin, level])
        free = [0.0 if of_violation else -np.inf, np.inf]
        self.bounds = np.vstack([problem.bounds.T, *([free] if self.has_level else [])])

    def inner(self, point: Array) -> Array:
        return point[: len(point) - self.has_level].copy()

    def objective(self, point: Array) -> float:
        terms, _, _ = self._numbers(point)
        has_failed = self._problem.numbers(self.inner(point)) is None
        return float((point[-1] if self.has_level else terms[0]) + FAILURE_PENALTY * has_failed)

    def objective_slope(self, point: Array) -> Array:
        of_level: Array = np.eye(len(point))[-1]
        return of_level if self.has_level else self._slopes(point)[0][0]

    def limits(self, point: Array) -> Array:
        """Not above 0 (m,)."""
        terms, below, _ = self._numbers(point)
        return np.concatenate([terms - point[-1], below]) if self.has_level else below

    def limit_slopes(self, point: Array) -> Array:
        terms, below, _ = self._slopes(point)
        if not self.has_level:
            return below
        by_level = np.repeat([-1.0, 0.0], [len(terms), len(below)])
        return np.column_stack([np.vstack([terms, below]), by_level])

    def equalities(self, point: Array) -> Array:
        return self._numbers(point)[2]

    def equality_slopes(self, point: Array) -> Array:
        equal = self._slopes(point)[2]
        return np.column_stack([equal, np.zeros(len(equal))]) if self.has_level else equal

    def _numbers(self, point: Array) -> tuple[Array, Array, Array]:
        """Those of the last run that did not fail, where one does."""
        if (found := self._problem.numbers(self.inner(point))) is not None:
            self._last = found
        return self._parts(self._last)

    def _slopes(self, point: Array) -> tuple[Array, Array, Array]:
        return self._parts(self._problem.slopes(self.inner(point)))

    def _parts(self, rows: Array) -> tuple[Array, Array, Array]:
        """What is minimized, limits and equalities, of numbers or of their slopes."""
        is_objective, is_equality = self._problem.is_objective, self._problem.is_equality
        below, equal = rows[~is_objective & ~is_equality], rows[is_equality]
        if self._of_violation:
            return np.concatenate([below, equal, -equal]), rows[:0], rows[:0]
        return rows[is_objective], below, equal


def slsqp(problem: OptimizeProblem, begin: Array, of_violation: bool = False) -> Ending:
    """Sequential quadratic programming; of_violation: go where the largest miss is least."""
    from scipy.optimize import Bounds, minimize

    smooth = SmoothProblem(problem, begin, of_violation)
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
        return np.array([[FAILURE_PENALTY if one is None else missed(one) for one in found]])

    def missed(numbers: Array) -> float:
        equal = np.maximum(np.abs(numbers[is_equality]) - EQUALITY_BAND, 0.0)
        below = numbers[~is_objective & ~is_equality]
        return float(np.maximum(below, 0.0).sum() + equal.sum())

    limits = () if is_objective.all() else (NonlinearConstraint(misses, -np.inf, 0.0),)
    found = evolve(
        objectives,
        Bounds(*problem.bounds),
        popsize=POPULATION_SHARE,
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


def _columns(points: Array) -> list[Array]:
    return [column.copy() for column in np.atleast_2d(points.T)]
