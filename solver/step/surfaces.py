"""Contacts of surfaces of flexible bodies: exact unilateral constraints at their nodes.

The gap of a row is a mean of that of the points around its node (facing.py):

    y_i = 1/A_i sum_q w_q psi_i(q) n_q . (x_q - c_q),    0 <= P_i  _|_  y_i + P_i layer/A_i >= 0
    x_k = x + R (X_k + u_k),    u_C = phi eta + T (u - history) + G f,    f = R^T sum_i P_i b_i

with b_ik = d y_i / d x_k. The residual flexibility in G makes the forces an algebraic function of
the motion, P(xi), which is solved for at each iterate of Newton's method; there the contact acts as
a spring of the stiffness D^T W^-1 D, with D = dy/dxi and W = b G b^T of the closed rows. Tangent
planes are laid at the first two iterates of a step, then they move with their target, so that
Newton's method converges. Source: docs/theory.md, Contact of surfaces.
"""

import math

from ..arrays import Array
from ..compiler.marks import compiled, entry
from ..compiler.memory import copy
from .complementarity import solve_closed, solve_complementarity
from .cone import by_law, factorize_law, solve_cone, substitute_law
from .facing import (
    deformed,
    distance_from_shape,
    face_slips,
    face_target,
    look_at_target,
    place_nodes,
    set_row_gaps,
    slip_row,
    support_of,
    target_axes,
    target_origin,
)
from .frames import coordinate, move_frames, pull_back, width
from .records.surfaces import Surfaces
from .system import State, System, Workspace
from .vectors import (
    Vector,
    add,
    add_to_row,
    cross,
    dot,
    inner,
    rotate,
    rotate_back,
    row,
    scale,
    subtract,
)

LOOKS_PER_STEP = 2
"""iterates of a step at which tangent planes are laid"""
STEPS_OF_APPROACH = 3.0
"""steps ahead in which a patch that may meet its target is followed"""
MAX_TURN = 1e-4
"""change of a gradient with which an old W still serves: corrections shrink by as much"""


@compiled
def await_contacts(system: System, work: Workspace) -> None:
    """The beginning of a step, or of a new search for its end: no plane is known yet."""
    if len(system.surfaces.contacts.patch):
        work.surfaces.looks[0] = 0
        work.surfaces.awake[:] = 0


@compiled
def keep_modes(system: System, state: State, work: Workspace) -> None:
    """The modal coordinates at the start of a step, from which the work of contacts is counted."""
    if len(system.surfaces.contacts.patch):
        copy(state.modes.eta, work.surfaces.eta_n)


@compiled
def keep_places(system: System, state: State, work: Workspace) -> None:
    """The nodes of contacts with friction at the start of a step, from where slips are counted."""
    surfaces, out = system.surfaces, work.surfaces
    contacts, patches, modes = surfaces.contacts, surfaces.patches, system.elastic.modes
    if len(out.start) == 0:
        return
    move_frames(system.frames, system.frames.n_acting, state, work)
    for s in range(len(surfaces.bodies.flexible)):
        e, first = surfaces.bodies.flexible[s], surfaces.bodies.node[s]
        begin, end = modes.range[e], modes.range[e + 1]
        m = end - begin
        for k in range(first, surfaces.bodies.node[s + 1]):
            for x in range(3):
                out.by_load[k, x] = 0.0
                if out.awake[s]:
                    out.base[k, x] = state.surfaces.u[k, x]
                else:
                    place = surfaces.bodies.phi_start[s] + (3 * (k - first) + x) * m
                    phi = surfaces.bodies.phi[place : place + m]
                    out.base[k, x] = inner(phi, state.modes.eta[begin:end])
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


@compiled
def press_surfaces(system: System, state: State, work: Workspace) -> None:
    """Solve for the forces of all contacts at the present motion; those on frames load them."""
    contacts, out = system.surfaces.contacts, work.surfaces
    if len(contacts.patch) == 0 or out.looks[0] < 0:
        return
    if out.looks[0] == 0:
        _find_near(system, state, work)
    for s in range(len(system.surfaces.bodies.flexible)):
        if out.awake[s]:
            _set_base(system, s, state, work)
            # Later iterates have them from the forces of the iterate before.
            if out.looks[0] == 0:
                _set_displacements_by_load(system.surfaces, s, state, work)
    out.push[:] = 0.0
    for m in range(len(contacts.island_range) - 1):
        _press_island(system, m, state, work)
    out.looks[0] += 1


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


@compiled
def add_surface_tangents(system: System, work: Workspace) -> None:
    """K -= D^T W^-1 D: the contacts as springs between the bodies of their islands."""
    contacts, out = system.surfaces.contacts, work.surfaces
    if len(contacts.patch) == 0 or out.looks[0] < 0:
        return
    blocks = system.pattern.island_block
    # Noted with the matrix: later switches are judged against what it contains.
    for i in range(len(out.closed)):
        out.closed_in_matrix[i] = out.closed[i]
    for m in range(len(contacts.island_range) - 1):
        first = contacts.body_range[m]
        n = contacts.coordinates[m]
        for p in range(contacts.block_range[m], contacts.block_range[m + 1]):
            i, k = first + blocks[p, 0], first + blocks[p, 1]
            start, stride = blocks[p, 2], blocks[p, 3]
            rows, columns = contacts.body_coordinate[i], contacts.body_coordinate[k]
            for a in range(contacts.body_width[i]):
                source = contacts.stiffness_start[m] + (rows + a) * n + columns
                for b in range(contacts.body_width[k]):
                    work.matrix.S[start + a * stride + b] -= out.stiffness[source + b]


@compiled
def have_surfaces_switched(work: Workspace) -> bool:
    """Whether a row has closed or opened since the matrix was made."""
    changed = 0
    for i in range(len(work.surfaces.closed)):
        changed += abs(work.surfaces.closed[i] - work.surfaces.closed_in_matrix[i])
    return changed > 0


@compiled
def are_surfaces_closed(work: Workspace) -> bool:
    """Whether any row is."""
    total = 0
    for i in range(len(work.surfaces.closed)):
        total += work.surfaces.closed[i]
    return total > 0


@compiled
def approach_surfaces(system: System, h: float, state: State, work: Workspace) -> bool:
    """Whether a patch may meet its target after a time h."""
    for c in range(len(system.surfaces.contacts.patch)):
        if _is_near(system, c, h, state, work):
            return True
    return False


@compiled
def add_surface_scales(system: System, state: State, work: Workspace) -> None:
    """The forces of rows, each by itself, join the force scales of the bodies."""
    contacts, patches = system.surfaces.contacts, system.surfaces.patches
    for c in range(len(contacts.patch)):
        # Contacts only push: the sum of their forces is that of the magnitudes.
        total = 0.0
        for i in range(contacts.row[c], contacts.row[c + 1]):
            total += state.surfaces.force[i]
        if total == 0.0:
            continue
        p, f = contacts.patch[c], contacts.frame[c]
        b = patches.body[p]
        other = system.frames.body[f] if f >= 0 else patches.body[contacts.target[c]]
        place = rotate(state.bodies.R, b, row(patches.center, p))
        _add_scale(b, total, _length(place) + patches.radius[p], work)
        if other >= 0:
            apart = subtract(add(row(state.bodies.x, b), place), row(state.bodies.x, other))
            _add_scale(other, total, _length(apart) + patches.radius[p], work)


@compiled
def _add_scale(b: int, force: float, arm: float, work: Workspace) -> None:
    work.bodies.force_scale[b, 0] += force
    work.bodies.force_scale[b, 1] += force * arm


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
        first, start = surfaces.bodies.node[s], surfaces.bodies.phi_start[s]
        loaded = False
        for k in range(first, surfaces.bodies.node[s + 1]):
            for x in range(3):
                f = state.surfaces.load[k, x]
                if f != 0.0:
                    loaded = True
                    place = start + (3 * (k - first) + x) * m
                    phi = surfaces.bodies.phi[place : place + m]
                    for i in range(m):
                        load[i] += phi[i] * f
        if not loaded:
            continue
        for i in range(m):
            work.modes.load[begin + i] += load[i]
            step = scheme.beta * scheme.h * scheme.h / modes.step_stiffness[begin + i]
            out.modal_step[begin + i] = step * load[i]
        for k in range(elastic.dof[e], elastic.dof[e + 1]):
            place = modes.phi_start[e] + (k - elastic.dof[e]) * m
            change = inner(modes.phi[place : place + m], out.modal_step[begin:end])
            state.interfaces.u[k] += change


@compiled
def finish_surfaces(system: System, state: State, work: Workspace) -> None:
    """Displacements of nodes at the end of a step, and the work of contacts on the modes.

    With the mean load over the step, as of interfaces; and the energy of the residual flexibility,
    1/2 f . F f.
    """
    surfaces, modes, out = system.surfaces, system.elastic.modes, work.surfaces
    total = 0.0
    for s in range(len(surfaces.bodies.flexible)):
        e = surfaces.bodies.flexible[s]
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
            state.energies.friction[0] -= state.surfaces.force[i] * state.surfaces.gap[i]


@entry
def measure_surfaces(system: System, state: State, work: Workspace) -> None:
    """The gaps of all rows before any of them acts: their bodies are where frames and modes say."""
    surfaces, out = system.surfaces, work.surfaces
    for s in range(len(surfaces.bodies.flexible)):
        _wake(system, s, state, work)
        for k in range(surfaces.bodies.node[s], surfaces.bodies.node[s + 1]):
            for x in range(3):
                out.base[k, x], out.by_load[k, x] = out.free[k, x], 0.0
        out.awake[s] = 0
    for c in range(len(surfaces.contacts.patch)):
        place_nodes(system, c, state, work)
        look_at_target(system, c, math.inf, work)
        set_row_gaps(surfaces, c, state, work)


@compiled
def follow_surface_passages(system: System, state: State, work: Workspace) -> None:
    """Note the first contact whose patch may have passed its target within the step.

    It moves by more than the depth at which points are beyond the target, past the sphere around
    this; so `state.contacts.passed` counts it after the contacts of balls.
    """
    contacts, h = system.surfaces.contacts, system.scheme.h
    for c in range(len(contacts.patch)):
        if not work.surfaces.near[c] or state.contacts.passed[0]:
            continue
        # Slower surfaces cannot come past the depth within a step without being seen.
        way = h * _closing_speed(system, c, state, work)
        if way > contacts.size[c] and _meets(system, c, way, state, work):
            state.contacts.passed[0] = len(system.couplings.contact) + c + 1


@compiled
def _meets(system: System, c: int, way: float, state: State, work: Workspace) -> bool:
    """Whether the sphere around the patch of contact c has met its target on its way to here."""
    reach = _reach(system, system.surfaces.contacts.patch[c], state)
    center = _center(system, system.surfaces.contacts.patch[c], state)
    back = scale(-system.scheme.h, _closing_velocity(system, c, center, state, work))
    s = 0.0
    while s <= 1.0:
        gap = _distance(system, c, add(center, scale(s, back)), state, work) - reach
        if gap <= 0.0:
            return True
        s += max(gap, system.surfaces.contacts.size[c]) / way
    return False


@compiled
def _find_near(system: System, state: State, work: Workspace) -> None:
    """The contacts that may close in this step, and the free motion of their bodies."""
    surfaces, out = system.surfaces, work.surfaces
    contacts = surfaces.contacts
    for c in range(len(contacts.patch)):
        near = _is_near(system, c, system.scheme.h, state, work)
        out.near[c] = int(near)
        if near:
            _wake(system, surfaces.patches.owner[contacts.patch[c]], state, work)
            if contacts.target[c] >= 0 and contacts.frame[c] < 0:
                _wake(system, surfaces.patches.owner[contacts.target[c]], state, work)
    for s in range(len(surfaces.bodies.flexible)):
        # A body that no contact is near keeps no force of an earlier step.
        if not out.awake[s]:
            for k in range(surfaces.bodies.node[s], surfaces.bodies.node[s + 1]):
                for x in range(3):
                    state.surfaces.load[k, x] = 0.0
    for i in range(len(out.closed)):
        # Rows that turn out to be far keep no gap of an earlier step.
        state.surfaces.gap[i] = math.nan


@compiled
def _wake(system: System, s: int, state: State, work: Workspace) -> None:
    """Displacements of the nodes of a body by the free motion of its modes, phi eta."""
    bodies, modes = system.surfaces.bodies, system.elastic.modes
    if work.surfaces.awake[s]:
        return
    # In flight nothing of this is computed: a surface that is far costs a distance.
    work.surfaces.awake[s] = 1
    e, first = bodies.flexible[s], bodies.node[s]
    begin, end = modes.range[e], modes.range[e + 1]
    m = end - begin
    for k in range(first, bodies.node[s + 1]):
        for x in range(3):
            place = bodies.phi_start[s] + (3 * (k - first) + x) * m
            phi = bodies.phi[place : place + m]
            work.surfaces.free[k, x] = inner(phi, state.modes.eta[begin:end])


@compiled
def _is_near(system: System, c: int, h: float, state: State, work: Workspace) -> bool:
    """Whether the sphere around a patch, as large as it may have become, may meet its target."""
    contacts, V = system.surfaces.contacts, work.frames.V
    p, f = contacts.patch[c], contacts.frame[c]
    center = _center(system, p, state)
    reach, speed = _reach(system, p, state), _speed(system, p, state)
    if f >= 0:
        delta = subtract(center, target_origin(system, c, state, work))
        speed += _length((V[f, 0], V[f, 1], V[f, 2]))
        # Where the frame turns, what it carries moves faster the farther away it is.
        speed += _length((V[f, 3], V[f, 4], V[f, 5])) * _length(delta)
    else:
        speed += _speed(system, contacts.target[c], state)
    return _distance(system, c, center, state, work) < reach + STEPS_OF_APPROACH * h * speed


@compiled
def _distance(system: System, c: int, center: Vector, state: State, work: Workspace) -> float:
    """The distance of a point in space from the shape of contact c, or the sphere around its
    target.
    """
    surfaces, t = system.surfaces, system.surfaces.contacts.target[c]
    delta = subtract(center, target_origin(system, c, state, work))
    y = target_axes(system, c, delta, True, state, work)
    if t < 0:
        gap, _, _ = distance_from_shape(surfaces, c, y)
        return float(gap)
    apart = _length(subtract(y, row(surfaces.patches.center, t)))
    if surfaces.contacts.frame[c] >= 0:
        return float(apart - surfaces.patches.radius[t])
    return float(apart - _reach(system, t, state))


@compiled
def _center(system: System, p: int, state: State) -> Vector:
    """The center of the sphere around patch p of a body, in space."""
    b = system.surfaces.patches.body[p]
    lever = rotate(state.bodies.R, b, row(system.surfaces.patches.center, p))
    return add(row(state.bodies.x, b), lever)


@compiled
def _reach(system: System, p: int, state: State) -> float:
    """The radius of patch p, with the most that the energy of its modes can move a node."""
    surfaces, modes = system.surfaces, system.elastic.modes
    s = surfaces.patches.owner[p]
    e = surfaces.bodies.flexible[s]
    energy = 0.0
    for i in range(modes.range[e], modes.range[e + 1]):
        energy += 0.5 * modes.stiffness[i] * state.modes.eta[i] ** 2
        energy += 0.5 * state.modes.rate[i] ** 2
    return float(surfaces.patches.radius[p] + surfaces.bodies.reach[s] * math.sqrt(energy))


@compiled
def _speed(system: System, p: int, state: State) -> float:
    """A bound of the speed of the points of patch p, which move with their body."""
    patches = system.surfaces.patches
    b = patches.body[p]
    turning = _length(_spin(b, state)) * (patches.radius[p] + _length(row(patches.center, p)))
    return float(_length(row(state.bodies.v, b)) + turning)


@compiled
def _spin(b: int, state: State) -> Vector:
    return state.bodies.v[b, 3], state.bodies.v[b, 4], state.bodies.v[b, 5]


@compiled
def _length(a: Vector) -> float:
    return math.sqrt(dot(a, a))


@compiled
def _set_base(system: System, s: int, state: State, work: Workspace) -> None:
    """Displacements without forces of contacts: phi eta + T (u - history)."""
    bodies, elastic, out = system.surfaces.bodies, system.elastic, work.surfaces
    e, first = bodies.flexible[s], bodies.node[s]
    begin, end = elastic.active_range[e], elastic.active_range[e + 1]
    n_a = end - begin
    for k in range(first, bodies.node[s + 1]):
        for x in range(3):
            total, place = out.free[k, x], bodies.T_start[s] + (3 * (k - first) + x) * n_a - begin
            for i in range(begin, end):
                z = elastic.active[i]
                change = state.interfaces.u[z] - work.interfaces.history[z]
                total += bodies.T[place + i] * change
            out.base[k, x] = total


@compiled
def _set_displacements_by_load(surfaces: Surfaces, s: int, state: State, work: Workspace) -> None:
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
def _press_island(system: System, m: int, state: State, work: Workspace) -> None:
    """Forces of the contacts of island m at the present motion, and its stiffness."""
    surfaces, out = system.surfaces, work.surfaces
    contacts = surfaces.contacts
    looks = out.looks[0] < LOOKS_PER_STEP
    if looks:
        out.count[m] = 0
    for w in range(contacts.island_range[m], contacts.island_range[m + 1]):
        c = contacts.island[w]
        if out.near[c] and looks:
            place_nodes(system, c, state, work)
            _find_candidates(system, m, c, state, work)
        # A contact that is not near has no force left from an earlier step.
        elif out.looks[0] == 0:
            for i in range(contacts.row[c], contacts.row[c + 1]):
                _open(surfaces, c, i, state, work)
    n = out.count[m]
    rubs = False
    for r in range(n):
        _set_gradient(system, m, r, state, work)
        # The rows that were closed before are the guess from which the problem is solved.
        if out.kind[m, r] == 0:
            out.active[r] = out.closed[out.candidate[m, r]]
        else:
            rubs = True
    # New gradients: the same forces of rows are other forces on nodes.
    if looks:
        _load_nodes(system, m, state, work)
    if _is_W_outdated(surfaces, m, work):
        _set_compliances(surfaces, m, work)
    for w in range(contacts.island_range[m], contacts.island_range[m + 1]):
        c = contacts.island[w]
        if out.near[c]:
            # Placed again, for new forces on nodes displace them.
            place_nodes(system, c, state, work)
            _set_gaps(system, m, c, state, work)
    if rubs:
        count = _solve_with_friction(system, m, state, work)
    else:
        count = solve_complementarity(
            n,
            out.W[m],
            out.q,
            out.active,
            out.factored[m],
            out.factor[m],
            out.order[m],
            out.lam,
            out.y,
        )
    for r in range(n):
        i = out.candidate[m, r]
        if out.kind[m, r] == 0:
            out.closed[i] = out.active[r + 1] if rubs and _is_rubbed(m, r, work) else out.active[r]
        # No motion goes on from where there is no solution.
        state.surfaces.force[i] = out.lam[r] if count >= 0 else math.nan
        state.surfaces.gap[i] = out.y[r]
    _load_nodes(system, m, state, work)
    _push_bodies(system, m, state, work)
    if rubs:
        _set_stiffness_with_friction(system, m, max(count, 0), state, work)
    else:
        _set_stiffness(system, m, max(count, 0), state, work)


@compiled
def _is_rubbed(m: int, r: int, work: Workspace) -> bool:
    """Whether the candidate has friction: its slips follow it."""
    return bool(r + 1 < work.surfaces.count[m] and work.surfaces.kind[m, r + 1] > 0)


@compiled
def _solve_with_friction(system: System, m: int, state: State, work: Workspace) -> int:
    """Forces and slips of the candidates of island m, from those at hand; see `solve_cone`."""
    out, contacts, n = work.surfaces, system.surfaces.contacts, work.surfaces.count[m]
    for r in range(n):
        c = out.contact[m, r]
        out.lam[r] = state.surfaces.force[out.candidate[m, r]]
        out.mu[r, 0] = contacts.friction[c, 0] if out.kind[m, r] == 0 else -1.0
        out.mu[r, 1] = contacts.friction[c, 1]
        out.mu[r, 2] = contacts.friction[c, 2] * system.scheme.h
    return int(
        solve_cone(
            n,
            out.W[m],
            out.q,
            out.mu,
            out.active,
            out.factor[m],
            out.order[m],
            out.pivots,
            out.lam,
            out.y,
            out.law,
            out.trial,
        )
    )


@compiled
def _set_stiffness_with_friction(
    system: System, m: int, count: int, state: State, work: Workspace
) -> None:
    """D^T A^-1 P r D of island m, A = I - P (I - r W), P the derivative of the projection."""
    contacts, out = system.surfaces.contacts, work.surfaces
    width_of_D, start = contacts.coordinates[m], contacts.stiffness_start[m]
    # It has the room of Cholesky's factor, which is to be made anew without friction.
    out.factored[m, 0] = -1
    factorize_law(count, out.W[m], out.active, out.law, out.order[m], out.pivots, out.factor[m])
    for a in range(count):
        _set_derivative(system, m, out.order[m, a], out.D[a], state, work)
    for z in range(width_of_D):
        for a in range(count):
            out.trial[out.order[m, a]] = out.D[a, z]
        for a in range(count):
            r = out.order[m, a]
            out.y[a] = -by_law(out.active, out.law, r, r, out.trial, False)
        substitute_law(count, out.factor[m], out.pivots, out.y)
        for x in range(width_of_D):
            total = 0.0
            for a in range(count):
                total += out.D[a, x] * out.y[a]
            out.stiffness[start + x * width_of_D + z] = total


@compiled
def _find_candidates(system: System, m: int, c: int, state: State, work: Workspace) -> None:
    """Rows of contact c that may be closed at the end of the step, with their gradients."""
    surfaces, out = system.surfaces, work.surfaces
    contacts = surfaces.contacts
    margin = contacts.margin[c]
    if math.isnan(margin):
        way = system.scheme.h * _closing_speed(system, c, state, work)
        way += _elastic_way(surfaces, contacts.patch[c], state, work)
        if contacts.frame[c] < 0:
            way += _elastic_way(surfaces, contacts.target[c], state, work)
        # Twice, for the motion within the step is not known yet.
        margin = 2.0 * way
    look_at_target(system, c, margin, work)
    set_row_gaps(surfaces, c, state, work)
    for i in range(contacts.row[c], contacts.row[c + 1]):
        gap = state.surfaces.gap[i]
        # Without its force a closed row would penetrate: it stays a candidate while it is covered.
        if gap < margin or (out.closed[i] and not math.isnan(gap)):
            r = out.count[m]
            out.candidate[m, r], out.contact[m, r], out.kind[m, r] = i, c, 0
            out.count[m] = r + 1
            face_target(surfaces, c, i, work)
            if contacts.slip_row[c] >= 0:
                for kind in range(1, 3):
                    out.candidate[m, r + kind] = slip_row(surfaces, c, i, kind)
                    out.contact[m, r + kind], out.kind[m, r + kind] = c, kind
                out.count[m] = r + 3
                face_slips(surfaces, c, i, work)
        else:
            _open(surfaces, c, i, state, work)


@compiled
def _open(surfaces: Surfaces, c: int, i: int, state: State, work: Workspace) -> None:
    """Row i of contact c is open."""
    work.surfaces.closed[i], state.surfaces.force[i] = 0, 0.0
    if surfaces.contacts.slip_row[c] >= 0:
        for kind in range(1, 3):
            state.surfaces.force[slip_row(surfaces, c, i, kind)] = 0.0


@compiled
def _elastic_way(surfaces: Surfaces, p: int, state: State, work: Workspace) -> float:
    """The farthest that a node of patch p is from its displacement at the start of the step."""
    square = 0.0
    for k in range(surfaces.patches.node[p], surfaces.patches.node[p + 1]):
        u = add(row(work.surfaces.base, k), row(work.surfaces.by_load, k))
        change = subtract(u, row(state.surfaces.u, k))
        square = max(square, dot(change, change))
    return math.sqrt(square)


@compiled
def _closing_speed(system: System, c: int, state: State, work: Workspace) -> float:
    """A bound of the speed at which the patch of contact c and its target move as rigid bodies."""
    patches, p = system.surfaces.patches, system.surfaces.contacts.patch[c]
    velocity = _closing_velocity(system, c, _center(system, p, state), state, work)
    _, turning = _motion_of_target(system, c, state, work)
    spins = _length(_spin(patches.body[p], state)) + _length(turning)
    return float(_length(velocity) + spins * patches.radius[p])


@compiled
def _closing_velocity(
    system: System, c: int, center: Vector, state: State, work: Workspace
) -> Vector:
    """The velocity of the center of the patch of contact c against its target, as rigid bodies."""
    b = system.surfaces.patches.body[system.surfaces.contacts.patch[c]]
    omega = rotate(state.bodies.R, b, _spin(b, state))
    velocity = add(row(state.bodies.v, b), cross(omega, subtract(center, row(state.bodies.x, b))))
    other, turning = _motion_of_target(system, c, state, work)
    arm = subtract(center, target_origin(system, c, state, work))
    return subtract(velocity, add(other, cross(turning, arm)))


@compiled
def _motion_of_target(
    system: System, c: int, state: State, work: Workspace
) -> tuple[Vector, Vector]:
    """Velocity of the origin of the axes of the target of contact c, and its spin, in space."""
    surfaces, V, f = system.surfaces, work.frames.V, system.surfaces.contacts.frame[c]
    if f >= 0:
        return (V[f, 0], V[f, 1], V[f, 2]), (V[f, 3], V[f, 4], V[f, 5])
    t = surfaces.patches.body[surfaces.contacts.target[c]]
    return row(state.bodies.v, t), rotate(state.bodies.R, t, _spin(t, state))


@compiled
def _set_gradient(system: System, m: int, r: int, state: State, work: Workspace) -> None:
    """b of candidate r, and its mean normal, in the axes of its body."""
    out, c = work.surfaces, work.surfaces.contact[m, r]
    b = system.surfaces.patches.body[system.surfaces.contacts.patch[c]]
    begin, end, first = _supports(system.surfaces, m, r, work)
    mean = (0.0, 0.0, 0.0)
    for j in range(first, first + end - begin):
        n = target_axes(system, c, row(out.facing, j), False, state, work)
        n = rotate_back(state.bodies.R, b, n)
        mean = add(mean, n)
        for x in range(3):
            out.gradient[j, x] = n[x]
    for x in range(3):
        state.surfaces.normal[out.candidate[m, r], x] = mean[x]


@compiled
def _supports(surfaces: Surfaces, m: int, r: int, work: Workspace) -> tuple[int, int, int]:
    """The first and last node around candidate r of island m, as places in `support`, and the place
    of the first in `gradient`.
    """
    contacts, patches = surfaces.contacts, surfaces.patches
    c, i = work.surfaces.contact[m, r], work.surfaces.candidate[m, r]
    p, kind = contacts.patch[c], work.surfaces.kind[m, r]
    if kind > 0:
        i -= slip_row(surfaces, c, contacts.row[c], kind) - contacts.row[c]
    local = i - contacts.row[c] + patches.row[p]
    begin, end = patches.support_range[local], patches.support_range[local + 1]
    return begin, end, support_of(surfaces, c, i, kind)


@compiled
def _others(surfaces: Surfaces, m: int, r: int, work: Workspace) -> tuple[int, int]:
    """The first and last node of a flexible target that candidate r meets, as places in `other`."""
    i = work.surfaces.candidate[m, r]
    first = surfaces.contacts.other[i]
    if surfaces.contacts.frame[work.surfaces.contact[m, r]] >= 0:
        return first, first
    return first, first + work.surfaces.other_count[i]


@compiled
def _set_gaps(system: System, m: int, c: int, state: State, work: Workspace) -> None:
    """q: gaps of the candidates of contact c, less those by their forces."""
    surfaces, out = system.surfaces, work.surfaces
    contacts, t = surfaces.contacts, surfaces.contacts.target[c]
    for r in range(out.count[m]):
        if out.contact[m, r] != c:
            continue
        i = out.candidate[m, r]
        begin, end, first = _supports(surfaces, m, r, work)
        total = out.offset[i]
        for j in range(begin, end):
            place = row(out.place, surfaces.patches.support[j])
            total += dot(row(out.facing, first + j - begin), place)
        if t >= 0:
            for j in range(contacts.other[i], contacts.other[i] + out.other_count[i]):
                total += dot(row(out.other_gradient, j), row(out.place, out.other[j]))
        # Nodes are where the present forces push them: q is the gap without these.
        for o in range(out.count[m]):
            total -= out.W[m, r, o] * state.surfaces.force[out.candidate[m, o]]
        # that of a layer is no displacement of the nodes
        out.q[r] = total + _layer(surfaces, c, i, work) * state.surfaces.force[i]


@compiled
def _layer(surfaces: Surfaces, c: int, i: int, work: Workspace) -> float:
    """The compliance of the layer at row i [m/N]."""
    if i >= len(work.surfaces.area):
        return 0.0  # of a slip
    return float(surfaces.contacts.layer[c] / work.surfaces.area[i])


@compiled
def _is_W_outdated(surfaces: Surfaces, m: int, work: Workspace) -> bool:
    """Whether candidates or their gradients have changed since W of island m was made."""
    out = work.surfaces
    # The list of candidates first: gradients of different rows cannot be compared.
    if out.W_count[m] != out.count[m]:
        return True
    for r in range(out.count[m]):
        if out.W_row[m, r] != out.candidate[m, r]:
            return True
    for r in range(out.count[m]):
        begin, end, first = _supports(surfaces, m, r, work)
        for j in range(first, first + end - begin):
            for x in range(3):
                if abs(out.gradient[j, x] - out.W_gradient[j, x]) > MAX_TURN:
                    return True
        begin, end = _others(surfaces, m, r, work)
        for j in range(begin, end):
            if out.other[j] != out.W_other[j]:
                return True
            for x in range(3):
                if abs(out.other_gradient[j, x] - out.W_other_gradient[j, x]) > MAX_TURN:
                    return True
    return False


@compiled
def _set_compliances(surfaces: Surfaces, m: int, work: Workspace) -> None:
    """W of the candidates of island m: gaps by forces, of bodies and of layers."""
    out, contacts, patches = work.surfaces, surfaces.contacts, surfaces.patches
    n = out.count[m]
    for r in range(n):
        for o in range(n):
            out.W[m, r, o] = 0.0
    for r in range(n):
        c, i = out.contact[m, r], out.candidate[m, r]
        s = patches.owner[contacts.patch[c]]
        _clear_column(surfaces, s, work)
        begin, end, first = _supports(surfaces, m, r, work)
        for j in range(begin, end):
            b = row(out.gradient, first + j - begin)
            _add_to_column(surfaces, s, patches.support[j], b, work)
            for x in range(3):
                out.W_gradient[first + j - begin, x] = b[x]
        _add_column(surfaces, m, r, s, work)
        begin, end = _others(surfaces, m, r, work)
        if begin < end:
            s = patches.owner[contacts.target[c]]
            _clear_column(surfaces, s, work)
            for j in range(begin, end):
                b = row(out.other_gradient, j)
                _add_to_column(surfaces, s, out.other[j], b, work)
                out.W_other[j] = out.other[j]
                for x in range(3):
                    out.W_other_gradient[j, x] = b[x]
            _add_column(surfaces, m, r, s, work)
        out.W[m, r, r] += _layer(surfaces, c, i, work)
        out.W_row[m, r] = i
    for r in range(n):
        for o in range(r):
            out.W[m, o, r] = out.W[m, r, o]
    out.W_count[m] = n
    if n:
        # Factors of the old W serve no longer.
        out.factored[m, 0] = -1


@compiled
def _clear_column(surfaces: Surfaces, s: int, work: Workspace) -> None:
    n = 3 * (surfaces.bodies.node[s + 1] - surfaces.bodies.node[s])
    for i in range(n):
        work.surfaces.column[i] = 0.0


@compiled
def _add_to_column(surfaces: Surfaces, s: int, k: int, b: Vector, work: Workspace) -> None:
    """Displacements of the nodes of body s by a force b on node k."""
    bodies = surfaces.bodies
    first = bodies.node[s]
    n = 3 * (bodies.node[s + 1] - first)
    column = work.surfaces.column[:n]
    for x in range(3):
        if b[x] != 0.0:
            start = bodies.G_start[s] + (3 * (k - first) + x) * n
            # A row in place of the column, which is the same and lies together in memory.
            G = bodies.G[start : start + n]
            for i in range(n):
                column[i] += b[x] * G[i]


@compiled
def _add_column(surfaces: Surfaces, m: int, r: int, s: int, work: Workspace) -> None:
    """Gaps of the candidates up to r by the displacements of the nodes of body s."""
    out, contacts, patches = work.surfaces, surfaces.contacts, surfaces.patches
    node = surfaces.bodies.node[s]
    for o in range(r + 1):
        total, c = 0.0, out.contact[m, o]
        if patches.owner[contacts.patch[c]] == s:
            begin, end, first = _supports(surfaces, m, o, work)
            for j in range(begin, end):
                k = 3 * (patches.support[j] - node)
                for x in range(3):
                    total += out.gradient[first + j - begin, x] * out.column[k + x]
        if contacts.frame[c] < 0 and patches.owner[contacts.target[c]] == s:
            begin, end = _others(surfaces, m, o, work)
            for j in range(begin, end):
                k = 3 * (out.other[j] - node)
                for x in range(3):
                    total += out.other_gradient[j, x] * out.column[k + x]
        out.W[m, r, o] += total


@compiled
def _load_nodes(system: System, m: int, state: State, work: Workspace) -> None:
    """Forces on the nodes of the bodies of island m, and their displacements by these."""
    surfaces, out = system.surfaces, work.surfaces
    patches = surfaces.patches
    for s in range(len(surfaces.bodies.flexible)):
        if surfaces.bodies.island[s] == m and out.awake[s]:
            for k in range(surfaces.bodies.node[s], surfaces.bodies.node[s + 1]):
                for x in range(3):
                    state.surfaces.load[k, x] = 0.0
    for r in range(out.count[m]):
        force = state.surfaces.force[out.candidate[m, r]]
        if force != 0.0:
            begin, end, first = _supports(surfaces, m, r, work)
            for j in range(begin, end):
                for x in range(3):
                    by_row = force * out.gradient[first + j - begin, x]
                    state.surfaces.load[patches.support[j], x] += by_row
            begin, end = _others(surfaces, m, r, work)
            for j in range(begin, end):
                for x in range(3):
                    state.surfaces.load[out.other[j], x] += force * out.other_gradient[j, x]
    for s in range(len(surfaces.bodies.flexible)):
        if surfaces.bodies.island[s] == m and out.awake[s]:
            _set_displacements_by_load(surfaces, s, state, work)


@compiled
def _push_bodies(system: System, m: int, state: State, work: Workspace) -> None:
    """Forces and moments of the rows of island m on bodies as a whole, and on frames of targets."""
    surfaces, out = system.surfaces, work.surfaces
    contacts, patches = surfaces.contacts, surfaces.patches
    for r in range(out.count[m]):
        force = state.surfaces.force[out.candidate[m, r]]
        if force == 0.0:
            continue
        c = out.contact[m, r]
        linear, moment = _wrench(system, m, r, work)
        s, f = patches.owner[contacts.patch[c]], contacts.frame[c]
        add_to_row(out.push, s, 0, scale(force, linear))
        add_to_row(out.push, s, 3, scale(force, moment))
        linear, moment = _wrench_on_target(system, m, r, state, work)
        if f >= 0:
            add_to_row(work.frames.wrench, f, 0, scale(force, linear))
            add_to_row(work.frames.wrench, f, 3, scale(force, moment))
        else:
            b, s = patches.body[contacts.target[c]], patches.owner[contacts.target[c]]
            add_to_row(out.push, s, 0, scale(force, rotate_back(state.bodies.R, b, linear)))
            add_to_row(out.push, s, 3, scale(force, rotate_back(state.bodies.R, b, moment)))


@compiled
def _wrench(system: System, m: int, r: int, work: Workspace) -> tuple[Vector, Vector]:
    """Force and moment of a unit force of candidate r on its body, in body axes."""
    surfaces, out = system.surfaces, work.surfaces
    begin, end, first = _supports(surfaces, m, r, work)
    force, moment = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for j in range(begin, end):
        b = row(out.gradient, first + j - begin)
        force = add(force, b)
        moment = add(moment, cross(deformed(surfaces, surfaces.patches.support[j], work), b))
    return force, moment


@compiled
def _wrench_on_target(
    system: System, m: int, r: int, state: State, work: Workspace
) -> tuple[Vector, Vector]:
    """The opposite wrench on the target, about the origin of its axes, in space."""
    surfaces, c = system.surfaces, work.surfaces.contact[m, r]
    b = surfaces.patches.body[surfaces.contacts.patch[c]]
    force, moment = _wrench(system, m, r, work)
    force = scale(-1.0, rotate(state.bodies.R, b, force))
    moment = scale(-1.0, rotate(state.bodies.R, b, moment))
    apart = subtract(row(state.bodies.x, b), target_origin(system, c, state, work))
    return force, add(moment, cross(apart, force))


@compiled
def _set_stiffness(system: System, m: int, count: int, state: State, work: Workspace) -> None:
    """D^T W^-1 D of island m, of its `count` closed rows."""
    contacts, out = system.surfaces.contacts, work.surfaces
    width_of_D, start = contacts.coordinates[m], contacts.stiffness_start[m]
    for a in range(count):
        _set_derivative(system, m, out.order[m, a], out.D[a], state, work)
    # W^-1 is applied to one column of D after the other
    for z in range(width_of_D):
        for a in range(count):
            out.y[a] = out.D[a, z]
        solve_closed(count, out.factor[m], out.y)
        for x in range(width_of_D):
            total = 0.0
            for a in range(count):
                total += out.D[a, x] * out.y[a]
            out.stiffness[start + x * width_of_D + z] = total


@compiled
def _set_derivative(
    system: System, m: int, r: int, D: Array, state: State, work: Workspace
) -> None:
    """D of candidate r by the coordinates of the bodies of island m."""
    surfaces, out = system.surfaces, work.surfaces
    contacts, patches = surfaces.contacts, surfaces.patches
    for z in range(contacts.coordinates[m]):
        D[z] = 0.0
    c = out.contact[m, r]
    own, other, f = contacts.coordinate[c, 0], contacts.coordinate[c, 1], contacts.frame[c]
    force, moment = _wrench(system, m, r, work)
    for x in range(3):
        D[own + x] += force[x]
        D[own + 3 + x] += moment[x]
    begin, end, first = _supports(surfaces, m, r, work)
    s = patches.owner[contacts.patch[c]]
    for j in range(begin, end):
        b = row(out.gradient, first + j - begin)
        _add_by_interfaces(system, s, patches.support[j], b, own + 6, D)
    # A target that is fixed in space has no coordinates.
    if other < 0:
        return
    force, moment = _wrench_on_target(system, m, r, state, work)
    if f >= 0:
        pull_back(system.frames, f, (force, moment), state, work, out.wrench)
        for z in range(width(system.frames, f)):
            D[other + coordinate(system.frames, f, z)] += out.wrench[z]
        return
    t = patches.body[contacts.target[c]]
    force = rotate_back(state.bodies.R, t, force)
    moment = rotate_back(state.bodies.R, t, moment)
    for x in range(3):
        D[other + x] += force[x]
        D[other + 3 + x] += moment[x]
    begin, end = _others(surfaces, m, r, work)
    s = patches.owner[contacts.target[c]]
    for j in range(begin, end):
        _add_by_interfaces(system, s, out.other[j], row(out.other_gradient, j), other + 6, D)


@compiled
def _add_by_interfaces(system: System, s: int, k: int, b: Vector, first: int, D: Array) -> None:
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
    _add_by_interfaces(system, s, k, f, begin, work.surfaces.interface_load)


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
