"""Constant-velocity joints on the branch of their constraint that is none of such a joint.

The branches (`step.watches.wrong_branch`) meet where the shafts point against each other, at 180
degrees, and a motion through there may go on along the wrong one.
"""

from ..arrays import as_index
from ..errors import OutOfRangeError
from ..lower.lower import LoweredModel
from ..step.system import Workspace
from ..step.watches import wrong_branch

BETWEEN_CHECKS = 16
"""steps between checks: a joint must not come back from the wrong branch, or fail there, unseen"""


class Branches:
    """The constant-velocity joints of a model."""

    def __init__(self, lowered: LoweredModel) -> None:
        self._lowered = lowered
        couplings = lowered.system.couplings
        first = couplings.terms.range
        self.rows = as_index(
            [
                row
                for j, coupling in enumerate(lowered.model.couplings)
                if coupling.has_branches
                for row in range(couplings.range[j], couplings.range[j + 1])
                if first[row + 1] > first[row]
            ]
        )

    def most_steps(self, batch: int) -> int:
        """Steps to take before the next check, of a batch."""
        # Checked between calls of the loop: in a long batch a joint might go wrong and come back.
        return min(batch, BETWEEN_CHECKS * self._lowered.ratio) if len(self.rows) else batch

    def check(self, work: Workspace, step: int) -> None:
        """`OutOfRangeError` for a joint that has left the branch on which it started."""
        if not len(self.rows):
            return
        if row := wrong_branch(self._lowered.system.couplings, self.rows, work):
            name = self._lowered.coupling_names[self._lowered.coupling_of(row - 1)]
            reason = (
                f"joint {name!r}: its shafts have passed 180 degrees against each other, where a "
                "constant-velocity joint may turn in two ways: keep them apart by a stop, or take "
                "a universal joint"
            )
            time = step * self._lowered.h
            raise OutOfRangeError(step, time, name, reason, self._lowered.model.path)
