"""The largest values of a run, by which its validity is judged (results/validity.py).

They are counted at every step, recorded or not, as squares where that saves a root. A run ends
where an interface turns or moves out of all range (`MAX_ELASTIC_ROTATION`,
`MAX_ELASTIC_DISPLACEMENT`).
"""

import math

from ..compiler.marks import compiled, entry
from ..compiler.memory import copy
from .axial import follow_axial_forces, start_axial_forces
from .bodies import rigid_energies, spin_of
from .body_extremes import follow_bodies, start_bodies
from .contacts import settle_contacts
from .couplings import spring_energy
from .force_laws import remember_laws
from .observers import start_coordinates
from .passages import start_places
from .records.couplings import Couplings
from .records.elastic import Elastic
from .records.extremes import ExtremeState
from .records.frames import Frames
from .second_order import inertia_taken, start_curvatures
from .system import State, System, Workspace
from .terms import keep_terms
from .vectors import dot, triple

MAX_ELASTIC_ROTATION = 0.5 * math.pi
"""elastic rotation of an interface where a run ends [rad]"""
MAX_ELASTIC_DISPLACEMENT = 1.0
"""elastic displacement of an interface over the size of its body where a run ends"""


@entry
def start_extremes(system: System, state: State, work: Workspace) -> None:
    """The extremes of the start, whose state was the last to be evaluated."""
    copy(work.couplings.coordinate, state.couplings.coordinate)
    copy(work.couplings.rate, state.couplings.rate)
    keep_terms(state, work)
    copy(state.modes.rate, work.modes.rate_n)
    copy(state.interfaces.rate, work.interfaces.rate_n)
    remember_laws(system.couplings.laws, state, work)
    settle_contacts(system.couplings, work)
    start_places(system.couplings, state, work)
    start_coordinates(system.observers, state, work)
    start_curvatures(system.elastic, state, work)
    energies, extremes = state.energies, state.extremes
    _set_energies(system, state, work)
    extremes.start[0] = _total(state)
    extremes.start[1] = energies.potential[0]
    for j in range(len(extremes.dissipated)):
        stored = spring_energy(system.couplings, j, state, work)
        extremes.dissipated[j] = -stored
        k = system.couplings.contact_of[j]
        if k >= 0:
            state.contacts.work_done[k] = stored
    start_bodies(system.bodies, state, work)
    start_axial_forces(system, state)
    _follow_state(system, state, work)


@compiled
def follow_extremes(system: System, state: State, work: Workspace) -> None:
    """Take the state at the end of a step into the extremes."""
    follow_bodies(system, state, work)
    _follow_state(system, state, work)


@compiled
def _follow_state(system: System, state: State, work: Workspace) -> None:
    _follow_frames(system.frames, system.elastic, state)
    _follow_spins(state)
    _follow_inertia(system.elastic, state, work)
    follow_axial_forces(system, state)
    _follow_constraints(system.couplings, state, work)
    # Changes over steps of two sizes cannot be summed.
    if system.scheme.stride == system.scheme.ratio:
        _follow_vibration(system.elastic, state, work)
    _set_energies(system, state, work)
    _follow_energies(system, state, work)


@compiled
def _follow_frames(frames: Frames, elastic: Elastic, state: State) -> None:
    extremes, u = state.extremes, state.interfaces.u
    for f in range(len(frames.dof)):
        dof = frames.dof[f]
        if dof < 0:
            continue
        move = triple(u, dof)
        displacement, rotation = dot(move, move), 0.0
        if frames.rotations[f]:
            turn = triple(u, dof + 3)
            rotation = dot(turn, turn)
        # Only a new extreme can leave the range, which saves the comparison in most steps.
        if displacement > extremes.displacement[f]:
            extremes.displacement[f] = displacement
            size = MAX_ELASTIC_DISPLACEMENT * elastic.size[elastic.of_body[frames.body[f]]]
            _leave(extremes, f, displacement > size * size)
        if rotation > extremes.rotation[f]:
            extremes.rotation[f] = rotation
            _leave(extremes, f, rotation > MAX_ELASTIC_ROTATION * MAX_ELASTIC_ROTATION)


@compiled
def _leave(extremes: ExtremeState, f: int, left: bool) -> None:
    """Note frame f if it is the first that has left the range."""
    if left and extremes.left[0] == 0:
        extremes.left[0] = f + 1


@compiled
def _follow_spins(state: State) -> None:
    spins = state.extremes.spin
    for b in range(len(spins)):
        omega = spin_of(state, b)
        spins[b] = max(spins[b], dot(omega, omega))


@compiled
def _follow_inertia(elastic: Elastic, state: State, work: Workspace) -> None:
    taken = state.extremes.inertia_taken
    for e in range(len(taken)):
        if elastic.second.r[e]:
            taken[e] = max(taken[e], inertia_taken(elastic, e, state, work))


@compiled
def _follow_constraints(couplings: Couplings, state: State, work: Workspace) -> None:
    openings, phi, compliant = state.extremes.opening, work.couplings.phi, couplings.compliant
    forces, lam = state.extremes.force, state.couplings.lam
    for i in range(len(openings)):
        if not compliant[i]:
            openings[i] = max(openings[i], abs(phi[i]))
            forces[i] = max(forces[i], abs(lam[i]))


@compiled
def _follow_vibration(elastic: Elastic, state: State, work: Workspace) -> None:
    """Sums of squares of rates and of their changes, which tell the frequencies of a motion."""
    rate, rate_n, extremes = state.modes.rate, work.modes.rate_n, state.extremes
    rates, changes = extremes.modal_rate, extremes.modal_change
    for i in range(len(rate)):
        rates[i] += rate[i] * rate[i]
    for i in range(len(rate)):
        changes[i] += (rate[i] - rate_n[i]) * (rate[i] - rate_n[i])
    for e in range(len(elastic.body)):
        # A body known by its kernel alone has no modes: its interfaces stand for them.
        if elastic.modes.range[e] == elastic.modes.range[e + 1]:
            for k in range(elastic.dof[e], elastic.dof[e + 1]):
                change = state.interfaces.rate[k] - work.interfaces.rate_n[k]
                extremes.interface_rate[k] += state.interfaces.rate[k] ** 2
                extremes.interface_change[k] += change * change


@compiled
def _set_energies(system: System, state: State, work: Workspace) -> None:
    kinetic, potential = rigid_energies(system.bodies, state, work)
    state.energies.kinetic[0] = kinetic
    state.energies.potential[0] = potential


@compiled
def _total(state: State) -> float:
    """What should stay constant: energies less the work that was done, springs apart."""
    energies = state.energies
    elastic = energies.modal[0] + energies.convolved[0] + energies.residual[0]
    done = energies.work[0] - energies.friction[0]
    return float(energies.kinetic[0] + energies.potential[0] + elastic - done)


@compiled
def _follow_energies(system: System, state: State, work: Workspace) -> None:
    """The balance, the energy that moves, and what springs and dampers take and give back."""
    energies, extremes = state.energies, state.extremes
    by_springs, turned_over = 0.0, 0.0
    for j in range(len(energies.compliance)):
        done = energies.compliance[j]
        by_springs += done
        # By magnitude: a spring that gives back what it took has still moved that energy.
        turned_over += abs(done)
        stored = spring_energy(system.couplings, j, state, work)
        taken = -done - stored
        extremes.stored[j] = max(extremes.stored[j], abs(stored))
        extremes.dissipated[j] = max(extremes.dissipated[j], taken)
        # A passive element never returns dissipated energy, so any fall is an error of the step.
        extremes.returned[j] = max(extremes.returned[j], extremes.dissipated[j] - taken)
    # What time stepping does in contacts of surfaces is known, as its damping of modes is.
    balance = _total(state) - energies.switching[0] - by_springs - extremes.start[0]
    extremes.balance[0] = max(extremes.balance[0], abs(balance))
    elastic = energies.modal[0] + energies.convolved[0] - energies.damping[0]
    turned_over += energies.friction[0]
    turned_over += abs(energies.work[0]) + abs(energies.potential[0] - extremes.start[1])
    moved = energies.kinetic[0] + abs(elastic) + turned_over
    extremes.moved[0] = max(extremes.moved[0], moved)
