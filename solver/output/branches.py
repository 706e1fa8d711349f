"""Constant-velocity joints on the branch of their constraint that is none of such a joint.

The constraint e1(A) e2(B) = e2(A) e1(B) holds where one frame is not twisted about the shaft of the
other, q_3 = 0, and as well where it is turned by half a turn about any axis, q_0 = 0, with the
quaternion q of B seen from A, for the difference is -4 q_0 q_3. The branches meet where the shafts
point against each other, at 180 degrees, and a motion through there may go on along the wrong one.
"""

import numpy as np

from ..arrays import Array
from ..errors import OutOfRangeError
from ..lower.lower import LoweredModel
from ..step.system import Workspace

BETWEEN_CHECKS = 16
"""steps between checks: a joint must not come back from the wrong branch, or fail there, unseen"""
# of q_3^2: below, both branches are the same to rounding
MIN_BRANCH_MEASURE = 1e-6


class Branches:
    """The constant-velocity joints of a model."""

    def __init__(self, lowered: LoweredModel) -> None:
        self._lowered = lowered
        couplings = lowered.system.couplings
        first = couplings.terms.range
        self._rows = [
            row
            for j, coupling in enumerate(lowered.model.couplings)
            if coupling.has_branches
            for row in range(couplings.range[j], couplings.range[j + 1])
            if first[row + 1] > first[row]
        ]

    def most_steps(self, batch: int) -> int:
        """Steps to take before the next check, of a batch."""
        # Checked between calls of the loop: in a long batch a joint might go wrong and come back.
        return min(batch, BETWEEN_CHECKS * self._lowered.ratio) if self._rows else batch

    def check(self, work: Workspace, step: int) -> None:
        """`OutOfRangeError` for a joint that has left the branch on which it started."""
        for row in self._rows:
            q_0, q_3 = self._squares(row, work)
            # q_0^2 + q_3^2 = (1 + cos bend) / 2: at 180 degrees both vanish, and neither branch is
            # right.
            if q_3 > max(q_0, MIN_BRANCH_MEASURE):
                name = self._lowered.coupling_names[self._lowered.coupling_of(row)]
                reason = (
                    f"joint {name!r}: its shafts have passed 180 degrees against each other, "
                    "where a constant-velocity joint may turn in two ways: keep them apart by a "
                    "stop, or take a universal joint"
                )
                time = step * self._lowered.h
                raise OutOfRangeError(step, time, name, reason, self._lowered.model.path)

    def _squares(self, row: int, work: Workspace) -> tuple[float, float]:
        """q_0^2 and q_3^2 of the relative rotation of a joint, by one of its rows."""
        rows, terms = self._lowered.system.couplings.rows, self._lowered.system.couplings.terms
        term = terms.range[row]
        e_A = _axes(rows.a[row], terms.rows.a[term])
        e_B = _axes(terms.rows.b[term], rows.b[row])
        D = work.frames.D
        R = (D[rows.frame_a[row]] @ e_A).T @ (D[rows.frame_b[row]] @ e_B)
        # The squares of a quaternion by its rotation matrix.
        return 0.25 * (1.0 + np.trace(R)), 0.25 * (1.0 + R[2, 2] - R[0, 0] - R[1, 1])


def _axes(e1: Array, e2: Array) -> Array:
    return np.column_stack([e1, e2, np.cross(e1, e2)])
