"""Contacts of surfaces in a search for an equilibrium, and the start of a run from one."""

from ..compiler.marks import entry
from .surface_motion import (
    finish_surfaces,
    keep_places,
    keep_start,
    load_modes,
    set_displacements_by_load,
)
from .surface_results import total_surfaces
from .system import State, System, Workspace


@entry
def end_search_step(system: System, state: State, work: Workspace) -> None:
    """Displacements of nodes that the next step of a search for an equilibrium begins with."""
    for s in range(len(system.surfaces.bodies.flexible)):
        set_displacements_by_load(system.surfaces, s, state, work)
    for k in range(len(state.surfaces.u)):
        for x in range(3):
            state.surfaces.u[k, x] = work.surfaces.base[k, x] + work.surfaces.by_load[k, x]
    # Slips count from here, so that rows that stick keep the force that they have.
    keep_places(system, state, work)


@entry
def rest_on_surfaces(system: System, state: State, work: Workspace) -> None:
    """The loads of contacts at the start, which have always acted, move modes and interfaces.

    `system` is that of the search for the equilibrium, and `state` has all other loads.
    """
    modes, out = system.elastic.modes, work.surfaces
    load_modes(system, state, work)
    for s in range(len(system.surfaces.bodies.flexible)):
        e = system.surfaces.bodies.flexible[s]
        for i in range(modes.range[e], modes.range[e + 1]):
            load, way = state.surfaces.modal_load[i], out.modal_step[i]
            # Loads of the contacts find the modes displaced by the other ones.
            stretched = modes.stiffness[i] * state.modes.eta[i]
            state.energies.modal[0] += (stretched + 0.5 * load) * way
            state.modes.eta[i] += way
            out.modal_load_n[i] = load
    keep_start(system, state, work)
    finish_surfaces(system, state, work)
    total_surfaces(system, state, work)
    # The search has static compliances.
    out.W_count[:] = 0
    # Until the first step contacts do not act: what evaluates the start must not move them.
    out.looks[0] = -1
