"""Rows of contacts of surfaces: their gaps, the flexibility between them, and their forces.

The candidates of an island are the rows that may be closed. Of each, b is the gradient of its gap
by the nodes around it and, of a flexible target, below it:

    y = q + W lambda,   W = b G b^T,   f = b^T lambda,   D = dy/dxi

xi: coordinates of the bodies of the island. Source: docs/theory.md, Contact of surfaces.
"""

from ..arrays import Array
from ..compiler.marks import compiled
from .facing import slip_row, support_of
from .frames import coordinate, pull_back, width
from .planes import deformed, target_axes, target_origin
from .records.surfaces import Surfaces
from .second_order import subtract_slopes
from .surface_motion import (
    add_by_interfaces,
    layer_compliance,
    list_loaded,
    set_displacement_by_load,
    set_displacements_by_load,
)
from .surface_second import add_slopes
from .system import State, System, Workspace
from .vectors import Vector, add, add_to_row, cross, dot, rotate, rotate_back, row, scale, subtract

MAX_PICKED = 4
"""nodes for each needed one from which on these alone are moved: whole rows of G are quick"""
MAX_TURN = 1e-4
"""change of a gradient with which an old W still serves: corrections shrink by as much"""


@compiled
def set_gradient(system: System, m: int, r: int, state: State, work: Workspace) -> None:
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
def set_gaps(system: System, m: int, c: int, state: State, work: Workspace) -> None:
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
        out.q[r] = total + layer_compliance(surfaces, c, i, work) * state.surfaces.force[i]


@compiled
def has_rows_of_W(m: int, work: Workspace) -> bool:
    """Whether the candidates of island m are those for which W was made."""
    out = work.surfaces
    if out.W_count[m] != out.count[m]:
        return False
    for r in range(out.count[m]):  # noqa: SIM110 - compiled code has no generators
        if out.W_row[m, r] != out.candidate[m, r]:
            return False
    return True


@compiled
def is_W_outdated(surfaces: Surfaces, m: int, work: Workspace) -> bool:
    """Whether candidates or their gradients have changed since W of island m was made."""
    out = work.surfaces
    # The list of candidates first: gradients of different rows cannot be compared.
    if not has_rows_of_W(m, work):
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
def set_compliances(surfaces: Surfaces, m: int, work: Workspace) -> None:
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
        out.W[m, r, r] += layer_compliance(surfaces, c, i, work)
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
def load_nodes(system: System, m: int, whole: bool, state: State, work: Workspace) -> None:
    """Forces on the nodes of the bodies of island m, and their displacements by these.

    Those of all nodes, or of the nodes of candidates alone.
    """
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
            if whole:
                set_displacements_by_load(surfaces, s, state, work)
            else:
                _move_candidates(surfaces, m, s, state, work)


@compiled
def _move_candidates(surfaces: Surfaces, m: int, s: int, state: State, work: Workspace) -> None:
    """Displacements by forces of the nodes of body s around or below candidates of island m."""
    out, contacts, patches = work.surfaces, surfaces.contacts, surfaces.patches
    first, last = surfaces.bodies.node[s], surfaces.bodies.node[s + 1]
    out.is_needed[first:last] = 0
    for r in range(out.count[m]):
        c = out.contact[m, r]
        if patches.owner[contacts.patch[c]] == s:
            begin, end, _ = _supports(surfaces, m, r, work)
            for j in range(begin, end):
                out.is_needed[patches.support[j]] = 1
        if contacts.frame[c] < 0 and patches.owner[contacts.target[c]] == s:
            begin, end = _others(surfaces, m, r, work)
            for j in range(begin, end):
                out.is_needed[out.other[j]] = 1
    needed = 0
    for k in range(first, last):
        needed += out.is_needed[k]
    if MAX_PICKED * needed > last - first:
        set_displacements_by_load(surfaces, s, state, work)
        return
    count = list_loaded(surfaces, s, state, work)
    for k in range(first, last):
        if out.is_needed[k]:
            set_displacement_by_load(surfaces, s, k, count, state, work)


@compiled
def push_bodies(system: System, m: int, state: State, work: Workspace) -> None:
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
def set_derivative(system: System, m: int, r: int, D: Array, state: State, work: Workspace) -> None:
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
        add_by_interfaces(system, s, patches.support[j], b, own + 6, D)
    coordinates = _coordinates(system, s, D[own + 6 :], work)
    for j in range(begin, end):
        b = row(out.gradient, first + j - begin)
        add_slopes(system, s, patches.support[j], b, coordinates, work)
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
        add_by_interfaces(system, s, out.other[j], row(out.other_gradient, j), other + 6, D)
    coordinates = _coordinates(system, s, D[other + 6 :], work)
    for j in range(begin, end):
        b = row(out.other_gradient, j)
        add_slopes(system, s, out.other[j], b, coordinates, work)


@compiled
def _coordinates(system: System, s: int, D: Array, work: Workspace) -> Array:
    """The part of D of the coordinates q of body s, once active dofs count by their u."""
    elastic, e = system.elastic, system.surfaces.bodies.flexible[s]
    # Displacements by loads are u less 1/2 A(q, q): where u stays, q moves them back.
    subtract_slopes(elastic, e, work, D)
    n = elastic.active_range[e + 1] - elastic.active_range[e]
    return D[n - elastic.second.r[e] : n]
