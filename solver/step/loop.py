"""The time loop: generalized-alpha on the rotation group (docs/theory.md, The time step)."""

from ..compiler.marks import compiled, differentiable, entry
from ..compiler.memory import copy
from .bodies import finish_bodies, predict_bodies
from .contacts import approaches, is_closed, release_open, settle_contacts
from .couplings import add_coupling_work, expect_coordinates
from .events import is_full
from .extremes import follow_extremes
from .force_laws import remember_laws
from .frames import move_frame_velocities, move_frames
from .friction import keep_status
from .history import finish_history, flush_denormals, start_history
from .interfaces import add_elastic_work, finish_interfaces, predict_interfaces
from .loads import add_load_work
from .newton import converge, renew
from .observers import follow_coordinates
from .passages import follow_passages
from .patterns import add_pattern_work
from .record import record
from .surface_approach import approach_surfaces, follow_surface_passages
from .surface_motion import finish_surfaces, keep_places, keep_start
from .surface_results import add_up_surfaces, keep_velocities
from .surfaces import are_surfaces_closed, await_contacts
from .system import Inputs, Run, State, System, Workspace

OTHER_SIZE = -1.0
"""in place of a residual: the next step is one of the other size"""


@differentiable
@entry
def advance(run: Run, inputs: Inputs) -> tuple[int, float]:
    """Take one step per row of the inputs: the number of steps taken, the residual of the last.

    Fewer than asked where Newton's method failed, where a body left the range of linear elasticity,
    which `state.extremes.left` tells, or where the events of contacts are to be taken (`is_full`);
    of two sizes of steps also where those of the other are due (`OTHER_SIZE`), and where the last,
    which does not count, closed a contact in flight. In the last, which does not count either, a
    ball or a surface passed what it should meet where `state.contacts.passed` says so.
    """
    system, state, work, output = run.system, run.state, run.work, run.output
    n, residual = len(inputs.load), 0.0
    for k in range(n + inputs.ahead):
        if k > 0 and _is_other_size_due(system, state, work):
            return k, OTHER_SIZE
        if not state.prepared[0]:
            prepare(system, state, work)
        if k == n:
            break
        state.prepared[0] = 0
        copy(inputs.load[k], work.loads.value)
        copy(inputs.drive[k], work.drives.value)
        copy(inputs.motor[k], work.motors.value)
        work.couplings.elapsed[0] = system.scheme.h
        iterations, residual, converged = converge(system, state, work)
        if not converged:
            return k, residual
        _finish(system, state, work)
        # Such a step does not count: it is taken again with steps that resolve the contact.
        in_flight = system.scheme.stride > 1
        if state.contacts.passed[0] or (in_flight and _is_closed(system, work)):
            return k, residual
        row = inputs.row[k]
        # Steps that the output request leaves out have row -1.
        if row >= 0:
            output.newton_iterations[row] = iterations
            output.newton_residual[row] = residual
            record(run, row)
        # This step is whole and counts; the loop stops before the next one would be meaningless or
        # lose events.
        if state.extremes.left[0] or is_full(state.contacts):
            return k + 1, residual
    return n, residual


@compiled
def prepare(system: System, state: State, work: Workspace) -> None:
    """The beginning of a step that needs no inputs: its free response and a prediction.

    Where the number of iterations is fixed, the factors of their matrix too.
    """
    if system.newton.fixed_iterations > 0:
        move_frames(system.frames, system.frames.n_acting, state, work)  # as `record` does
        move_frame_velocities(system.frames, system.frames.n_acting, state, work)
        work.matrix.current[0] = int(renew(system, state, work))
    # Newton's method overwrites lam; works and a restart need that of the start of the step.
    copy(state.couplings.lam, work.couplings.lam_n)
    keep_status(system.couplings, work)
    expect_coordinates(system.couplings, system.scheme.h, state, work)
    keep_start(system, state, work)
    keep_velocities(system, state, work)
    keep_places(system, state, work)
    await_contacts(system, work)
    start_history(system.elastic, system.scheme, state, work)
    predict_bodies(system.scheme, state, work)
    predict_interfaces(system.scheme, state, work)
    state.prepared[0] = 1


@compiled
def _finish(system: System, state: State, work: Workspace) -> None:
    """Update all that a step carries on from its converged state."""
    release_open(system.couplings, state, work)
    # Before the works: they use the displacements that belong to the loads at the end of the step.
    finish_history(system, state, work)
    finish_bodies(system.scheme, state)
    finish_interfaces(system.scheme, state, work)
    finish_surfaces(system, state, work)
    add_up_surfaces(system, state, work)
    add_elastic_work(system.elastic, state, work)
    add_load_work(system.loads, state, work)
    add_pattern_work(system.patterns, state, work)
    follow_passages(system, state, work)
    follow_surface_passages(system, state, work)
    add_coupling_work(system.couplings, state, work)
    # After the works: it sets the elapsed time to zero, by which bristles and events are computed.
    remember_laws(system.couplings.laws, state, work)
    settle_contacts(system.couplings, work)
    follow_coordinates(system, state, work)
    follow_extremes(system, state, work)
    flush_denormals(state)
    state.step[0] += system.scheme.stride
    state.taken[0] += 1


@compiled
def _is_other_size_due(system: System, state: State, work: Workspace) -> bool:
    """Long steps end where a contact may close in the next one, short ones where none may."""
    scheme = system.scheme
    # Sizes change only at multiples of the long step, where both grids have a point.
    if scheme.ratio == 1 or state.step[0] % scheme.ratio != 0:
        return False
    longest = scheme.h * (scheme.ratio // scheme.stride)
    return is_contact_near(system, longest, state, work) == (scheme.stride > 1)


@differentiable
@entry
def is_contact_near(system: System, h: float, state: State, work: Workspace) -> bool:
    """Whether any contact is closed, or may be after a time h."""
    if approaches(system.couplings, h, state, work):
        return True
    return approach_surfaces(system, h, state, work)


@compiled
def _is_closed(system: System, work: Workspace) -> bool:
    return is_closed(system.couplings, work) or are_surfaces_closed(work)
