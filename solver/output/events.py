"""The contacts that have ended, as the time loop hands them over, and those that have not."""

import numpy as np

from ...results.batches import EventRows
from ...results.motion import EVENT_QUANTITIES
from ..arrays import Array, Index
from ..lower.lower import LoweredModel
from ..step.couplings import spring_energy
from ..step.system import State, Workspace

EVENT_COLUMNS = [quantity.attribute for quantity in EVENT_QUANTITIES]


def waiting(state: State) -> EventRows:
    """The events that wait in a state."""
    contacts = state.contacts
    n = int(contacts.n_events[0])
    return EventRows(contacts.event_contact[:n].copy(), contacts.event[:n].copy())


def taken(state: State) -> EventRows:
    """The events that wait in a state, which are removed from it."""
    events = waiting(state)
    state.contacts.n_events[0] = 0
    return events


def unfinished(lowered: LoweredModel, state: State, work: Workspace) -> EventRows:
    """Contacts that are closed, as if they ended now: what only an opening tells is no number."""
    contacts, couplings = state.contacts, lowered.system.couplings
    closed = np.flatnonzero(contacts.steps)
    # What only the opening tells, as the speed of separation, stays nan.
    values = np.full((len(closed), len(EVENT_COLUMNS)), np.nan)
    # Contacts of surfaces, the last ones, store nothing themselves.
    stored = np.zeros(len(closed))
    for at, k in enumerate(closed[closed < len(couplings.contact)].tolist()):
        stored[at] = spring_energy(couplings, int(couplings.contact[k]), state, work)
    known: dict[str, Array | Index] = {
        "start": contacts.begin[closed],
        "end": np.full(len(closed), lowered.h * state.step[0]),
        "steps": contacts.steps[closed],
        "peak": contacts.peak[closed],
        "impulse": contacts.impulse[closed],
        "closing_speed": contacts.closing_speed[closed],
        # The contact still stores energy, which is not lost: its work less that.
        "dissipated": (contacts.work - contacts.work_done)[closed] - stored,
    }
    for name, column in known.items():
        values[:, EVENT_COLUMNS.index(name)] = column
    return EventRows(closed.astype(np.int64), values)
