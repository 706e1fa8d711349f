"""Which surfaces may meet in a step, and which have passed one another within it.

A patch is a few spheres around its parts, which grow by what the energy of its body can move a
node; a target is a shape, or spheres as well. Source: docs/theory.md, Contact of surfaces.
"""

import math

from ..compiler.marks import compiled, of_surfaces
from .far_facets import distance_from_shape
from .planes import target_axes, target_origin
from .records.surfaces import Surfaces
from .second_order import first_coordinate
from .surface_motion import wake
from .system import State, System, Workspace
from .vectors import Vector, add, cross, dot, inner, rotate, row, scale, subtract

MAX_LOOKS_AHEAD = 10000
"""places of a patch on its way within a step that are looked at"""
STEPS_OF_APPROACH = 3.0
"""steps ahead in which a patch that may meet its target is followed"""


@of_surfaces
@compiled
def approach_surfaces(system: System, h: float, state: State, work: Workspace) -> bool:
    """Whether a patch may meet its target after a time h."""
    for c in range(len(system.surfaces.contacts.patch)):
        if _is_near(system, c, h, state, work):
            return True
    return False


@of_surfaces
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
        way = h * closing_speed(system, c, state, work)
        if way > contacts.size[c] and _meets(system, c, way, state, work):
            state.contacts.passed[0] = len(system.couplings.contact) + c + 1


@compiled
def _meets(system: System, c: int, way: float, state: State, work: Workspace) -> bool:
    """Whether the sphere around the patch of contact c has met its target on its way to here."""
    p = system.surfaces.contacts.patch[c]
    reach = system.surfaces.patches.radius[p] + _stretch(system, p, state, work)
    reach += _stretch_of_target(system, c, state, work)
    center = _center(system, system.surfaces.contacts.patch[c], state)
    back = scale(-system.scheme.h, _closing_velocity(system, c, center, state, work))
    s = 0.0
    for _ in range(MAX_LOOKS_AHEAD):
        gap = _distance(system, c, add(center, scale(s, back)), state, work) - reach
        if gap <= 0.0:
            return True
        s += max(gap, system.surfaces.contacts.size[c]) / way
        if s > 1.0:
            return False
    # Too fast to tell, or not a number: it must not pass for a flight.
    return True


@compiled
def find_near(system: System, state: State, work: Workspace) -> None:
    """The contacts that may close in this step, and the free motion of their bodies."""
    surfaces, out = system.surfaces, work.surfaces
    contacts = surfaces.contacts
    for c in range(len(contacts.patch)):
        near = _is_near(system, c, system.scheme.h, state, work)
        out.near[c] = int(near)
        if near:
            wake(system, surfaces.patches.owner[contacts.patch[c]], state, work)
            if contacts.target[c] >= 0 and contacts.frame[c] < 0:
                wake(system, surfaces.patches.owner[contacts.target[c]], state, work)
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
def _is_near(system: System, c: int, h: float, state: State, work: Workspace) -> bool:
    """Whether a sphere around a part of a patch, as large as it may have become, may meet its
    target.
    """
    contacts, patches, V = system.surfaces.contacts, system.surfaces.patches, work.frames.V
    p, f = contacts.patch[c], contacts.frame[c]
    center, speed = _center(system, p, state), _speed(system, p, state)
    if f >= 0:
        delta = subtract(center, target_origin(system, c, state, work))
        speed += length((V[f, 0], V[f, 1], V[f, 2]))
        # Where the frame turns, what it carries moves faster the farther away it is.
        speed += length((V[f, 3], V[f, 4], V[f, 5])) * length(delta)
    else:
        speed += _speed(system, contacts.target[c], state)
    reach = _stretch(system, p, state, work) + STEPS_OF_APPROACH * h * speed
    by_target = _stretch_of_target(system, c, state, work)
    for k in range(patches.ball_range[p], patches.ball_range[p + 1]):
        center = _placed(
            system, p, (patches.ball[k, 0], patches.ball[k, 1], patches.ball[k, 2]), state
        )
        if _distance(system, c, center, state, work) < patches.ball[k, 3] + by_target + reach:
            return True
    return False


@compiled
def _distance(system: System, c: int, center: Vector, state: State, work: Workspace) -> float:
    """The distance of a point in space from the shape of contact c, or from the nearest sphere of
    its undeformed target.
    """
    surfaces, t = system.surfaces, system.surfaces.contacts.target[c]
    delta = subtract(center, target_origin(system, c, state, work))
    y = target_axes(system, c, delta, True, state, work)
    if t < 0:
        gap, _, _ = distance_from_shape(surfaces, c, y)
        return float(gap)
    ball, nearest = surfaces.patches.ball, math.inf
    for k in range(surfaces.patches.ball_range[t], surfaces.patches.ball_range[t + 1]):
        apart = length(subtract(y, (ball[k, 0], ball[k, 1], ball[k, 2])))
        nearest = min(nearest, apart - ball[k, 3])
    return nearest


@compiled
def _center(system: System, p: int, state: State) -> Vector:
    """The center of the sphere around patch p of a body, in space."""
    return _placed(system, p, row(system.surfaces.patches.center, p), state)


@compiled
def _placed(system: System, p: int, X: Vector, state: State) -> Vector:
    """A place in the axes of patch p of a body, in space."""
    b = system.surfaces.patches.body[p]
    return add(row(state.bodies.x, b), rotate(state.bodies.R, b, X))


@compiled
def _stretch_of_target(system: System, c: int, state: State, work: Workspace) -> float:
    """The most that a node of the target of contact c can move, 0 of rigid ones."""
    contacts = system.surfaces.contacts
    if contacts.target[c] < 0 or contacts.frame[c] >= 0:
        return 0.0
    return float(_stretch(system, contacts.target[c], state, work))


@compiled
def _stretch(system: System, p: int, state: State, work: Workspace) -> float:
    """The most that the energy of its modes and load patterns can move a node of patch p."""
    surfaces, modes = system.surfaces, system.elastic.modes
    s = surfaces.patches.owner[p]
    e = surfaces.bodies.flexible[s]
    energy = 0.0
    for i in range(modes.range[e], modes.range[e + 1]):
        energy += 0.5 * modes.stiffness[i] * state.modes.eta[i] ** 2
        energy += 0.5 * state.modes.rate[i] ** 2
    way, patterns = surfaces.bodies.reach[s] * math.sqrt(energy), system.patterns
    first, last = first_coordinate(system.elastic, e), system.elastic.dof[e + 1]
    q = state.interfaces.u[first:last]
    way += surfaces.bodies.second_reach[s] * inner(q, q)
    for t in range(len(patterns.body)):
        if patterns.body[t] == surfaces.patches.body[p]:
            amplitude = abs(work.loads.value[patterns.signal[t]])
            way += surfaces.bodies.spread_reach[t] * amplitude
    return float(way)


@compiled
def _speed(system: System, p: int, state: State) -> float:
    """A bound of the speed of the points of patch p, which move with their body."""
    patches = system.surfaces.patches
    b = patches.body[p]
    turning = length(_spin(b, state)) * (patches.radius[p] + length(row(patches.center, p)))
    return float(length(row(state.bodies.v, b)) + turning)


@compiled
def _spin(b: int, state: State) -> Vector:
    return state.bodies.v[b, 3], state.bodies.v[b, 4], state.bodies.v[b, 5]


@compiled
def length(a: Vector) -> float:
    return math.sqrt(dot(a, a))


@compiled
def elastic_way(surfaces: Surfaces, p: int, state: State, work: Workspace) -> float:
    """The farthest that a node of patch p is from its displacement at the start of the step."""
    square = 0.0
    for k in range(surfaces.patches.node[p], surfaces.patches.node[p + 1]):
        u = add(row(work.surfaces.base, k), row(work.surfaces.by_load, k))
        change = subtract(u, row(state.surfaces.u, k))
        square = max(square, dot(change, change))
    return math.sqrt(square)


@compiled
def closing_speed(system: System, c: int, state: State, work: Workspace) -> float:
    """A bound of the speed at which the patch of contact c and its target move as rigid bodies."""
    patches, p = system.surfaces.patches, system.surfaces.contacts.patch[c]
    velocity = _closing_velocity(system, c, _center(system, p, state), state, work)
    _, turning = _motion_of_target(system, c, state, work)
    spins = length(_spin(patches.body[p], state)) + length(turning)
    return float(length(velocity) + spins * patches.radius[p])


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
