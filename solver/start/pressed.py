"""Contacts of surfaces in a search for an equilibrium.

There bodies have static compliances, and a step of the search, which has no velocities, may lead
anywhere: no contact counts as far. The compiled part is step/surface_rest.py.
"""

import numpy as np

from ..step.measure import SUM_ROUNDING
from ..step.records.elastic import Elastic
from ..step.records.scheme import Scheme
from ..step.records.surfaces import Surfaces
from ..step.system import State, System, Workspace

NEGLIGIBLE_PULL = 1e-9
"""over the largest force of a row: a pull that counts as none"""


def follow_loads_at_rest(elastic: Elastic, scheme: Scheme) -> Elastic:
    """Bodies whose modes have no inertia: loads move them by 1 / stiffness within a step."""
    step_stiffness = scheme.beta * scheme.h**2 * elastic.modes.stiffness
    return elastic.replace(modes=elastic.modes.replace(step_stiffness=step_stiffness))


def without_speeds(surfaces: Surfaces) -> Surfaces:
    """Contacts that look at all rows, whose friction has its static coefficient."""
    contacts, ball = surfaces.contacts, surfaces.patches.ball.copy()
    ball[:, 3] = np.inf
    friction = contacts.friction.copy()
    friction[:, 1] = friction[:, 0]
    margin = np.full_like(contacts.margin, np.inf)
    return surfaces.replace(
        patches=surfaces.patches.replace(ball=ball),
        contacts=contacts.replace(margin=margin, friction=friction),
    )


def rounding_of_surfaces(system: System, reach: float, work: Workspace) -> float:
    """The largest force of a contact by the rounding of positions up to `reach` [N]."""
    contacts, largest = system.surfaces.contacts, 0.0
    for m, n in enumerate(contacts.coordinates.tolist()):
        start = contacts.stiffness_start[m]
        stiffness = work.surfaces.stiffness[start : start + n * n].reshape(n, n)
        bodies = slice(contacts.body_range[m], contacts.body_range[m + 1])
        for first in contacts.body_coordinate[bodies].tolist():
            own = np.abs(stiffness[first : first + 3, first : first + 3].diagonal())
            largest = max(largest, float(own.max(initial=0.0)))
    return SUM_ROUNDING * reach * largest


def change_sides(negligible: float, state: State, work: Workspace) -> bool:
    """Let rows that pull open, and those that penetrate close; whether there are any.

    The step of primal-dual active sets, with the motion of the bodies among the unknowns: sets
    that are exact for bodies that are held go in circles where they are free. negligible: a
    depth that counts as none [m].
    """
    n = len(work.surfaces.closed)
    force, gap = state.surfaces.force[:n], state.surfaces.gap[:n]
    closed = work.surfaces.closed > 0
    # Rows that hang by rounding, as at the rim, would open and close in turn.
    pulls = closed & (force < -NEGLIGIBLE_PULL * np.abs(force).max(initial=0.0))
    penetrates = ~closed & (gap < -negligible)
    work.surfaces.closed[:] = (closed & ~pulls) | penetrates
    return bool((pulls | penetrates).any())
