"""A factor in single precision with conjugate gradients in double: half the memory and half the
time of a factor in double precision.
"""

from typing import Any

import numpy as np

from ...superelement.validation import Array
from ..threads import threads
from .factor import Solve
from .gradients import ColumnGradients, Columns, Goal, ratio

MAX_MIXED_STEPS = 12
"""Beyond, the factor is no preconditioner: two or three are taken by bodies of solids."""
MIXED_SHARE_OF_ACCURACY = 0.1  # what is aimed at, for what is left is estimated
COLUMN_MULTIPLE = 16
"""Of solutions, the last filled with zeros: rslab takes a fifth less time for 16 than for 12."""
MIXED_BYTES_RATIO = 0.5  # to a factor in double precision
MIXED_SECONDS_RATIO = 0.55  # to a factor in double precision, with solutions of two steps


class MixedFactor(ColumnGradients):
    """x = solve(b) with S x = b for b (n_u, k), relative in energy to `accuracy`.

    factor: solves with S~, which is S as single precision has it.
    """

    def __init__(self, name: str, n_u: int, product: Solve, factor: Solve, accuracy: float) -> None:
        relative = MIXED_SHARE_OF_ACCURACY * accuracy
        goal = Goal(name, n_u, relative, MAX_MIXED_STEPS, _energy_left)
        super().__init__(Columns(product, factor), goal)

    @property
    def first_error(self) -> float:
        """The largest error that a first step has left, relative in energy."""
        return max(self.first_errors, default=np.inf)

    def once(self, b: Array) -> Array:
        """S~^-1 b, half the work of a solution: right to about `first_error`."""
        return self._system.inverse(b)


def _energy_left(gains: list[Array]) -> Array:
    """The square of the error in energy (k,) that is left.

    The error falls by some four digits a step, eps times the square root of the condition: the gain
    of energy of a step is the square of the error before it, and two of them give the rate, of
    which half the digits count: the first steps gain most.
    """
    if len(gains) < 2:
        return np.full_like(gains[0], np.inf)
    return np.asarray(gains[-1] * np.sqrt(ratio(gains[-1], gains[-2])))


def single_factor(S: Any) -> Solve | None:
    """Solutions with a sparse symmetric matrix as single precision has it, by rslab; None where
    that is not positive definite.
    """
    import rslab

    scale = float(S.diagonal().max())
    single = (S.tocsc() / scale).astype(np.float32)
    single.sort_indices()
    try:
        factor = rslab.analyze(single, path="ldlt", threads=threads()).factor(single)
    except RuntimeError:
        return None
    if any(factor.inertia[1:]):
        return None

    def solve(R: Array) -> Array:
        # Columns of length one: their squares are far from the ends of single precision.
        sizes = np.linalg.norm(R, axis=0)
        unit = np.where(sizes > 0.0, sizes, 1.0)
        n, k = R.shape
        filled = np.zeros((n, -(-k // COLUMN_MULTIPLE) * COLUMN_MULTIPLE), dtype=np.float32)
        np.divide(R, unit, out=filled[:, :k], casting="same_kind")
        found: Array = factor.solve_many(filled)[:, :k].astype(np.float64)
        found *= unit / scale
        return found

    return solve
