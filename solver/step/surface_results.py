"""What contacts of surfaces do as a whole: forces, centers of pressure, events, rows of results."""

import math

from ..compiler.marks import compiled, of_surfaces
from ..compiler.memory import copy
from .events import end_contact
from .facing import slip_row, support_of
from .planes import deformed
from .records.surfaces import Surfaces
from .surface_motion import add_up_modes
from .system import Output, State, System, Workspace
from .vectors import Vector, add, add_to_row, cross, dot, rotate, rotate_back, row, scale, subtract

PRESSED_PART = 0.1
"""least part of its area over which results spread the force of a row: under an edge, which covers
next to nothing of it, pressures have no bound"""
NEGLIGIBLE_SEPARATION = 1e-10
"""of a rate of separation over the speeds of which it is the difference"""


@compiled
def keep_velocities(system: System, state: State, work: Workspace) -> None:
    """Those at the start of a step, with which contacts that close in it have met."""
    if len(system.surfaces.contacts.patch):
        copy(state.bodies.v, work.surfaces.v_n)


@of_surfaces
@compiled
def add_up_surfaces(system: System, state: State, work: Workspace) -> None:
    """Contacts of surfaces from the start to the end of a step: totals, impulses, events."""
    h = work.couplings.elapsed[0]
    for c in range(len(system.surfaces.contacts.patch)):
        k, totals, contacts = len(system.couplings.contact) + c, state.surfaces, state.contacts
        was_closed = contacts.steps[k] > 0
        way, center = row(totals.total_force, c), row(totals.center, c)
        _add_up(system, c, state, work)
        closed = totals.normal_force[c] > 0.0
        if was_closed and not closed:
            speed = _separation_rate(system, c, way, center, False, state, work)
            end_contact(state, k, state.step[0] * h, max(speed, 0.0))
        if not closed:
            continue
        if not was_closed:
            contacts.begin[k] = state.step[0] * h
            contacts.peak[k], contacts.impulse[k] = 0.0, 0.0
            # Bodies store what a contact of surfaces takes from their motion: it has no own energy.
            contacts.work[k] = math.nan
            way, center = row(totals.total_force, c), row(totals.center, c)
            speed = -_separation_rate(system, c, way, center, True, state, work)
            # Bodies that press on each other at the start of a run are at rest there.
            begins = state.taken[0] > 0 or speed > 0.0
            contacts.whole[k] = int(begins)
            contacts.closing_speed[k] = max(speed, 0.0)
        force = math.sqrt(dot(row(totals.total_force, c), row(totals.total_force, c)))
        contacts.steps[k] += 1
        contacts.peak[k] = max(contacts.peak[k], force)
        contacts.impulse[k] += h * force
        contacts.total_impulse[k] += h * force


@compiled
def total_surfaces(system: System, state: State, work: Workspace) -> None:
    """Forces, moments and centers of pressure of all contacts of surfaces."""
    for c in range(len(system.surfaces.contacts.patch)):
        _add_up(system, c, state, work)


@compiled
def _add_up(system: System, c: int, state: State, work: Workspace) -> None:
    """Force, moment and center of pressure of contact c, on the body of its rows, in space."""
    surfaces, totals, out = system.surfaces, state.surfaces, work.surfaces
    contacts, patches, p = surfaces.contacts, surfaces.patches, surfaces.contacts.patch[c]
    b = patches.body[p]
    for x in range(3):
        totals.total_force[c, x] = totals.total_moment[c, x] = totals.center[c, x] = 0.0
    # Summed in space: bodies turn within an event, and sums of body axes would mean nothing.
    total = 0.0
    for i in range(contacts.row[c], contacts.row[c + 1]):
        P = totals.force[i]
        if P == 0.0:
            continue
        local = i - contacts.row[c] + patches.row[p]
        begin, end = patches.support_range[local], patches.support_range[local + 1]
        first = contacts.support[c] + begin - patches.support_range[patches.row[p]]
        force, moment, place = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        normal = row(totals.normal, i)
        for j in range(begin, end):
            lever = deformed(surfaces, patches.support[j], work)
            gradient = row(out.gradient, first + j - begin)
            force, moment = add(force, gradient), add(moment, cross(lever, gradient))
            place = add(place, scale(dot(gradient, normal), lever))
        total += P
        if contacts.slip_row[c] >= 0:
            _add_friction(system, c, i, state, work)
        add_to_row(totals.total_force, c, 0, scale(P, rotate(state.bodies.R, b, force)))
        add_to_row(totals.total_moment, c, 0, scale(P, rotate(state.bodies.R, b, moment)))
        # Weights of dual functions may be negative: the place of a row is that of its force.
        add_to_row(totals.center, c, 0, scale(P / dot(normal, normal), place))
    totals.normal_force[c] = total
    if total > 0.0:
        place = scale(1.0 / total, row(totals.center, c))
        place = add(row(state.bodies.x, b), rotate(state.bodies.R, b, place))
        for x in range(3):
            totals.center[c, x] = place[x]


@compiled
def _add_friction(system: System, c: int, i: int, state: State, work: Workspace) -> None:
    """Friction at row i joins the force and the moment of contact c."""
    surfaces, totals, out = system.surfaces, state.surfaces, work.surfaces
    contacts, patches, p = surfaces.contacts, surfaces.patches, surfaces.contacts.patch[c]
    b, local = patches.body[p], i - contacts.row[c] + patches.row[p]
    for kind in range(1, 3):
        k, first = slip_row(surfaces, c, i, kind), support_of(surfaces, c, i, kind)
        T, force, moment = totals.force[k], (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        begin = patches.support_range[local]
        for j in range(begin, patches.support_range[local + 1]):
            lever = deformed(surfaces, patches.support[j], work)
            gradient = row(out.gradient, first + j - begin)
            force, moment = add(force, gradient), add(moment, cross(lever, gradient))
        add_to_row(totals.total_force, c, 0, scale(T, rotate(state.bodies.R, b, force)))
        add_to_row(totals.total_moment, c, 0, scale(T, rotate(state.bodies.R, b, moment)))


@compiled
def _separation_rate(
    system: System, c: int, way: Vector, place: Vector, before: bool, state: State, work: Workspace
) -> float:
    """The rate at which both bodies, as rigid ones, part at a place along a force on the first.

    before: with the velocities at the start of the step. What is only rounding is 0.
    """
    patches, p = system.surfaces.patches, system.surfaces.contacts.patch[c]
    t, f = system.surfaces.contacts.target[c], system.surfaces.contacts.frame[c]
    other = system.frames.body[f] if f >= 0 else patches.body[t]
    first = _velocity(patches.body[p], place, before, state, work)
    second = _velocity(other, place, before, state, work)
    size = math.sqrt(dot(way, way))
    # Along the force, for a surface has many normals and its force one direction.
    rate = dot(subtract(first, second), way) / size if size > 0.0 else 0.0
    speeds = math.sqrt(dot(first, first)) + math.sqrt(dot(second, second))
    return rate if abs(rate) > NEGLIGIBLE_SEPARATION * speeds else 0.0


@compiled
def _velocity(b: int, place: Vector, before: bool, state: State, work: Workspace) -> Vector:
    if b < 0:
        return 0.0, 0.0, 0.0
    # A contact closes with the speed before the step, in which its force has already acted.
    v = work.surfaces.v_n if before else state.bodies.v
    omega, R = (v[b, 3], v[b, 4], v[b, 5]), state.bodies.R
    lever = rotate_back(R, b, subtract(place, row(state.bodies.x, b)))
    return add(row(v, b), rotate(R, b, cross(omega, lever)))


@compiled
def _pressed_area(surfaces: Surfaces, c: int, i: int, work: Workspace) -> float:
    """The area over which the force of row i of contact c is spread in results [m^2]."""
    contacts, patches = surfaces.contacts, surfaces.patches
    whole = patches.area[i - contacts.row[c] + patches.row[contacts.patch[c]]]
    return max(float(work.surfaces.area[i]), PRESSED_PART * float(whole))


@compiled
def _record_friction(
    system: System, c: int, i: int, state: State, work: Workspace, output: Output, k: int
) -> None:
    """Traction and speed of slip of row i of contact c in row k of the output."""
    surfaces, totals = system.surfaces, state.surfaces
    traction, square = (0.0, 0.0, 0.0), 0.0
    if surfaces.contacts.slip_row[c] >= 0 and totals.force[i] > 0.0:
        b = surfaces.patches.body[surfaces.contacts.patch[c]]
        for kind in range(1, 3):
            s = slip_row(surfaces, c, i, kind)
            # Of a slip, `normal` is its tangent and `gap` its way in the step.
            tangent = rotate(state.bodies.R, b, row(totals.normal, s))
            traction = add(
                traction, scale(totals.force[s] / _pressed_area(surfaces, c, i, work), tangent)
            )
            square += totals.gap[s] * totals.gap[s]
    for x in range(3):
        output.surface_row_traction[k, i, x] = traction[x]
    output.surface_row_slip_speed[k, i] = math.sqrt(square) / system.scheme.h


@of_surfaces
@compiled
def record_surfaces(system: System, state: State, work: Workspace, output: Output, k: int) -> None:
    """Contacts of surfaces in row k of the output, and where asked for their rows and nodes."""
    contacts, patches = system.surfaces.contacts, system.surfaces.patches
    totals, out = state.surfaces, work.surfaces
    # Without `nodes` these arrays have no columns.
    wanted = len(output.surface_row_pressure[k]) > 0
    node = 0
    for c in range(len(contacts.patch)):
        p = contacts.patch[c]
        closed, area, largest, least = 0, 0.0, 0.0, math.nan
        for i in range(contacts.row[c], contacts.row[c + 1]):
            pressure, gap = 0.0, totals.gap[i]
            if totals.force[i] > 0.0:
                closed += 1
                area += out.area[i]
                pressure = totals.force[i] / _pressed_area(system.surfaces, c, i, work)
                largest = max(largest, pressure)
                # What is closed presses the layer together, if there is one.
                gap -= contacts.layer[c] * totals.force[i] / out.area[i]
            if not gap >= least:  # also where the least is no number yet
                least = gap if not math.isnan(gap) else least
            if wanted:
                output.surface_row_pressure[k, i] = pressure
                output.surface_row_gap[k, i] = gap
                _record_friction(system, c, i, state, work, output, k)
        for x in range(3):
            output.surface_contact_force[k, c, x] = totals.total_force[c, x]
            output.surface_contact_moment[k, c, x] = totals.total_moment[c, x]
            center = totals.center[c, x] if closed else math.nan
            output.surface_contact_center_of_pressure[k, c, x] = center
        output.surface_contact_normal_force[k, c] = totals.normal_force[c]
        output.surface_contact_area[k, c] = area
        output.surface_contact_closed_rows[k, c] = closed
        output.surface_contact_largest_pressure[k, c] = largest
        output.surface_contact_gap[k, c] = least
        impulse = state.contacts.total_impulse[len(system.couplings.contact) + c]
        output.surface_contact_impulse[k, c] = impulse
        if wanted:
            awake = out.awake[patches.owner[p]]
            for j in range(patches.node[p], patches.node[p + 1]):
                for x in range(3):
                    u = totals.u[j, x] if awake else math.nan
                    output.surface_node_displacement[k, node, x] = u
                node += 1
    if len(output.body_modal_coordinate[k]) > 0:
        _record_modes(system, state, work, output, k)


@compiled
def _record_modes(system: System, state: State, work: Workspace, output: Output, k: int) -> None:
    """Coordinates of the modes of bodies of surfaces, scaled to lengths."""
    bodies = system.surfaces.bodies
    for s in range(len(bodies.flexible)):
        add_up_modes(system, s, state, work)
        mass = system.bodies.mass[system.elastic.body[bodies.flexible[s]]]
        first, begin = bodies.source_range[s], bodies.recorded[s]
        for j in range(bodies.recorded[s + 1] - begin):
            eta = work.surfaces.source[first + j]
            output.body_modal_coordinate[k, begin + j] = eta / math.sqrt(mass)
        for j in range(bodies.node[s], bodies.node[s + 1]):
            for x in range(3):
                output.body_surface_load[k, j, x] = state.surfaces.load[j, x]
