"""Balls that pass through a shape within a step, so that neither of its ends shows a contact.

A force acts where a gap is closed at the end of a step. What closes and opens again in between goes
unnoticed, so the path of each ball is followed in the axes of frame A, which carries the shape.
With s = 1 at the start of the step and 0 at its end, the bodies of A and B turn by s psi back from
their rotations at the end, and their levers l with them,

    y(s) = D_A^T exp(s psi_A) (Delta + e_B(s) - e_A(s) - m(s)),    e(s) = (exp(-s psi) - 1) l

with m the translation of B against A: that of the step, in a straight line, or along the parabola
that ends with the velocities of the end of the step. The first knows no accelerations, the second
none that jump within the step, as in an impact elsewhere: where some contact is closed a ball has
passed if both say so, else if the second does.

Distances change no faster than the ball moves, so that the path is followed in steps of the
present gap (sphere tracing: Hart, The Visual Computer 12, 1996), which finds the first contact of
any shape.
"""

import math

from ..compiler.marks import compiled
from .contacts import is_closed
from .gaps import ball_radius, gap_at, place_of_ball
from .kinds import delta_of
from .records.couplings import Couplings, Rows
from .rotations import stumpff
from .rows import GAP
from .system import State, System, Workspace
from .vectors import (
    ZERO_VECTOR,
    Vector,
    add,
    cross,
    dot,
    magnitude,
    rotate,
    rotate_back,
    row,
    scale,
    subtract,
    triple,
)

FINEST_PART = 0.01
"""least distance of the places of a path that are examined, over the size of ball and shape"""
NEGLIGIBLE_DEPTH = 1e-5
"""depth of a passage, over the size of ball and shape, that counts as none"""
GRAZING_DEPTH = 1e-3
"""depth of a passage in a plane, over the radius of the ball, that counts as none: such a ball is
slower than forces make it within a step"""
PATH_ERROR = 0.05
"""error of a path over its deviation from a straight line"""
MAX_PLACES = 1000
"""places of a path that are examined"""
PLACES_OF_CLOSED, PLACES_OF_PLANE = 16, 32
"""places of the path of a ball that is in contact at an end of the step, and beside a plane"""
MAX_GAP_SLOPE = 1.5
"""largest change of a gap over the way of the ball: past an end two distances
add, each of slope 1"""
LONG_TRAVEL = 0.5
"""travel in contact in a step, over the size of ball and shape, from which a path is examined"""

Path = tuple[Vector, Vector, Vector, Vector, Vector, Vector, Vector]
"""psi and lever of A, the same of B, Delta at the end, translation in the step, h times its rate"""


@compiled
def start_places(couplings: Couplings, state: State, work: Workspace) -> None:
    """Where balls are at the start of a run."""
    for k in range(len(couplings.contact)):
        i = couplings.range[couplings.contact[k]]
        if couplings.rows.kind[i] == GAP:
            _keep_place(state, k, place_of_ball(couplings.rows, i, work))


@compiled
def follow_passages(system: System, state: State, work: Workspace) -> None:
    """Note the first contact whose ball has passed in a step, which ends with the present places.

    To be called while the coordinates of the start of the step are kept.
    """
    couplings, contacts = system.couplings, state.contacts
    for k in range(len(couplings.contact)):
        i = couplings.range[couplings.contact[k]]
        if couplings.rows.kind[i] == GAP:
            place = place_of_ball(couplings.rows, i, work)
            if not contacts.passed[0] and _has_passed(system, k, i, place, state, work):
                contacts.passed[0] = k + 1
            _keep_place(state, k, place)


@compiled
def _keep_place(state: State, k: int, place: Vector) -> None:
    for x in range(3):
        state.contacts.place[k, x] = place[x]


@compiled
def _has_passed(
    system: System, k: int, i: int, place: Vector, state: State, work: Workspace
) -> bool:
    """Whether the ball of contact k was deeper in the step than at its ends; its gap is row i."""
    rows, size = system.couplings.rows, system.couplings.rows.size[i]
    start = row(state.contacts.place, k)
    before, after = state.couplings.coordinate[i], work.couplings.coordinate[i]
    travel = _length(subtract(place, start))
    f, g = rows.frame_a[i], rows.frame_b[i]
    # Bounds first, without trigonometry: nearly all balls are far from their shapes.
    square_A, arm_A = _turn_and_arm(system, f, work)
    square_B, arm_B = _turn_and_arm(system, g, work)
    apart = magnitude(delta_of(rows, i, work))
    # An arc of angle psi and radius l stays within psi^2 l / 8 of its chord.
    bend = 0.125 * (square_A * (arm_A + apart) + square_B * arm_B)
    bend += 0.5 * math.sqrt(square_A) * travel
    if before + after > 2.0 * travel + 8.0 * bend:  # far away, and in a smooth motion for sure
        return False
    closed = before < 0.0 or after < 0.0
    # A contact that is seen at an end of the step cannot have been missed by a short path.
    if closed and travel < LONG_TRAVEL * size:
        return False
    path = _path(
        system, i, _turn(system, f, state, work), _turn(system, g, state, work), start, state, work
    )
    sag = 0.25 * _length(subtract(path[5], path[6]))
    length = travel + 4.0 * (bend + sag)
    if closed:
        deep = max(-before, -after) + 0.1 * FINEST_PART * size
        return _reaches(rows, i, path, False, deep, length, 1.0 / PLACES_OF_CLOSED, work)
    if before + after > MAX_GAP_SLOPE * length or length < FINEST_PART * size < math.inf:
        return False
    if size == math.inf and min(before, after) > bend + sag:
        return False
    # Bounded below, so that a body that flies away costs no endless search.
    finest = max(1.0 / MAX_PLACES, min(FINEST_PART * size / length, 1.0 / PLACES_OF_PLANE))
    if size == math.inf:
        deep = max(PATH_ERROR * (bend + sag), GRAZING_DEPTH * ball_radius(rows, i))
    else:
        deep = NEGLIGIBLE_DEPTH * size + PATH_ERROR * sag
    if not _reaches(rows, i, path, True, deep, length, finest, work):
        return False
    # An impact elsewhere makes velocities jump, so that the parabola alone proves nothing.
    smooth = not is_closed(system.couplings, work) and not _were_closed(state)
    return smooth or _reaches(rows, i, path, False, deep, length, finest, work)


@compiled
def _were_closed(state: State) -> bool:
    """Whether a contact was closed at the start of the step."""
    closed = False
    for k in range(len(state.contacts.steps)):
        closed = closed or state.contacts.steps[k] > 0
    return closed


@compiled
def _length(a: Vector) -> float:
    return math.sqrt(dot(a, a))


@compiled
def _turn_and_arm(system: System, f: int, work: Workspace) -> tuple[float, float]:
    """The square of the angle of the body of frame f in the step, and no less than its lever."""
    b = system.frames.body[f]
    if b < 0:
        return 0.0, 0.0
    psi = row(work.bodies.psi, b)
    return dot(psi, psi), magnitude(row(work.frames.lever, f))


@compiled
def _turn(system: System, f: int, state: State, work: Workspace) -> tuple[Vector, Vector]:
    """psi of the body of frame f in the step and its lever, in space; zero of a fixed frame."""
    b = system.frames.body[f]
    if b < 0:
        return ZERO_VECTOR, ZERO_VECTOR
    R = state.bodies.R
    return rotate(R, b, row(work.bodies.psi, b)), rotate(R, b, row(work.frames.lever, f))


@compiled
def _path(
    system: System,
    i: int,
    turn_a: tuple[Vector, Vector],
    turn_b: tuple[Vector, Vector],
    start: Vector,
    state: State,
    work: Workspace,
) -> Path:
    """The path in a step from a place `start`, in the axes of A then."""
    rows = system.couplings.rows
    f, g = rows.frame_a[i], rows.frame_b[i]
    (psi_A, l_A), (psi_B, l_B) = turn_a, turn_b
    delta = delta_of(rows, i, work)
    was = _turned(-1.0, psi_A, rotate(work.frames.D, f, start))
    arcs = subtract(_arc(1.0, psi_B, l_B), _arc(1.0, psi_A, l_A))
    moved = subtract(add(delta, arcs), was)
    rate = subtract(_translation(system, g, state), _translation(system, f, state))
    return psi_A, l_A, psi_B, l_B, delta, moved, scale(system.scheme.h, rate)


@compiled
def _translation(system: System, f: int, state: State) -> Vector:
    """Velocity of frame f but for the rotation of its body, in space."""
    b = system.frames.body[f]
    if b < 0:
        return ZERO_VECTOR
    velocity, k = row(state.bodies.v, b), system.frames.dof[f]
    if k >= 0:
        velocity = add(velocity, rotate(state.bodies.R, b, triple(state.interfaces.rate, k)))
    return velocity


@compiled
def _turned(s: float, psi: Vector, a: Vector) -> Vector:
    """exp(s psi) a"""
    square = s * s * dot(psi, psi)
    if square == 0.0:
        return a
    _, c1, c2, _, _, _ = stumpff(square)
    across = cross(psi, a)
    return add(a, add(scale(c1 * s, across), scale(c2 * s * s, cross(psi, across))))


@compiled
def _arc(s: float, psi: Vector, lever: Vector) -> Vector:
    """(exp(-s psi) - 1) l"""
    return subtract(_turned(-s, psi, lever), lever)


@compiled
def _place(rows: Rows, i: int, path: Path, with_rates: bool, s: float, work: Workspace) -> Vector:
    """y(s); with_rates: along the parabola."""
    psi_A, l_A, psi_B, l_B, delta, moved, by_rate = path
    arcs = subtract(_arc(s, psi_B, l_B), _arc(s, psi_A, l_A))
    translation = scale(s, moved)
    if with_rates:
        translation = add(scale(s * s, moved), scale(s - s * s, by_rate))
    place = subtract(add(delta, arcs), translation)
    return rotate_back(work.frames.D, rows.frame_a[i], _turned(s, psi_A, place))


@compiled
def _reaches(
    rows: Rows,
    i: int,
    path: Path,
    with_rates: bool,
    deep: float,
    length: float,
    finest: float,
    work: Workspace,
) -> bool:
    """Whether a path of at most a length leads deeper than that, looked at in parts >= finest."""
    s, blocked = 1.0, work.couplings.blocked[i] == 1
    for _ in range(MAX_PLACES):
        place = _place(rows, i, path, with_rates, s, work)
        gap, blocked = gap_at(rows, i, place, blocked)
        if gap < -deep:
            return True
        s -= max(max(gap, 0.0) / (MAX_GAP_SLOPE * length), finest)
        if s <= 0.0:
            return False
    return False
