"""The errors of runs whose steps are too long for a contact."""

import numpy as np

from ...results.criteria import CRITERIA
from ..errors import MissedContactError
from ..lower.lower import LoweredModel
from ..step.system import State, Workspace

MOST_CREATED = 0.01
"""share of the energy that contacts of surfaces of fewer steps than the criterion may create"""
PART_OF_SIZE = 0.1
"""way of a ball in a step, over the size of ball and shape, in which it cannot pass unnoticed"""


def check_passages(lowered: LoweredModel, state: State, work: Workspace, taken: int) -> None:
    """`MissedContactError` where a ball or a surface passed through its target in the last step.

    taken: the steps before that.
    """
    if not (passed := int(state.contacts.passed[0])):
        return
    number = taken + 1
    couplings, V = lowered.system.couplings, work.frames.V
    if (c := passed - 1 - len(couplings.contact)) >= 0:
        size = float(lowered.system.surfaces.contacts.size[c])
        raise MissedContactError(
            number,
            number * lowered.h,
            lowered.model.surface_contacts[c].name,
            f"within one step of {lowered.h:.3g} s its surface moves farther past its target than "
            f"{size:.3g} m, the depth from which a point counts as beyond it, and may have passed "
            "through: expected a smaller `contact_step` (or `step`) in [simulation]",
            lowered.model.path,
        )
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
    raise MissedContactError(
        number, number * lowered.h, lowered.coupling_names[j], reason, lowered.model.path
    )


def check_resolution(lowered: LoweredModel, state: State, taken: int) -> None:
    """`MissedContactError` where contacts of surfaces of a few steps each have created energy.

    taken: the steps so far.
    """
    shortest = state.extremes.shortest[len(lowered.system.couplings.contact) :]
    # Force on gaps that close and open within steps has moved the bodies.
    created, moved = float(state.energies.switching[0]), float(state.extremes.moved[0])
    few = np.flatnonzero((shortest > 0) & (shortest < CRITERIA["surface_steps"].limit))
    if not len(few) or not created > MOST_CREATED * moved:
        return
    c = int(few[np.argmin(shortest[few])])
    step = lowered.h * shortest[c] / CRITERIA["surface_steps"].good
    raise MissedContactError(
        taken,
        taken * lowered.h,
        lowered.model.surface_contacts[c].name,
        f"its surfaces touched for {shortest[c]} steps of {lowered.h:.3g} s at the shortest, and "
        f"contacts of surfaces have created {100.0 * created / moved:.2g} % of the energy that "
        f"moves: expected a `contact_step` (or `step`) of {step:.2g} s or less in [simulation]",
        lowered.model.path,
    )
