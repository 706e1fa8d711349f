"""The error of a run in which a ball passed through a shape within one step."""

import numpy as np

from ..errors import MissedContactError
from ..lower.lower import LoweredModel
from ..step.system import State, Workspace

PART_OF_SIZE = 0.1
"""way of a ball in a step, over the size of ball and shape, in which it cannot pass unnoticed"""


def check_passages(lowered: LoweredModel, state: State, work: Workspace, taken: int) -> None:
    """`MissedContactError` where a ball passed through a shape in the last step.

    taken: the steps before that.
    """
    if not (passed := int(state.contacts.passed[0])):
        return
    couplings, V = lowered.system.couplings, work.frames.V
    j = int(couplings.contact[passed - 1])
    row = int(couplings.range[j])
    f, g = int(couplings.rows.frame_a[row]), int(couplings.rows.frame_b[row])
    delta = work.frames.r[g] - work.frames.r[f]
    # Relative to the shape, which may turn: velocity of the ball less that of the carried point.
    speed = float(np.linalg.norm(V[g, :3] - V[f, :3] - np.cross(V[f, 3:], delta)))
    size = float(couplings.rows.size[row])
    # For a plane, of infinite size, at least half of the present step.
    step = min(PART_OF_SIZE * size / speed, 0.5 * lowered.h)
    reason = f"its ball passed through its shape within one step of {lowered.h:.3g} s, at "
    reason += f"{speed:.3g} m/s: "
    if np.isfinite(size):
        reason += f"it moves by {speed * lowered.h:.3g} m there, and both together measure "
        reason += f"{size:.3g} m: "
    reason += f"expected a `contact_step` (or `step`) of {step:.2g} s or less in [simulation]"
    number = taken + 1
    raise MissedContactError(
        number, number * lowered.h, lowered.coupling_names[j], reason, lowered.model.path
    )
