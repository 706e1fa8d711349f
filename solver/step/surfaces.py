"""Contacts of surfaces of flexible bodies: exact unilateral constraints at their nodes.

The gap of a row is the mean of that of the points around its node, weighted with dual functions;
each point meets the plane that touches the shape where it is nearest:

    y_i = 1/A_i sum_q w_q psi_i(q) n_q . (x_q - c_q),    0 <= P_i  _|_  y_i + P_i layer/A_i >= 0
    x_k = x + R (X_k + u_k),    u_C = phi eta + T (u - history) + G f,    f = R^T sum_i P_i b_i

with b_ik = d y_i / d x_k. The residual flexibility in G makes the forces an algebraic function of
the motion, P(xi), which is solved for at each iterate of Newton's method; there the contact acts as
a spring of the stiffness D^T W^-1 D, with D = dy/dxi and W = b G b^T of the closed rows. The planes
are laid at the first two iterates of a step, then they move with their frame, so that Newton's
method converges. Source: docs/theory.md, Contact of surfaces.
"""

import math

from ..arrays import Array
from ..compiler.marks import compiled
from ..compiler.memory import copy
from .complementarity import solve_closed, solve_complementarity
from .frames import coordinate, pull_back, width
from .records.surfaces import Surfaces
from .shapes import surface_at
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

LOOKS = 2
"""iterates of a step at which tangent planes are laid"""
STEPS_AHEAD = 3.0
"""steps ahead in which a patch that may meet its shape is followed"""
MAX_TURN = 1e-4
"""change of a gradient with which an old W still serves: corrections shrink by as much"""
UNKNOWN = math.nan


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
            if out.looks[0] == 0:
                _set_displacements_by_load(system.surfaces, s, state, work)
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
        e = surfaces.bodies.flexible[s]
        b = elastic.body[e]
        force, moment = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for k in range(surfaces.bodies.node[s], surfaces.bodies.node[s + 1]):
            f = row(state.surfaces.load, k)
            if f[0] != 0.0 or f[1] != 0.0 or f[2] != 0.0:
                force = add(force, f)
                moment = add(moment, cross(_lever(surfaces, k, work), f))
                _add_interface_load(system, s, k, f, work)
        add_to_row(work.bodies.force, b, 0, rotate(state.bodies.R, b, force))
        add_to_row(work.bodies.force, b, 3, moment)


@compiled
def add_surface_tangents(system: System, work: Workspace) -> None:
    """K -= D^T W^-1 D: the contacts as springs between the bodies of their islands."""
    contacts, out = system.surfaces.contacts, work.surfaces
    if len(contacts.patch) == 0 or out.looks[0] < 0:
        return
    blocks = system.pattern.island_block
    copy_status(work)
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
def copy_status(work: Workspace) -> None:
    """The matrix is that of the present rows."""
    for i in range(len(work.surfaces.closed)):
        work.surfaces.closed_in_matrix[i] = work.surfaces.closed[i]


@compiled
def have_surfaces_switched(work: Workspace) -> bool:
    """Whether a row has closed or opened since the matrix was made."""
    for i in range(len(work.surfaces.closed)):
        if work.surfaces.closed[i] != work.surfaces.closed_in_matrix[i]:
            return True
    return False


@compiled
def are_surfaces_closed(work: Workspace) -> bool:
    """Whether any row is."""
    total = 0
    for i in range(len(work.surfaces.closed)):
        total += work.surfaces.closed[i]
    return total > 0


@compiled
def add_surface_scales(system: System, state: State, work: Workspace) -> None:
    """The forces on the nodes, each by itself, join the force scales of the bodies."""
    contacts, patches = system.surfaces.contacts, system.surfaces.patches
    for c in range(len(contacts.patch)):
        total = 0.0
        for i in range(contacts.row[c], contacts.row[c + 1]):
            total += state.surfaces.force[i]
        b, f = patches.body[contacts.patch[c]], contacts.frame[c]
        arm = patches.radius[contacts.patch[c]]
        center = row(patches.center, contacts.patch[c])
        arm += math.sqrt(dot(center, center))
        work.bodies.force_scale[b, 0] += total
        work.bodies.force_scale[b, 1] += total * arm
        other = system.frames.body[f]
        if other >= 0:
            work.bodies.force_scale[other, 0] += total
            work.bodies.force_scale[other, 1] += total * arm


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
            state.interfaces.u[k] += inner(modes.phi[place : place + m], out.modal_step[begin:end])


@compiled
def add_surface_work(system: System, state: State, work: Workspace) -> None:
    """Work of the contacts on the modes, and the energy of the residual flexibility, 1/2 f . F f.

    With the mean load over the step, as of interfaces.
    """
    surfaces, modes, out = system.surfaces, system.elastic.modes, work.surfaces
    total = 0.0
    for s in range(len(surfaces.bodies.flexible)):
        e = surfaces.bodies.flexible[s]
        for i in range(modes.range[e], modes.range[e + 1]):
            mean = 0.5 * (state.surfaces.modal_load[i] + out.modal_load_n[i])
            state.energies.modal[0] += mean * (state.modes.eta[i] - out.eta_n[i])
            total -= out.modal_step[i] * state.surfaces.modal_load[i]
        if not out.awake[s]:
            continue
        for k in range(surfaces.bodies.node[s], surfaces.bodies.node[s + 1]):
            for x in range(3):
                f = state.surfaces.load[k, x]
                if f != 0.0:
                    total += f * (out.by_load[k, x] + _by_interface_load(system, s, k, x, work))
    state.energies.residual[0] = 0.5 * total


@compiled
def finish_surfaces(system: System, state: State, work: Workspace) -> None:
    """Displacements of nodes and gaps at the end of a step."""
    surfaces, out = system.surfaces, work.surfaces
    for s in range(len(surfaces.bodies.flexible)):
        if out.awake[s]:
            for k in range(surfaces.bodies.node[s], surfaces.bodies.node[s + 1]):
                for x in range(3):
                    state.surfaces.u[k, x] = out.base[k, x] + out.by_load[k, x]


# -- the parts of it


@compiled
def _find_near(system: System, state: State, work: Workspace) -> None:
    """The contacts that may close in this step, and the free motion of their bodies."""
    surfaces, out = system.surfaces, work.surfaces
    contacts = surfaces.contacts
    for c in range(len(contacts.patch)):
        s = surfaces.patches.owner[contacts.patch[c]]
        near = _is_near(system, c, system.scheme.h, state, work)
        out.near[c] = int(near)
        if near and not out.awake[s]:
            out.awake[s] = 1
            _set_free(system, s, state, work)
    for i in range(len(out.closed)):
        state.surfaces.gap[i] = UNKNOWN


@compiled
def _is_near(system: System, c: int, h: float, state: State, work: Workspace) -> bool:
    """Whether the sphere around a patch, as large as it may have become, may meet its shape."""
    surfaces, elastic = system.surfaces, system.elastic
    contacts, patches = surfaces.contacts, surfaces.patches
    p = contacts.patch[c]
    s, b, f = patches.owner[p], patches.body[p], contacts.frame[c]
    e = surfaces.bodies.flexible[s]
    energy = 0.0
    for i in range(elastic.modes.range[e], elastic.modes.range[e + 1]):
        energy += 0.5 * elastic.modes.stiffness[i] * state.modes.eta[i] ** 2
    reach = patches.radius[p] + surfaces.bodies.reach[s] * math.sqrt(energy)
    center = row(patches.center, p)
    place = add(row(state.bodies.x, b), rotate(state.bodies.R, b, center))
    speed = _length(row(state.bodies.v, b))
    omega = state.bodies.v[b, 3], state.bodies.v[b, 4], state.bodies.v[b, 5]
    speed += _length(omega) * (patches.radius[p] + _length(center))
    V, delta = work.frames.V, subtract(place, row(work.frames.r, f))
    speed += _length((V[f, 0], V[f, 1], V[f, 2]))
    speed += _length((V[f, 3], V[f, 4], V[f, 5])) * _length(delta)
    gap, _ = _distance(surfaces, c, rotate_back(work.frames.D, f, delta))
    return gap < reach + STEPS_AHEAD * h * speed


@compiled
def approach_surfaces(system: System, h: float, state: State, work: Workspace) -> bool:
    """Whether a patch may meet its shape after a time h."""
    for c in range(len(system.surfaces.contacts.patch)):
        if _is_near(system, c, h, state, work):
            return True
    return False


@compiled
def _length(a: Vector) -> float:
    return math.sqrt(dot(a, a))


@compiled
def _distance(surfaces: Surfaces, c: int, y: Vector) -> tuple[float, Vector]:
    """The distance of a point from the shape of contact c, and the normal, in axes of the shape."""
    contacts = surfaces.contacts
    parameters = contacts.parameters[contacts.first[c] : contacts.first[c + 1]]
    s, n, _, _ = surface_at(
        contacts.shape[c], parameters, row(contacts.axis, c), row(contacts.across, c), y
    )
    return contacts.side[c] * s, scale(contacts.side[c], n)


@compiled
def _set_free(system: System, s: int, state: State, work: Workspace) -> None:
    """Displacements of the nodes of a body by the free motion of its modes, phi eta."""
    bodies, modes = system.surfaces.bodies, system.elastic.modes
    e, first = bodies.flexible[s], bodies.node[s]
    begin, end = modes.range[e], modes.range[e + 1]
    m = end - begin
    for k in range(first, bodies.node[s + 1]):
        for x in range(3):
            place = bodies.phi_start[s] + (3 * (k - first) + x) * m
            work.surfaces.free[k, x] = inner(
                bodies.phi[place : place + m], state.modes.eta[begin:end]
            )


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
def _lever(surfaces: Surfaces, k: int, work: Workspace) -> Vector:
    """X + u of node k, in body axes."""
    u = add(row(work.surfaces.base, k), row(work.surfaces.by_load, k))
    return add(row(surfaces.patches.X, k), u)


@compiled
def _press_island(system: System, m: int, state: State, work: Workspace) -> None:
    """Forces of the contacts of island m at the present motion, and its stiffness."""
    surfaces, out = system.surfaces, work.surfaces
    contacts = surfaces.contacts
    if out.looks[0] < LOOKS:
        out.count[m] = 0
    for w in range(contacts.island_range[m], contacts.island_range[m + 1]):
        c = contacts.island[w]
        if out.near[c]:
            if out.looks[0] < LOOKS:
                _place_nodes(system, c, 1.0, state, work)
                _lay_planes(system, c, work)
                _find_candidates(system, m, c, state, work)
            _place_nodes(system, c, 0.0, state, work)
            _set_gaps(system, m, c, work)
        elif out.looks[0] == 0:
            for i in range(contacts.row[c], contacts.row[c + 1]):
                out.closed[i], state.surfaces.force[i] = 0, 0.0
    n = out.count[m]
    for r in range(n):
        _set_gradient(system, m, r, state, work)
        out.active[r] = out.closed[out.candidate[m, r]]
    if _is_W_outdated(surfaces, m, work):
        _set_compliances(surfaces, m, work)
    count = solve_complementarity(
        n, out.W[m], out.q, out.active, out.factored[m], out.factor[m], out.order[m], out.lam, out.y
    )
    for r in range(n):
        i = out.candidate[m, r]
        out.closed[i] = out.active[r]
        # No motion goes on from where there is no solution.
        state.surfaces.force[i] = out.lam[r] if count >= 0 else math.nan
        state.surfaces.gap[i] = out.y[r]
    _load_nodes(system, m, state, work)
    _set_stiffness(system, m, max(count, 0), state, work)


@compiled
def _place_nodes(system: System, c: int, share: float, state: State, work: Workspace) -> None:
    """The nodes of the patch of contact c, moved by a share of the forces of contacts."""
    surfaces, out = system.surfaces, work.surfaces
    patches, f = surfaces.patches, surfaces.contacts.frame[c]
    p = surfaces.contacts.patch[c]
    b = patches.body[p]
    # the difference of positions first, for it is small
    apart = subtract(row(state.bodies.x, b), row(work.frames.r, f))
    for k in range(patches.node[p], patches.node[p + 1]):
        u = add(row(out.base, k), scale(share, row(out.by_load, k)))
        lever = rotate(state.bodies.R, b, add(row(patches.X, k), u))
        y = rotate_back(work.frames.D, f, add(apart, lever))
        for x in range(3):
            out.place[k, x] = y[x]


@compiled
def _lay_planes(system: System, c: int, work: Workspace) -> None:
    """The planes that touch the shape of contact c next to the points of its patch."""
    surfaces, out = system.surfaces, work.surfaces
    patches, p = surfaces.patches, surfaces.contacts.patch[c]
    first = patches.point[p]
    for q in range(first, patches.point[p + 1]):
        y = (0.0, 0.0, 0.0)
        for z in range(patches.width):
            k = patches.nodes[q, z]
            if k < 0:
                break
            y = add(y, scale(patches.N[q, z], row(out.place, k)))
        gap, n = _distance(surfaces, c, y)
        for x in range(3):
            out.plane[q - first, x] = n[x]
        out.plane[q - first, 3] = gap - dot(n, y)


@compiled
def _find_candidates(system: System, m: int, c: int, state: State, work: Workspace) -> None:
    """Rows of contact c that may be closed at the end of the step, with their gradients."""
    surfaces, out = system.surfaces, work.surfaces
    contacts, patches = surfaces.contacts, surfaces.patches
    p, first = contacts.patch[c], contacts.row[c]
    margin = contacts.margin[c]
    if math.isnan(margin):
        margin = 2.0 * system.scheme.h * _closing_speed(system, c, state, work)
    gaps = state.surfaces.gap
    for i in range(first, contacts.row[c + 1]):
        gaps[i] = 0.0
    for q in range(patches.point[p], patches.point[p + 1]):
        place = q - patches.point[p]
        y = (0.0, 0.0, 0.0)
        for z in range(patches.width):
            k = patches.nodes[q, z]
            if k < 0:
                break
            y = add(y, scale(patches.N[q, z], row(out.place, k)))
        gap = dot(row(out.plane, place), y) + out.plane[place, 3]
        for z in range(4):
            i = patches.rows[q, z]
            if i < 0:
                break
            gaps[i - patches.row[p] + first] += patches.weight[q, z] * gap
    for i in range(first, contacts.row[c + 1]):
        # Without its force a closed row would penetrate: it stays a candidate.
        if gaps[i] < margin or out.closed[i]:
            r = out.count[m]
            out.candidate[m, r], out.contact[m, r] = i, c
            out.count[m] = r + 1
            _face(surfaces, c, i, work)
        else:
            out.closed[i], state.surfaces.force[i] = 0, 0.0


@compiled
def _face(surfaces: Surfaces, c: int, i: int, work: Workspace) -> None:
    """The gradient of row i of contact c by its nodes, and its offset, of the present planes."""
    patches, out = surfaces.patches, work.surfaces
    p = surfaces.contacts.patch[c]
    local = i - surfaces.contacts.row[c] + patches.row[p]
    begin, end, first = _support_of_row(surfaces, c, i)
    for j in range(end - begin):
        for x in range(3):
            out.facing[first + j, x] = 0.0
    offset = 0.0
    for t in range(patches.row_point[local], patches.row_point[local + 1]):
        q = patches.point_of_row[t]
        place = q - patches.point[p]
        weight = patches.weight_of_row[t]
        offset += weight * out.plane[place, 3]
        for z in range(patches.width):
            if patches.nodes[q, z] < 0:
                break
            j = first + patches.slot_of_row[t, z]
            for x in range(3):
                out.facing[j, x] += weight * patches.N[q, z] * out.plane[place, x]
    out.offset[i] = offset


@compiled
def _set_gaps(system: System, m: int, c: int, work: Workspace) -> None:
    """q: gaps of the candidates of contact c without the forces of contacts."""
    surfaces, out = system.surfaces, work.surfaces
    for r in range(out.count[m]):
        if out.contact[m, r] == c:
            begin, end, first = _supports(surfaces, m, r, work)
            total = out.offset[out.candidate[m, r]]
            for j in range(begin, end):
                place = row(out.place, surfaces.patches.support[j])
                total += dot(row(out.facing, first + j - begin), place)
            out.q[r] = total


@compiled
def _closing_speed(system: System, c: int, state: State, work: Workspace) -> float:
    """A bound of the speed at which the patch of contact c and its shape move, as rigid bodies."""
    surfaces = system.surfaces
    patches = surfaces.patches
    p, f = surfaces.contacts.patch[c], surfaces.contacts.frame[c]
    b = patches.body[p]
    omega = state.bodies.v[b, 3], state.bodies.v[b, 4], state.bodies.v[b, 5]
    center = row(patches.center, p)
    turning = cross(omega, center)
    velocity = add(row(state.bodies.v, b), rotate(state.bodies.R, b, turning))
    V = work.frames.V
    place = add(row(state.bodies.x, b), rotate(state.bodies.R, b, center))
    arm = subtract(place, row(work.frames.r, f))
    carried = add((V[f, 0], V[f, 1], V[f, 2]), cross((V[f, 3], V[f, 4], V[f, 5]), arm))
    spins = _length(omega) + _length((V[f, 3], V[f, 4], V[f, 5]))
    return _length(subtract(velocity, carried)) + spins * patches.radius[p]


@compiled
def _set_gradient(system: System, m: int, r: int, state: State, work: Workspace) -> None:
    """b of candidate r, and its mean normal, in body axes."""
    surfaces, out = system.surfaces, work.surfaces
    c = out.contact[m, r]
    b, f = surfaces.patches.body[surfaces.contacts.patch[c]], surfaces.contacts.frame[c]
    begin, end, first = _supports(surfaces, m, r, work)
    mean = (0.0, 0.0, 0.0)
    for j in range(first, first + end - begin):
        n = rotate(work.frames.D, f, row(out.facing, j))
        n = rotate_back(state.bodies.R, b, n)
        mean = add(mean, n)
        for x in range(3):
            out.gradient[j, x] = n[x]
    for x in range(3):
        state.surfaces.normal[out.candidate[m, r], x] = mean[x]


@compiled
def _supports(surfaces: Surfaces, m: int, r: int, work: Workspace) -> tuple[int, int, int]:
    """The supports of candidate r of island m, see `_support_of_row`."""
    return _support_of_row(surfaces, work.surfaces.contact[m, r], work.surfaces.candidate[m, r])


@compiled
def _support_of_row(surfaces: Surfaces, c: int, i: int) -> tuple[int, int, int]:
    """The first and last node around row i of contact c, as places in `support`, and the place of
    the first in `gradient`.
    """
    contacts, patches = surfaces.contacts, surfaces.patches
    p = contacts.patch[c]
    local = i - contacts.row[c] + patches.row[p]
    begin, end = patches.support_range[local], patches.support_range[local + 1]
    return begin, end, contacts.support[c] + begin - patches.support_range[patches.row[p]]


@compiled
def _is_W_outdated(surfaces: Surfaces, m: int, work: Workspace) -> bool:
    """Whether candidates or their gradients have changed since W of island m was made."""
    out = work.surfaces
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
    return False


@compiled
def _set_compliances(surfaces: Surfaces, m: int, work: Workspace) -> None:
    """W of the candidates of island m: gaps by forces, of bodies and of layers."""
    out = work.surfaces
    bodies, patches, contacts = surfaces.bodies, surfaces.patches, surfaces.contacts
    n = out.count[m]
    for r in range(n):
        c = out.contact[m, r]
        s = patches.owner[contacts.patch[c]]
        first, last = bodies.node[s], bodies.node[s + 1]
        width_of_G = 3 * (last - first)
        column = out.column[:width_of_G]
        column[:] = 0.0
        begin, end, place = _supports(surfaces, m, r, work)
        for j in range(begin, end):
            for x in range(3):
                b = out.gradient[place + j - begin, x]
                out.W_gradient[place + j - begin, x] = b
                if b != 0.0:
                    start = bodies.G_start[s]
                    start += (3 * (patches.support[j] - first) + x) * width_of_G
                    G = bodies.G[start : start + width_of_G]
                    for i in range(width_of_G):
                        column[i] += b * G[i]
        for other in range(r + 1):
            total = 0.0
            if patches.owner[contacts.patch[out.contact[m, other]]] == s:
                begin, end, place = _supports(surfaces, m, other, work)
                for j in range(begin, end):
                    k = 3 * (patches.support[j] - first)
                    for x in range(3):
                        total += out.gradient[place + j - begin, x] * column[k + x]
            out.W[m, r, other] = total
            out.W[m, other, r] = total
        local = out.candidate[m, r] - contacts.row[c] + patches.row[contacts.patch[c]]
        out.W[m, r, r] += contacts.layer[c] / patches.area[local]
        out.W_row[m, r] = out.candidate[m, r]
    out.W_count[m] = n
    out.factored[m, 0] = -1


@compiled
def _load_nodes(system: System, m: int, state: State, work: Workspace) -> None:
    """Forces on the nodes of the bodies of island m, and on the frames of its shapes."""
    surfaces, out = system.surfaces, work.surfaces
    contacts, patches, bodies = surfaces.contacts, surfaces.patches, surfaces.bodies
    for w in range(contacts.island_range[m], contacts.island_range[m + 1]):
        s = patches.owner[contacts.patch[contacts.island[w]]]
        for k in range(bodies.node[s], bodies.node[s + 1]):
            for x in range(3):
                state.surfaces.load[k, x] = 0.0
    for r in range(out.count[m]):
        force = state.surfaces.force[out.candidate[m, r]]
        if force != 0.0:
            begin, end, place = _supports(surfaces, m, r, work)
            for j in range(begin, end):
                k = patches.support[j]
                for x in range(3):
                    state.surfaces.load[k, x] += force * out.gradient[place + j - begin, x]
    for w in range(contacts.island_range[m], contacts.island_range[m + 1]):
        s = patches.owner[contacts.patch[contacts.island[w]]]
        if out.awake[s]:
            _set_displacements_by_load(surfaces, s, state, work)
    for r in range(out.count[m]):
        force = state.surfaces.force[out.candidate[m, r]]
        if force != 0.0:
            linear, moment = _wrench_on_frame(system, m, r, state, work)
            f = contacts.frame[out.contact[m, r]]
            add_to_row(work.frames.wrench, f, 0, scale(force, linear))
            add_to_row(work.frames.wrench, f, 3, scale(force, moment))


@compiled
def _wrench_on_frame(
    system: System, m: int, r: int, state: State, work: Workspace
) -> tuple[Vector, Vector]:
    """The wrench of a unit force of candidate r on the frame of its shape, in space."""
    surfaces, out = system.surfaces, work.surfaces
    patches, c = surfaces.patches, out.contact[m, r]
    b, f = patches.body[surfaces.contacts.patch[c]], surfaces.contacts.frame[c]
    apart = subtract(row(state.bodies.x, b), row(work.frames.r, f))
    begin, end, place = _supports(surfaces, m, r, work)
    force, moment = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for j in range(begin, end):
        gradient = rotate(state.bodies.R, b, row(out.gradient, place + j - begin))
        lever = rotate(state.bodies.R, b, _lever(surfaces, patches.support[j], work))
        force = subtract(force, gradient)
        moment = subtract(moment, cross(add(apart, lever), gradient))
    return force, moment


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
    surfaces, elastic, out = system.surfaces, system.elastic, work.surfaces
    contacts, patches, bodies = surfaces.contacts, surfaces.patches, surfaces.bodies
    for z in range(contacts.coordinates[m]):
        D[z] = 0.0
    c = out.contact[m, r]
    s, f = patches.owner[contacts.patch[c]], contacts.frame[c]
    e, own = bodies.flexible[s], contacts.coordinate[c, 0]
    n_a = elastic.active_range[e + 1] - elastic.active_range[e]
    begin, end, place = _supports(surfaces, m, r, work)
    for j in range(begin, end):
        k = patches.support[j]
        b = row(out.gradient, place + j - begin)
        by_rotation = cross(_lever(surfaces, k, work), b)
        for x in range(3):
            D[own + x] += b[x]
            D[own + 3 + x] += by_rotation[x]
            start = bodies.T_start[s] + (3 * (k - bodies.node[s]) + x) * n_a
            for i in range(n_a):
                D[own + 6 + i] += b[x] * bodies.T[start + i]
    other = contacts.coordinate[c, 1]
    if other >= 0:
        wrench = _wrench_on_frame(system, m, r, state, work)
        pull_back(system.frames, f, wrench, state, work, out.wrench)
        for z in range(width(system.frames, f)):
            D[other + coordinate(system.frames, f, z)] += out.wrench[z]


@compiled
def _add_interface_load(system: System, s: int, k: int, f: Vector, work: Workspace) -> None:
    """interface_load += T^T f of node k of body s."""
    bodies, elastic = system.surfaces.bodies, system.elastic
    e = bodies.flexible[s]
    begin, n_a = elastic.active_range[e], elastic.active_range[e + 1] - elastic.active_range[e]
    for x in range(3):
        start = bodies.T_start[s] + (3 * (k - bodies.node[s]) + x) * n_a
        for i in range(n_a):
            work.surfaces.interface_load[begin + i] += bodies.T[start + i] * f[x]


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
