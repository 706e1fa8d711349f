"""What happens in each contact from closing to opening, counted at every step."""

from ..compiler.marks import compiled
from .contacts import beyond_dent, penetration_of
from .gaps import contact_arm
from .records.contacts import ContactState
from .records.couplings import Couplings
from .rows import GAP
from .system import State, Workspace
from .vectors import dot

START, END, STEPS, PEAK, IMPULSE, CLOSING, OPENING, RESTITUTION, DISSIPATED = range(9)
"""columns of an event, those of `Events` in results/motion.py"""
MIN_PEAK_SHARE = 0.05
"""peak of an event over the largest peak of its contact below which the event only grazes"""


@compiled
def follow_contact(couplings: Couplings, j: int, state: State, work: Workspace) -> None:
    """Contact j from the start to the end of a step, whose work is counted already."""
    contacts, old, out = state.contacts, state.couplings, work.couplings
    k, i, h = couplings.contact_of[j], couplings.range[j], out.elapsed[0]
    closed, t = out.status[j] > 0, state.step[0] * h
    # Open before and after: most contacts in most steps.
    if not closed and not contacts.steps[k]:
        return
    before, side = beyond_dent(couplings, i, old.coordinate[i], state)
    after, new_side = beyond_dent(couplings, i, out.coordinate[i], state)
    # The gap is taken as linear within the step.
    crossing = t + h * min(max(before / (before - after), 0.0), 1.0) if before != after else t
    if closed and not contacts.steps[k]:
        begins = before <= 0.0  # or else it was closed at the start of the run
        contacts.begin[k] = crossing if begins else t
        contacts.closing_speed[k] = max(new_side * old.rate[i], 0.0) if begins else 0.0
        contacts.whole[k] = int(begins)
        contacts.work[k] = contacts.work_done[k]
        # The force at the start of the step counts for a contact that was closed at the start of
        # the run.
        contacts.peak[k], contacts.impulse[k] = abs(out.lam_n[i]), 0.0
    contacts.work_done[k] = state.energies.compliance[j]
    if closed:
        contacts.steps[k] += 1
        contacts.peak[k] = max(contacts.peak[k], abs(old.lam[i]))
        contacts.impulse[k] += h * abs(old.lam[i])
        contacts.total_impulse[k] += h * abs(old.lam[i])
        # The patch is that of the whole penetration, its dent included.
        depth, _ = penetration_of(couplings, i, out.coordinate[i])
        state.extremes.depth[k] = max(state.extremes.depth[k], depth)
        if couplings.rows.kind[i] == GAP:
            arm = contact_arm(couplings.rows, i, work)
            state.extremes.arm[k] = max(state.extremes.arm[k], dot(arm, arm))
    else:
        end_contact(state, k, crossing, max(-side * out.rate[i], 0.0))


@compiled
def end_contact(state: State, k: int, end: float, opening_speed: float) -> None:
    """Contact k as an event, which is over."""
    contacts = state.contacts
    n, closing_speed = contacts.n_events[0], contacts.closing_speed[k]
    event = contacts.event[n]
    contacts.event_contact[n] = k
    contacts.n_events[0] = n + 1
    contacts.ended[k] += 1
    # A contact that was closed from the start has no impact for the step to resolve.
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
    # A graze may last one step without harm; only hard impacts must be resolved.
    least = MIN_PEAK_SHARE * extremes.peak[k]
    first = extremes.shortest[k] == 0 or extremes.shortest_peak[k] < least
    if peak >= least and (first or steps < extremes.shortest[k]):
        extremes.shortest[k], extremes.shortest_peak[k] = steps, peak


@compiled
def is_full(contacts: ContactState) -> bool:
    """Whether the next step may end more contacts than there is room for."""
    return bool(contacts.n_events[0] + len(contacts.steps) > len(contacts.event_contact))
