"""Contacts that are closed before anything has moved."""

from collections.abc import Iterator

import numpy as np

from ..couplings.contacts import DEEPEST_START
from ..lower.lower import LoweredModel
from ..step.contacts import penetration_of
from ..step.surfaces import measure_surfaces
from ..step.system import State, Workspace

# over the size of the model, or in rad: more than rounding
NOTICEABLE_PENETRATION = 1e-9
# net force on a body over that of its contact: below, other forces hold the contact closed
MAX_IMBALANCE = 0.1


def check_depths(lowered: LoweredModel, work: Workspace) -> None:
    """`ModelError` for a ball that is deeper than its radius, or than a tenth of the model.

    The coordinates in `work` are those of the start.
    """
    size = float(lowered.system.bodies.size)
    for j, depth in _closed(lowered, work):
        lowered.model.couplings[j].check_depth(depth, size)


def check_depths_of_surfaces(lowered: LoweredModel, state: State, work: Workspace) -> Iterator[str]:
    """A line for each contact of surfaces that starts closed; `ModelError` for a deep one."""
    if not lowered.model.surface_contacts:
        return
    measure_surfaces(lowered.system, state, work)
    surfaces, gaps = lowered.system.surfaces, state.surfaces.gap
    size, rows = float(lowered.system.bodies.size), surfaces.contacts.row
    for c, contact in enumerate(lowered.model.surface_contacts):
        own = gaps[rows[c] : rows[c + 1]]
        depth = float(-own[np.isfinite(own)].min(initial=0.0))
        if depth <= NOTICEABLE_PENETRATION * size:
            continue
        radius = float(surfaces.patches.radius[surfaces.contacts.patch[c]])
        if depth > DEEPEST_START * radius:
            raise contact.error(
                f"starts {depth:.6g} m deep: expected at most a tenth of the radius of its "
                f"surface, {DEEPEST_START * radius:.6g}"
            )
        yield f"{contact.owner}: starts {depth:.6g} m deep"


def penetrations(lowered: LoweredModel, state: State, work: Workspace) -> Iterator[str]:
    """A line for each contact and stop that starts closed and drives its bodies apart.

    Not for one that weight or other forces hold closed, as at its static depth. The accelerations
    in `state` are those of the start.
    """
    for j, depth in _closed(lowered, work):
        if not _is_held(lowered, j, state):
            length = lowered.measures_lengths[lowered.system.couplings.range[j]]
            owner = lowered.model.couplings[j].owner
            yield f"{owner}: starts {depth:.6g} {'m' if length else 'rad'} deep"


def _closed(lowered: LoweredModel, work: Workspace) -> list[tuple[int, float]]:
    """The couplings that are contacts or stops and start closed, with their depths."""
    couplings, size = lowered.system.couplings, float(lowered.system.bodies.size)
    found = []
    for j in couplings.contact.tolist():
        row = couplings.range[j]
        length = bool(lowered.measures_lengths[row])
        depth, _ = penetration_of(couplings, row, float(work.couplings.coordinate[row]))
        if depth > NOTICEABLE_PENETRATION * (size if length else 1.0):
            found.append((j, depth))
    return found


def _is_held(lowered: LoweredModel, j: int, state: State) -> bool:
    """Whether the bodies of contact j are accelerated no more than gravity alone would, or by no
    more than a tenth of what the contact alone would.
    """
    system = lowered.system
    row = int(system.couplings.range[j])
    force, fall = abs(float(state.couplings.lam[row])), float(np.linalg.norm(system.bodies.gravity))
    for f in (system.couplings.rows.frame_a[row], system.couplings.rows.frame_b[row]):
        b = int(system.frames.body[f])
        if b < 0:
            continue
        reach = max(
            float(np.linalg.norm(system.frames.X[f])), NOTICEABLE_PENETRATION * system.bodies.size
        )
        linear, angular = np.linalg.norm(state.bodies.v_dot[b].reshape(2, 3), axis=1)
        by_contact = force / float(system.bodies.mass[b])
        if linear + reach * angular > max(fall, MAX_IMBALANCE * by_contact):
            return False
    return True
