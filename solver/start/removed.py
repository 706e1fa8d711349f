"""Redundant constraints that were left out: those that remain must hold them closed."""

from dataclasses import dataclass

import numpy as np

from ..arrays import Array, as_index
from ..errors import ModelError, about
from ..lower.lower import LoweredModel
from ..step.rows import evaluate_row
from ..step.system import Workspace
from ..step.watches import open_row
from .redundancy import describe_rows

# relative to the size of the model, or rad
MAX_REMOVED_OPENING = 1e-6


@dataclass(frozen=True, eq=False)
class RemovedRows:
    """Rows of a model with all its constraints that its time loop does without.

    lowered: with all rows, whose frames have the numbers of those in the loop.
    """

    lowered: LoweredModel
    rows: list[int]

    @property
    def names(self) -> str:
        """The rows by joint, as messages name them."""
        return describe_rows(self.lowered, self.rows)

    @property
    def limits(self) -> Array:
        """The openings that they may have [m, rad]."""
        lengths = self.lowered.measures_lengths[self.rows]
        return MAX_REMOVED_OPENING * np.where(lengths, self.lowered.system.bodies.size, 1.0)

    def check(self, work: Workspace, time: float) -> None:
        """ModelError for a constraint that is open at a time [s]."""
        if not self.rows:
            return
        rows, gradient = self.lowered.system.couplings.rows, np.zeros(12)
        if found := open_row(rows, as_index(self.rows), self.limits, gradient, work):
            i = self.rows[found - 1]
            opening = abs(evaluate_row(rows, i, 0.0, 0.0, work, gradient))
            unit = "m" if self.lowered.measures_lengths[i] else "rad"
            with about(self.lowered.model.path):
                raise ModelError(
                    f"joints: {describe_rows(self.lowered, [i])} was left out as redundant, but is "
                    f"open by {opening:.6g} {unit} at t = {time:.9g} s: it is needed there; free a "
                    "joint instead of redundant = 'remove'"
                )
