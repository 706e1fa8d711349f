"""Derivatives by central differences, with steps that are tried and errors from their scatter.

    D(r) = (y(p + r s) - y(p - r s)) / (2 r s)          r = 1e-2 .. 1e-6, s: the scale of p

The error of D falls by r^2 until rounding, which grows by 1 / r. The best D is that which differs
least from both its neighbours, and the larger of these differences is its error. Where something
switches within a run, y has a sawtooth, and differences do not fall from one step to the next. They
may agree again below the length of its teeth, on the slope of a tooth: that of the discrete run,
not of the motion. There the widest D is taken, whose error is its difference from the next.

Source: docs/theory.md, Derivatives by differences.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..files.arrays import Array

DIFFERENCE_STEPS = np.array([1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
"""of the scale of a parameter"""
LEAST_FALL = 0.1
"""of differences from one step to the next; they fall by a hundredth where all is smooth"""
ROUNDING_MARGIN = 10.0
"""over the rounding that the shortest step tells"""
LEAST_STEPS = 3


class DifferenceSlopes(NamedTuple):
    """Derivatives (m,), their errors (m,), and whether something switches (m,)."""

    value: Array
    error: Array
    switches: NDArray[np.bool_]


def slopes_of(differences: Array, switching: NDArray[np.bool_] | None = None) -> DifferenceSlopes:
    """The derivatives of m outputs by a parameter.

    differences: D of each step and output (5, m), from the widest step on, without a number where
    a run failed; switching (m,): where something is known to switch.
    """
    known = np.zeros(differences.shape[1], dtype=bool) if switching is None else switching
    columns = zip(differences.T, known.tolist(), strict=True)
    found = np.array([_derivative(*one) for one in columns], dtype=float).reshape(-1, 3)
    return DifferenceSlopes(found[:, 0], found[:, 1], found[:, 2] > 0.0)


def _derivative(column: Array, switches: bool) -> tuple[float, float, float]:
    whole = np.isfinite(column)
    if whole.sum() < LEAST_STEPS:
        return np.nan, np.inf, 0.0
    values, steps = column[whole], DIFFERENCE_STEPS[whole]
    changes = np.abs(np.diff(values))
    # What moves over the widest step alone moves by jumps.
    jumps = values[0] != 0.0 and not values[1:].any()
    if switches or jumps or _switches(changes, steps[1:]):
        return float(values[0]), float(changes[0]), 1.0
    errors = np.maximum(changes[:-1], changes[1:])
    best = int(np.argmin(errors))
    return float(values[1 + best]), float(errors[best]), 0.0


def _switches(changes: Array, steps: Array) -> bool:
    """Whether changes do not fall from one step to a shorter one, by more than rounding."""
    rounding = ROUNDING_MARGIN * changes[-1] * steps[-1] / steps
    allowed = np.maximum(LEAST_FALL * changes[:-2], rounding[1:-1])
    return bool((changes[1:-1] > allowed).any())
