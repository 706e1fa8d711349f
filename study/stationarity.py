"""Whether slopes tell that a point is an optimum, and by how much each limit keeps it there.

    sum_j w_j grad F_j + sum_i lambda_i grad g_i + sum_k mu_k (-+ e_k) = 0,   sum_j w_j = 1

with w, lambda, mu >= 0 of the largest numbers of the objective, of limits that are reached, and of
bounds. What is left of the sum, in the least case, is the slope by which the objective can still be
made better.

Source: J. Nocedal, S. J. Wright: Numerical Optimization (2006), Theorem 12.1.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..files.arrays import Array
from .optimize_problem import OptimizeProblem

ACTIVE_ROW = 1e-3
"""of the scale of a number, from which it is as large as it may be"""
SUM_WEIGHT = 30.0
"""of the sum of w against the slopes"""


class Stationarity(NamedTuple):
    """left: the slope that is left; multipliers: of the rows of numbers (m,), 0 of the objective;
    bound: -1 or 1 of parameters at their lower or upper bound, else 0.
    """

    left: float
    multipliers: Array
    bound: NDArray[np.intp]


def stationarity(problem: OptimizeProblem, inner: Array) -> Stationarity:
    """What holds at a point whose run is known."""
    from scipy.optimize import nnls

    numbers, slopes = problem.numbers(inner), problem.slopes(inner)
    assert numbers is not None
    low, high = problem.bounds
    room = ACTIVE_ROW * np.where(np.isfinite(high - low), high - low, 1.0) * 1e-3
    bound = np.where(inner <= low + room, -1, np.where(inner >= high - room, 1, 0))
    is_term, is_equal = problem.is_objective, problem.is_equality
    top = numbers[is_term].max()
    largest = is_term & (numbers >= top - ACTIVE_ROW * (abs(top) or 1.0))
    active = ~is_term & ~is_equal & (numbers >= -ACTIVE_ROW)
    terms, limits, equal = slopes[largest], slopes[active], slopes[is_equal]
    at_bounds = (np.eye(len(inner)) * bound)[bound != 0]
    columns = np.vstack([terms, limits, equal, -equal, at_bounds]).T
    size = float(np.abs(terms).max(initial=0.0)) or 1.0
    weights = np.zeros(columns.shape[1])
    weights[: len(terms)] = SUM_WEIGHT * size
    found, _ = nnls(
        np.vstack([columns, weights]), np.append(np.zeros(len(inner)), SUM_WEIGHT * size)
    )
    found /= found[: len(terms)].sum() or 1.0
    multipliers = np.zeros(len(numbers))
    first = len(terms)
    multipliers[active] = found[first : first + len(limits)]
    first += len(limits)
    ahead, back = found[first : first + len(equal)], found[first + len(equal) :][: len(equal)]
    multipliers[is_equal] = ahead - back
    return Stationarity(float(np.abs(columns @ found).max(initial=0.0)), multipliers, bound)
