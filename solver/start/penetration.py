"""Contacts that are closed before anything has moved."""

from collections.abc import Iterator

from ..lower.lower import LoweredModel
from ..model.contacts import Contact
from ..step.contacts import penetration_of
from ..step.system import Workspace

DEEPEST = 0.1
"""penetration over the size of the model at which a run does not start"""
NOTICEABLE = 1e-9
"""penetration over the size of the model, or angle, that is not of rounding"""


def penetrations(lowered: LoweredModel, work: Workspace) -> Iterator[str]:
    """A line for each contact and stop that starts closed, with its depth.

    `ModelError` for a ball that is deeper than its radius, or than a tenth of the model. The
    coordinates in `work` are those of the start.
    """
    couplings, size = lowered.system.couplings, float(lowered.system.bodies.size)
    for j in couplings.contact.tolist():
        row, coupling = couplings.range[j], lowered.model.couplings[j]
        length = bool(lowered.measures_lengths[row])
        depth, _ = penetration_of(couplings, row, float(work.couplings.coordinate[row]))
        if depth <= NOTICEABLE * (size if length else 1.0):
            continue
        if isinstance(coupling, Contact):
            _check(coupling, depth, size)
        yield f"{coupling.owner}: starts {depth:.6g} {'m' if length else 'rad'} deep"


def _check(contact: Contact, depth: float, size: float) -> None:
    limits = {"a tenth of the size of the model": DEEPEST * size}
    if contact.ball > 0.0:
        limits["the radius of its ball"] = contact.ball
    for name, limit in limits.items():
        if depth > limit:
            raise contact.error(f"starts {depth:.6g} m deep: expected at most {name}, {limit:.6g}")
