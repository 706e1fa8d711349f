"""Contacts: whether they are open or closed.

A contact is a coupling whose first row, a gap or a coordinate of a joint, has a law that stores
energy where it is engaged (laws/contact.py); the other rows are its friction. An open contact
exerts nothing, and the derivatives of its rows are not computed.
"""

from ..compiler.marks import compiled
from ..laws.contact import penetration
from .force_laws import law_of_row, permanent_of_row
from .gaps import has_ends, is_blocked, settled_axis, slip_axis
from .motors import have_motors_switched, note_motors
from .records.couplings import Couplings
from .rows import GAP
from .system import State, Workspace
from .vectors import Vector


@compiled
def set_closed(couplings: Couplings, j: int, state: State, work: Workspace) -> None:
    """The status of contact j: closed where the law of its first row stores energy."""
    out, i = work.couplings, couplings.range[j]
    _, _, _, energy = law_of_row(couplings.laws, i, state, work)
    # Stored energy, not force: damping may take the force to zero within a contact.
    if energy == 0.0:
        out.status[j] = 0
    elif out.status[j] == 0:
        out.status[j] = 1
        if couplings.friction_of[j] >= 0 and couplings.rows.kind[i] == GAP:
            # Chosen anew for each contact: the axis of an earlier one may now be along the normal.
            _set_slip_axis(couplings, j, slip_axis(couplings.rows, i, work), work)


@compiled
def is_closed(couplings: Couplings, work: Workspace) -> bool:
    """Whether any contact is."""
    for k in range(len(couplings.contact)):
        if work.couplings.status[couplings.contact[k]] > 0:
            return True
    return False


@compiled
def approaches(couplings: Couplings, h: float, state: State, work: Workspace) -> bool:
    """Whether any contact is closed, or will be after a time h at its present rate."""
    # A closed contact must be followed with short steps until it opens.
    if is_closed(couplings, work):
        return True
    old = state.couplings
    for k in range(len(couplings.contact)):
        i = couplings.range[couplings.contact[k]]
        ahead, _ = beyond_dent(couplings, i, old.coordinate[i] + h * old.rate[i], state)
        if ahead > 0.0:
            return True
    return False


@compiled
def has_switched(couplings: Couplings, work: Workspace) -> bool:
    """Whether a contact has opened, closed, stuck or slipped since the matrix was made, or a motor
    has come to a limit or left it.
    """
    switched = False
    for w in range(len(couplings.switching)):
        j = couplings.switching[w]
        switched = switched or work.couplings.status[j] != work.matrix.status[j]
    return switched or have_motors_switched(work)


@compiled
def note_status(couplings: Couplings, work: Workspace) -> None:
    """The matrix is that of the present status."""
    for w in range(len(couplings.switching)):
        j = couplings.switching[w]
        work.matrix.status[j] = work.couplings.status[j]
    note_motors(work)


@compiled
def release_open(couplings: Couplings, state: State, work: Workspace) -> None:
    """No forces in open contacts, to the bit."""
    for k in range(len(couplings.contact)):
        j = couplings.contact[k]
        if not work.couplings.status[j]:
            for i in range(couplings.range[j], couplings.range[j + 1]):
                # Newton's method leaves its rounding, which results would show as a force.
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
            # Shapes without ends cannot be entered sideways, so they need no memory.
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
def beyond_dent(couplings: Couplings, i: int, c: float, state: State) -> tuple[float, float]:
    """The same beyond the dent that earlier impacts have left there."""
    depth, side = penetration_of(couplings, i, c)
    return depth - permanent_of_row(couplings.laws, i, c, state), side
