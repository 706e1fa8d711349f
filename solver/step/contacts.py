"""Contacts: whether they are closed, and what happens in each from closing to opening.

A contact is a coupling whose first row, a gap or a coordinate of a joint, has a law that stores
energy where it is engaged (laws/contact.py); the other rows are its friction. An open contact
exerts nothing, and the derivatives of its rows are not computed.
"""

from ..compiler.marks import compiled, entry
from ..laws import evaluate_law
from .gaps import is_blocked, normal_of, slip_axis, tangents
from .rows import GAP
from .system import Couplings, Rows, State, Workspace
from .vectors import Vector, rotate, rotate_back

START, END, STEPS, PEAK, IMPULSE, CLOSING, OPENING, RESTITUTION, DISSIPATED = range(9)
"""columns of an event"""


@compiled
def set_closed(couplings: Couplings, j: int, state: State, work: Workspace) -> None:
    """The status of contact j: closed where the law of its first row stores energy."""
    laws, out, i = couplings.laws, work.couplings, couplings.range[j]
    parameters = laws.parameters[laws.first[i] : laws.first[i + 1]]
    memory = state.couplings.memory[laws.memory[i] : laws.memory[i + 1]]
    c = out.coordinate[i] - laws.rest[i]
    _, _, _, energy = evaluate_law(
        laws.number[i], parameters, memory, out.elapsed[0], c, out.rate[i]
    )
    if energy == 0.0:
        out.status[j] = 0
    elif out.status[j] == 0:
        out.status[j] = 1


@compiled
def is_closed(couplings: Couplings, work: Workspace) -> bool:
    """Whether any contact is."""
    for k in range(len(couplings.contact)):
        if work.couplings.status[couplings.contact[k]] > 0:
            return True
    return False


@entry
def approaches(couplings: Couplings, h: float, state: State, work: Workspace) -> bool:
    """Whether any contact is closed, or will be after a time h at its present rate."""
    if is_closed(couplings, work):
        return True
    old = state.couplings
    for k in range(len(couplings.contact)):
        i = couplings.range[couplings.contact[k]]
        ahead, _ = _penetration(couplings, i, old.coordinate[i] + h * old.rate[i])
        if ahead > 0.0:
            return True
    return False


@compiled
def has_switched(couplings: Couplings, work: Workspace) -> bool:
    """Whether a contact has opened, closed, stuck or slipped since the matrix was made."""
    switched = False
    for w in range(len(couplings.switching)):
        j = couplings.switching[w]
        switched = switched or work.couplings.status[j] != work.matrix.status[j]
    return switched


@compiled
def note_status(couplings: Couplings, work: Workspace) -> None:
    """The matrix is that of the present status."""
    for w in range(len(couplings.switching)):
        j = couplings.switching[w]
        work.matrix.status[j] = work.couplings.status[j]


@compiled
def release_open(couplings: Couplings, state: State, work: Workspace) -> None:
    """No forces in open contacts, to the bit."""
    for k in range(len(couplings.contact)):
        j = couplings.contact[k]
        if not work.couplings.status[j]:
            for i in range(couplings.range[j], couplings.range[j + 1]):
                state.couplings.lam[i] = 0.0


@compiled
def settle_contacts(couplings: Couplings, work: Workspace) -> None:
    """At the end of a step: which balls are beyond an end of their shape, and axes of slip."""
    rows, out = couplings.rows, work.couplings
    for k in range(len(couplings.contact)):
        j = couplings.contact[k]
        i = couplings.range[j]
        if rows.kind[i] != GAP:
            continue
        out.blocked[i] = int(is_blocked(rows, i, work))
        if couplings.friction_of[j] >= 0:
            axis = _settled_axis(rows, i, out.status[j] > 0, work)
            for slip in range(i + 1, couplings.range[j + 1]):
                for x in range(3):
                    out.slip_axis[slip, x] = axis[x]


@compiled
def _settled_axis(rows: Rows, i: int, closed: bool, work: Workspace) -> Vector:
    """The axis of slip of gap i, in the axes of frame A."""
    n, f = normal_of(rows, i, work), rows.frame_a[i]
    t, _, inverse = tangents(rows, i + 1, rotate(work.frames.D, f, n), work)
    if not closed or inverse == 0.0:
        return slip_axis(rows, i, n)
    return rotate_back(work.frames.D, f, t)


@compiled
def _penetration(couplings: Couplings, i: int, c: float) -> tuple[float, float]:
    """How far the coordinate of row i is beyond the nearer limit of its law, and the way out."""
    laws = couplings.laws
    lower, upper = laws.parameters[laws.first[i]], laws.parameters[laws.first[i] + 1]
    return (lower - c, -1.0) if lower - c > c - upper else (c - upper, 1.0)


@compiled
def follow_contact(couplings: Couplings, j: int, state: State, work: Workspace) -> None:
    """Contact j from the start to the end of a step, whose work is counted already."""
    contacts, old, out = state.contacts, state.couplings, work.couplings
    k, i, h = couplings.contact_of[j], couplings.range[j], out.elapsed[0]
    closed, t = out.status[j] > 0, state.step[0] * h
    if not closed and not contacts.steps[k]:
        return
    before, side = _penetration(couplings, i, old.coordinate[i])
    after, new_side = _penetration(couplings, i, out.coordinate[i])
    crossing = t + h * min(max(before / (before - after), 0.0), 1.0) if before != after else t
    if closed and not contacts.steps[k]:
        contacts.begin[k] = crossing
        contacts.closing_speed[k] = max(new_side * old.rate[i], 0.0)
        contacts.work[k] = contacts.work_done[k]
        contacts.peak[k] = contacts.impulse[k] = 0.0
    contacts.work_done[k] = state.energies.compliance[j]
    if closed:
        contacts.steps[k] += 1
        contacts.peak[k] = max(contacts.peak[k], abs(old.lam[i]))
        contacts.impulse[k] += h * abs(old.lam[i])
    else:
        _end_contact(state, k, crossing, max(-side * out.rate[i], 0.0))


@compiled
def _end_contact(state: State, k: int, end: float, opening_speed: float) -> None:
    contacts = state.contacts
    n, closing_speed = contacts.n_events[0], contacts.closing_speed[k]
    event = contacts.event[n]
    contacts.event_contact[n] = k
    contacts.n_events[0] = n + 1
    event[START], event[END], event[STEPS] = contacts.begin[k], end, contacts.steps[k]
    event[PEAK], event[IMPULSE] = contacts.peak[k], contacts.impulse[k]
    event[CLOSING], event[OPENING] = closing_speed, opening_speed
    event[RESTITUTION] = opening_speed / closing_speed if closing_speed > 0.0 else 0.0
    event[DISSIPATED] = contacts.work[k] - contacts.work_done[k]
    contacts.steps[k] = 0
