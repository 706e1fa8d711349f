"""Contacts: whether they are closed, and what happens in each from closing to opening.

A contact is a coupling whose first row, a gap or a coordinate of a joint, has a law that stores
energy where it is engaged (laws/contact.py); the other rows are its friction. An open contact
exerts nothing, and the derivatives of its rows are not computed.
"""

from ..compiler.marks import compiled, entry
from ..laws import evaluate_law
from ..laws.contact import penetration
from .gaps import has_ends, is_blocked, settled_axis, slip_axis
from .rows import GAP
from .system import ContactState, Couplings, State, Workspace
from .vectors import Vector

START, END, STEPS, PEAK, IMPULSE, CLOSING, OPENING, RESTITUTION, DISSIPATED = range(9)
"""columns of an event, those of results/schema.py"""
GRAZE = 0.05
"""peak over the largest of its contact below which nobody asks for the peak"""


@compiled
def set_closed(couplings: Couplings, j: int, state: State, work: Workspace) -> None:
    """The status of contact j: closed where the law of its first row stores energy."""
    laws, out, i = couplings.laws, work.couplings, couplings.range[j]
    m = laws.range[i]
    parameters = laws.parameters[laws.first[m] : laws.first[m + 1]]
    memory = state.couplings.memory[laws.memory[m] : laws.memory[m + 1]]
    c = out.coordinate[i] - laws.rest[i]
    _, _, _, energy = evaluate_law(
        laws.number[m], parameters, memory, out.elapsed[0], c, out.rate[i]
    )
    if energy == 0.0:
        out.status[j] = 0
    elif out.status[j] == 0:
        out.status[j] = 1
        if couplings.friction_of[j] >= 0 and couplings.rows.kind[i] == GAP:
            _set_slip_axis(couplings, j, slip_axis(couplings.rows, i, work), work)


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
        ahead, _ = penetration_of(couplings, i, old.coordinate[i] + h * old.rate[i])
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
    """At the end of a step: which balls are beyond an end of their shape, and axes of slip, which
    go on with the normal.
    """
    rows, out = couplings.rows, work.couplings
    for k in range(len(couplings.contact)):
        j = couplings.contact[k]
        i = couplings.range[j]
        if rows.kind[i] == GAP:
            if has_ends(rows, i):
                out.blocked[i] = int(is_blocked(rows, i, work))
            if out.status[j] and couplings.friction_of[j] >= 0:
                _set_slip_axis(couplings, j, settled_axis(rows, i + 1, work), work)


@compiled
def _set_slip_axis(couplings: Couplings, j: int, axis: Vector, work: Workspace) -> None:
    for i in range(couplings.range[j] + 1, couplings.range[j + 1]):
        for x in range(3):
            work.couplings.slip_axis[i, x] = axis[x]


@compiled
def penetration_of(couplings: Couplings, i: int, c: float) -> tuple[float, float]:
    """How far the coordinate of row i is beyond the nearer limit of its law, and the way out."""
    laws = couplings.laws
    m = laws.range[i]
    return penetration(laws.parameters[laws.first[m] : laws.first[m + 1]], c)


@compiled
def follow_contact(couplings: Couplings, j: int, state: State, work: Workspace) -> None:
    """Contact j from the start to the end of a step, whose work is counted already."""
    contacts, old, out = state.contacts, state.couplings, work.couplings
    k, i, h = couplings.contact_of[j], couplings.range[j], out.elapsed[0]
    closed, t = out.status[j] > 0, state.step[0] * h
    if not closed and not contacts.steps[k]:
        return
    before, side = penetration_of(couplings, i, old.coordinate[i])
    after, new_side = penetration_of(couplings, i, out.coordinate[i])
    crossing = t + h * min(max(before / (before - after), 0.0), 1.0) if before != after else t
    if closed and not contacts.steps[k]:
        begins = before <= 0.0  # or else it was closed at the start of the run
        contacts.begin[k] = crossing if begins else t
        contacts.closing_speed[k] = max(new_side * old.rate[i], 0.0) if begins else 0.0
        contacts.whole[k] = int(begins)
        contacts.work[k] = contacts.work_done[k]
        contacts.peak[k], contacts.impulse[k] = abs(out.lam_n[i]), 0.0
    contacts.work_done[k] = state.energies.compliance[j]
    if closed:
        contacts.steps[k] += 1
        contacts.peak[k] = max(contacts.peak[k], abs(old.lam[i]))
        contacts.impulse[k] += h * abs(old.lam[i])
        state.extremes.depth[k] = max(state.extremes.depth[k], after)
    else:
        _end_contact(state, k, crossing, max(-side * out.rate[i], 0.0))


@compiled
def _end_contact(state: State, k: int, end: float, opening_speed: float) -> None:
    contacts = state.contacts
    n, closing_speed = contacts.n_events[0], contacts.closing_speed[k]
    event = contacts.event[n]
    contacts.event_contact[n] = k
    contacts.n_events[0] = n + 1
    contacts.ended[k] += 1
    if contacts.whole[k]:
        follow_shortest(state, k)
    event[START], event[END], event[STEPS] = contacts.begin[k], end, contacts.steps[k]
    event[PEAK], event[IMPULSE] = contacts.peak[k], contacts.impulse[k]
    event[CLOSING], event[OPENING] = closing_speed, opening_speed
    event[RESTITUTION] = opening_speed / closing_speed if closing_speed > 0.0 else 0.0
    event[DISSIPATED] = contacts.work[k] - contacts.work_done[k]
    contacts.steps[k] = 0


@compiled
def follow_shortest(state: State, k: int) -> None:
    """The steps of the shortest time that contact k was closed, but for those that only graze."""
    contacts, extremes = state.contacts, state.extremes
    peak, steps = contacts.peak[k], contacts.steps[k]
    extremes.peak[k] = max(extremes.peak[k], peak)
    least = GRAZE * extremes.peak[k]
    first = extremes.shortest[k] == 0 or extremes.shortest_peak[k] < least
    if peak >= least and (first or steps < extremes.shortest[k]):
        extremes.shortest[k], extremes.shortest_peak[k] = steps, peak


@compiled
def is_full(contacts: ContactState) -> bool:
    """Whether the next step may end more contacts than there is room for."""
    return bool(contacts.n_events[0] + len(contacts.steps) > len(contacts.event_contact))
