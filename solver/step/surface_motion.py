"""How the nodes of surfaces move, and what forces on them do to modes and dofs of their bodies.

    u_C = phi eta + T (u - history) + G f + B s

phi eta: free motion of the modes; u: displacements of the active dofs; f: forces of contacts; s:
amplitudes of load patterns. The forces load the modes by phi^T f and the active dofs as loads T^T f
would (records/surfaces.py). Source:
docs/theory.md, Contact of surfaces.
"""

import math

from ..arrays import Array
from ..compiler.marks import compiled, of_surfaces
from ..compiler.memory import copy
from .frames import move_frames
from .planes import place_nodes
from .records.surfaces import Surfaces
from .second_order import active_curvature
from .surface_second import node_curvature, set_node_slopes
from .system import State, System, Workspace
from .vectors import Vector, add_to_row, inner, rotate, row


@of_surfaces
@compiled
def keep_start(system: System, state: State, work: Workspace) -> None:
    """Modal coordinates, forces and gaps at the start of a step, from which works are counted."""
    n = len(work.surfaces.closed)
    if n:
        copy(state.modes.eta, work.surfaces.eta_n)
        copy(state.surfaces.force, work.surfaces.force_n)
        copy(state.surfaces.gap[:n], work.surfaces.gap_n)


@of_surfaces
@compiled
def keep_places(system: System, state: State, work: Workspace) -> None:
    """The nodes of contacts with friction at the start of a step, from where slips are counted."""
    surfaces, out = system.surfaces, work.surfaces
    contacts, patches = surfaces.contacts, surfaces.patches
    if len(out.start) == 0:
        return
    move_frames(system.frames, system.frames.n_acting, state, work)
    for s in range(len(surfaces.bodies.flexible)):
        if not out.awake[s]:
            # Nothing presses a body that sleeps: its modes alone move it.
            move_freely(system, s, state, work)
            continue
        for k in range(surfaces.bodies.node[s], surfaces.bodies.node[s + 1]):
            for x in range(3):
                out.base[k, x], out.by_load[k, x] = state.surfaces.u[k, x], 0.0
    for c in range(len(contacts.patch)):
        if contacts.slip_row[c] < 0:
            continue
        place_nodes(system, c, state, work)
        z, p, t = contacts.start[c], contacts.patch[c], contacts.target[c]
        _copy_places(patches.node[p], patches.node[p + 1], z, work)
        if t >= 0:
            z += patches.node[p + 1] - patches.node[p]
            _copy_places(patches.node[t], patches.node[t + 1], z, work)


@compiled
def _copy_places(begin: int, end: int, z: int, work: Workspace) -> None:
    """Positions of nodes from one to another go to those of the start of the step."""
    for k in range(begin, end):
        for x in range(3):
            work.surfaces.start[z + k - begin, x] = work.surfaces.place[k, x]


@of_surfaces
@compiled
def load_surface_bodies(system: System, state: State, work: Workspace) -> None:
    """Forces of contacts on the rigid motion of the bodies of patches, and on their active dofs."""
    surfaces, out, elastic = system.surfaces, work.surfaces, system.elastic
    if len(surfaces.contacts.patch) == 0 or out.looks[0] < 0:
        return
    out.interface_load[:] = 0.0
    for s in range(len(surfaces.bodies.flexible)):
        if not out.awake[s]:
            continue
        b = elastic.body[surfaces.bodies.flexible[s]]
        # `push` is in body axes; of bodies only the moments are, their forces are in space.
        force = out.push[s, 0], out.push[s, 1], out.push[s, 2]
        add_to_row(work.bodies.force, b, 0, rotate(state.bodies.R, b, force))
        add_to_row(work.bodies.force, b, 3, (out.push[s, 3], out.push[s, 4], out.push[s, 5]))
        for k in range(surfaces.bodies.node[s], surfaces.bodies.node[s + 1]):
            f = row(state.surfaces.load, k)
            if f[0] != 0.0 or f[1] != 0.0 or f[2] != 0.0:
                _add_interface_load(system, s, k, f, work)


@of_surfaces
@compiled
def load_modes(system: System, state: State, work: Workspace) -> None:
    """Loads of contacts on the modes, phi^T f, and the displacements of all dofs by them."""
    surfaces, elastic, scheme = system.surfaces, system.elastic, system.scheme
    modes, out = elastic.modes, work.surfaces
    for s in range(len(surfaces.bodies.flexible)):
        e = surfaces.bodies.flexible[s]
        begin, end = modes.range[e], modes.range[e + 1]
        m = end - begin
        load = state.surfaces.modal_load[begin:end]
        copy(load, out.modal_load_n[begin:end])
        load[:] = 0.0
        out.modal_step[begin:end] = 0.0
        if not _load_sources(surfaces, s, state, work):
            continue
        first = surfaces.bodies.source_range[s]
        for i in range(m):
            share = surfaces.bodies.share[begin + i]
            load[i] = share * out.source_load[first + surfaces.bodies.source[begin + i]]
            work.modes.load[begin + i] += load[i]
            step = scheme.beta * scheme.h * scheme.h / modes.step_stiffness[begin + i]
            out.modal_step[begin + i] = step * load[i]
        for k in range(elastic.dof[e], elastic.dof[e + 1]):
            place = modes.phi_start[e] + (k - elastic.dof[e]) * m
            change = inner(modes.phi[place : place + m], out.modal_step[begin:end])
            state.interfaces.u[k] += change


@compiled
def _load_sources(surfaces: Surfaces, s: int, state: State, work: Workspace) -> bool:
    """phi^T f of the modes of the file of body s; whether any of its nodes is loaded."""
    bodies, loaded = surfaces.bodies, False
    begin, end = bodies.source_range[s], bodies.source_range[s + 1]
    load, m, first = work.surfaces.source_load[begin:end], end - begin, bodies.node[s]
    load[:] = 0.0
    for k in range(first, bodies.node[s + 1]):
        for x in range(3):
            f = state.surfaces.load[k, x]
            if f != 0.0:
                loaded = True
                place = bodies.phi_start[s] + (3 * (k - first) + x) * m
                phi = bodies.phi[place : place + m]
                for i in range(m):
                    load[i] += phi[i] * f
    return loaded


@of_surfaces
@compiled
def finish_surfaces(system: System, state: State, work: Workspace) -> None:
    """Displacements of nodes at the end of a step, and the work of contacts on the modes.

    With the mean load over the step, as of interfaces; and the energy of the residual flexibility,
    1/2 f . F f, and of layers, 1/2 P^2 layer / A.
    """
    surfaces, modes, out = system.surfaces, system.elastic.modes, work.surfaces
    total = _count_work_of_rows(surfaces, state, work)
    for s in range(len(surfaces.bodies.flexible)):
        e = surfaces.bodies.flexible[s]
        if out.awake[s]:
            # So far that of the nodes of candidates alone is known.
            set_displacements_by_load(surfaces, s, state, work)
        for i in range(modes.range[e], modes.range[e + 1]):
            mean = 0.5 * (state.surfaces.modal_load[i] + out.modal_load_n[i])
            state.energies.modal[0] += mean * (state.modes.eta[i] - out.eta_n[i])
            # Displacements by loads contain those of modes, whose energy is counted with the modes.
            total -= out.modal_step[i] * state.surfaces.modal_load[i]
        if not out.awake[s]:
            continue
        for k in range(surfaces.bodies.node[s], surfaces.bodies.node[s + 1]):
            for x in range(3):
                state.surfaces.u[k, x] = out.base[k, x] + out.by_load[k, x]
                f = state.surfaces.load[k, x]
                if f != 0.0:
                    total += f * (out.by_load[k, x] + _by_interface_load(system, s, k, x, work))
    state.energies.residual[0] = 0.5 * total
    for i in range(len(out.closed), len(state.surfaces.force)):
        if state.surfaces.force[i] != 0.0:  # of a slip
            force, slip = state.surfaces.force[i], state.surfaces.gap[i]
            state.energies.friction[0] -= force * slip
            # Time stepping moves by the mean force of the step.
            state.energies.switching[0] += 0.5 * (out.force_n[i] - force) * slip


@compiled
def _count_work_of_rows(surfaces: Surfaces, state: State, work: Workspace) -> float:
    """Count the work of normal forces on gaps; twice the energy of layers.

    Exact contacts do none: a row that is closed has no way, an open one no force. Where one closes
    or opens within a step, the mean force of the step moves its gap, as time stepping alone does.
    """
    contacts, out, twice = surfaces.contacts, work.surfaces, 0.0
    for c in range(len(contacts.patch)):
        for i in range(contacts.row[c], contacts.row[c + 1]):
            force = state.surfaces.force[i]
            if force == 0.0 and out.force_n[i] == 0.0:
                continue
            way = state.surfaces.gap[i] - out.gap_n[i]
            # Of a row that was or is not covered no way is known.
            if not math.isnan(way):
                state.energies.switching[0] += 0.5 * (force + out.force_n[i]) * way
            if force > 0.0:
                twice += force * force * layer_compliance(surfaces, c, i, work)
    return twice


@compiled
def layer_compliance(surfaces: Surfaces, c: int, i: int, work: Workspace) -> float:
    """The compliance of the layer at row i of contact c [m/N]."""
    if i >= len(work.surfaces.area):
        return 0.0  # of a slip
    return float(surfaces.contacts.layer[c] / work.surfaces.area[i])


@compiled
def wake(system: System, s: int, state: State, work: Workspace) -> None:
    """Displacements of the nodes of a body by the free motion of its modes, phi eta."""
    bodies = system.surfaces.bodies
    if work.surfaces.awake[s]:
        return
    # In flight nothing of this is computed: a surface that is far costs a distance.
    work.surfaces.awake[s] = 1
    add_up_modes(system, s, state, work)
    for k in range(bodies.node[s], bodies.node[s + 1]):
        for x in range(3):
            work.surfaces.free[k, x] = _by_modes(system, s, k, x, work)


@compiled
def move_freely(system: System, s: int, state: State, work: Workspace) -> None:
    """Displacements of the nodes of a body by its modes alone."""
    bodies, out = system.surfaces.bodies, work.surfaces
    add_up_modes(system, s, state, work)
    set_node_slopes(system, s, state, work)
    for k in range(bodies.node[s], bodies.node[s + 1]):
        for x in range(3):
            by_bending = node_curvature(system, s, k, x, state, work)
            out.base[k, x] = _by_modes(system, s, k, x, work) + by_bending
            out.by_load[k, x] = 0.0


@compiled
def add_up_modes(system: System, s: int, state: State, work: Workspace) -> None:
    """Coordinates of the modes of body s: the sums of those of their shares."""
    bodies, modes = system.surfaces.bodies, system.elastic.modes
    e, first = bodies.flexible[s], bodies.source_range[s]
    for j in range(first, bodies.source_range[s + 1]):
        work.surfaces.source[j] = 0.0
    for i in range(modes.range[e], modes.range[e + 1]):
        work.surfaces.source[first + bodies.source[i]] += bodies.share[i] * state.modes.eta[i]


@compiled
def _by_modes(system: System, s: int, k: int, x: int, work: Workspace) -> float:
    """phi eta of node k of body s along axis x; see `add_up_modes`."""
    bodies = system.surfaces.bodies
    begin, end = bodies.source_range[s], bodies.source_range[s + 1]
    place = bodies.phi_start[s] + (3 * (k - bodies.node[s]) + x) * (end - begin)
    return inner(bodies.phi[place : place + end - begin], work.surfaces.source[begin:end])


@compiled
def set_base(system: System, s: int, state: State, work: Workspace) -> None:
    """Displacements without forces of contacts: phi eta + T (u - history) + B s."""
    bodies, elastic, out = system.surfaces.bodies, system.elastic, work.surfaces
    e, first = bodies.flexible[s], bodies.node[s]
    begin, end = elastic.active_range[e], elastic.active_range[e + 1]
    n_a, u = end - begin, state.interfaces.u
    change = out.change[:n_a]
    set_node_slopes(system, s, state, work)
    for i in range(begin, end):
        z = elastic.active[i]
        # What bending adds to u is no displacement by loads, which T is for.
        by_loads = u[z] - work.interfaces.history[z]
        change[i - begin] = by_loads - active_curvature(elastic, e, i, u, work)
    for k in range(first, bodies.node[s + 1]):
        for x in range(3):
            place = bodies.T_start[s] + (3 * (k - first) + x) * n_a
            moved = out.free[k, x] + inner(bodies.T[place : place + n_a], change)
            out.base[k, x] = moved + node_curvature(system, s, k, x, state, work)
    _add_spread_loads(system, s, work)


@compiled
def _add_spread_loads(system: System, s: int, work: Workspace) -> None:
    """base += B s of body s: what its load patterns do within the step."""
    bodies, patterns, out = system.surfaces.bodies, system.patterns, work.surfaces
    b, first = system.elastic.body[bodies.flexible[s]], bodies.node[s]
    for t in range(len(patterns.body)):
        if patterns.body[t] != b:
            continue
        amplitude = work.loads.value[patterns.signal[t]]
        for k in range(first, bodies.node[s + 1]):
            for x in range(3):
                place = bodies.spread_start[t] + 3 * (k - first) + x
                out.base[k, x] += bodies.spread[place] * amplitude


@compiled
def set_displacements_by_load(surfaces: Surfaces, s: int, state: State, work: Workspace) -> None:
    """G f of the nodes of a body."""
    bodies, out = surfaces.bodies, work.surfaces
    first, last = bodies.node[s], bodies.node[s + 1]
    width_of_G = 3 * (last - first)
    column = out.column[:width_of_G]
    column[:] = 0.0
    for k in range(first, last):
        for x in range(3):
            f = state.surfaces.load[k, x]
            if f != 0.0:
                place = bodies.G_start[s] + (3 * (k - first) + x) * width_of_G
                G = bodies.G[place : place + width_of_G]  # a row, for G is symmetric
                for i in range(width_of_G):
                    column[i] += f * G[i]
    for k in range(first, last):
        for x in range(3):
            out.by_load[k, x] = column[3 * (k - first) + x]


@compiled
def list_loaded(surfaces: Surfaces, s: int, state: State, work: Workspace) -> int:
    """The dofs of nodes of a body that carry loads, in `loaded`: how many there are."""
    bodies, count = surfaces.bodies, 0
    first = bodies.node[s]
    for k in range(first, bodies.node[s + 1]):
        for x in range(3):
            if state.surfaces.load[k, x] != 0.0:
                work.surfaces.loaded[count] = 3 * (k - first) + x
                count += 1
    return count


@compiled
def set_displacement_by_load(
    surfaces: Surfaces, s: int, k: int, count: int, state: State, work: Workspace
) -> None:
    """G f of node k of body s alone, whose loaded dofs are in `loaded`."""
    bodies, first = surfaces.bodies, surfaces.bodies.node[s]
    width_of_G = 3 * (bodies.node[s + 1] - first)
    for x in range(3):
        total = 0.0
        start = bodies.G_start[s] + (3 * (k - first) + x) * width_of_G
        for i in range(count):
            z = work.surfaces.loaded[i]
            total += state.surfaces.load[first + z // 3, z % 3] * bodies.G[start + z]
        work.surfaces.by_load[k, x] = total


@compiled
def add_by_interfaces(system: System, s: int, k: int, b: Vector, first: int, D: Array) -> None:
    """D += T^T b of node k of body s, from place `first` on."""
    bodies, elastic = system.surfaces.bodies, system.elastic
    e = bodies.flexible[s]
    n_a = elastic.active_range[e + 1] - elastic.active_range[e]
    for x in range(3):
        start = bodies.T_start[s] + (3 * (k - bodies.node[s]) + x) * n_a
        for i in range(n_a):
            D[first + i] += b[x] * bodies.T[start + i]


@compiled
def _add_interface_load(system: System, s: int, k: int, f: Vector, work: Workspace) -> None:
    """interface_load += T^T f of node k of body s."""
    begin = system.elastic.active_range[system.surfaces.bodies.flexible[s]]
    add_by_interfaces(system, s, k, f, begin, work.surfaces.interface_load)


@compiled
def _by_interface_load(system: System, s: int, k: int, x: int, work: Workspace) -> float:
    """The displacement T G_JJ T^T f of node k along axis x."""
    bodies, elastic, out = system.surfaces.bodies, system.elastic, work.surfaces
    e = bodies.flexible[s]
    begin, n_a = elastic.active_range[e], elastic.active_range[e + 1] - elastic.active_range[e]
    start = bodies.T_start[s] + (3 * (k - bodies.node[s]) + x) * n_a
    total = 0.0
    for i in range(n_a):
        place = elastic.G_active_start[e] + i * n_a
        G = elastic.G_active[place : place + n_a]
        total += bodies.T[start + i] * inner(G, out.interface_load[begin : begin + n_a])
    return total
