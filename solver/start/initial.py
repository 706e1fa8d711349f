"""The state at t = 0: closed joints, consistent velocities, and accelerations or equilibrium.

Without equilibrium (equilibrium.py) bodies start without elastic displacements, and

    [ J   -B_r^T               ] [ v_dot ]   [ f_r - v~ J v                       ]
    [ B_r  B_a A_el B_a^T      ] [ lam   ] = [ -(phi_ddot at v_dot = 0) - B_a A_el p ]

A_el: the accelerance of interfaces, p: the loads on interfaces. Source: docs/theory.md, The start.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..checkpoint.file import StateFile
from ..errors import ModelError
from ..lower.allocation import allocate
from ..lower.lower import LoweredModel, lower
from ..model.model import Model
from ..model.speed_ratios import speed_ratios
from ..step.equations import convective_terms, evaluate, linearize
from ..step.extremes import start_extremes
from ..step.loads import load_vector
from ..step.patterns import keep_pattern
from ..step.second_order import add_curvatures, hardening_energy
from ..step.surface_rest import rest_on_surfaces
from ..step.system import State, System, Workspace
from .assembly import Target, assemble_joints, fit_velocities
from .equilibrium import solve_equilibrium
from .full_turns import continue_angles, turn_joints
from .given_velocities import lost_velocities
from .handover import hand_over, predecessor
from .inertia import elastic_accelerations, interface_accelerance, inverse_inertia
from .jacobian import constraint_jacobian, constraint_rows, row_rates
from .matrices import solve
from .penetration import check_depths, check_depths_of_surfaces, penetrations
from .redundancy import count_degrees_of_freedom, redundant_rows
from .removed import RemovedRows
from .servos import check_holding, set_poles
from .spins import check_spins
from .steady import SteadyMotion, continuous_motion, steady_motion
from .steady_checks import check_drives, check_steady


class AssemblyError(NamedTuple):
    """The errors of the constraints of a model as given, before assembly.

    opening: the largest gap [m], and its joint; velocity: the largest rate [m/s, rad/s] at which
    the velocities would open a joint, without those that are driven. Rotations always fit: axes are
    given in space.
    """

    opening: float
    opening_at: str
    velocity: float
    velocity_at: str


@dataclass(frozen=True, eq=False)
class InitialState:
    """A lowered model in its state at t = 0, and the changes made to reach it.

    moved: the largest difference between a given and the starting position [m] or rotation [rad];
    velocity_correction: the largest change of a velocity [m/s, rad/s]; removed: the redundant
    constraints left out; degrees_of_freedom of the mechanism; warnings: of contacts that start
    closed.
    """

    lowered: LoweredModel
    state: State
    work: Workspace
    assembly_error: AssemblyError
    moved: float
    velocity_correction: float
    removed: RemovedRows
    degrees_of_freedom: int
    warnings: tuple[str, ...] = ()


def lower_to_start(model: Model) -> tuple[LoweredModel, StateFile | None]:
    """A lowered model, and the state of another run from which it starts, if there is one."""
    source = predecessor(model)
    return lower(model, earlier=source.identity.horizon if source else None), source


def initialize(
    model: Model,
    lowered: LoweredModel | None = None,
    source: StateFile | None = None,
    *,
    continuous: bool = False,
) -> InitialState:
    """A state that satisfies positions, velocities and equilibrium at t = 0.

    lowered: the model as `lower` gave it, where the caller has it; source: the state of another run
    from which it starts, if there is one; continuous: in a steady rotation as it is, not as the
    scheme steps it. What can be checked without compiled code is checked before any of it is
    called.
    """
    lowered = lowered or lower(model)
    if source is not None:
        return _go_on(lowered, source)
    in_equilibrium = model.settings.start == "equilibrium"
    if in_equilibrium:
        # Before anything is compiled: a wrong model should fail at once.
        check_drives(lowered)
    state, work = _allocated(lowered)
    error = _assembly_error(lowered, state, work)
    assemble_joints(lowered, state, work, _targets(lowered, ""))
    degrees_of_freedom = count_degrees_of_freedom(lowered, state, work)
    without = redundant_rows(lowered, state, work)
    removed = RemovedRows(lowered, sorted(without))
    if without:
        # Numbers of rows have changed: all arrays are made anew, and joints closed again.
        lowered = lower(model, without)
        state, work = _allocated(lowered)
        assemble_joints(lowered, state, work, _targets(lowered, ""))
    continue_angles(lowered, state, work)
    correction = 0.0
    closed: tuple[str, ...] = ()
    if in_equilibrium:
        motion = _steady_motion(lowered, continuous)
        at_rest = solve_equilibrium(lowered, motion, state, work)
        check_holding(lowered, state)
        turn_joints(lowered, state, work)
        # Only now the pose is known in which rates must vanish.
        check_steady(lowered, motion, work)
        _start_loaded(lowered, state, work)
        rest_on_surfaces(at_rest, state, work)
    else:
        evaluate(lowered.system, state, work)
        check_depths(lowered, work)
        # Velocities after positions: the Jacobian is that of closed joints.
        correction = fit_velocities(lowered, state, work, _targets(lowered, "_rate"))
        evaluate(lowered.system, state, work)
        check_spins(lowered, work)
        _start_unloaded(lowered, state, work)
        closed = (
            *penetrations(lowered, state, work),
            *check_depths_of_surfaces(lowered, state, work),
            *lost_velocities(lowered, state),
        )
    _start_work(lowered.system, state, work)
    start_extremes(lowered.system, state, work)
    set_poles(lowered, state, work)
    moved = _moved(lowered, state)
    return InitialState(
        lowered, state, work, error, moved, correction, removed, degrees_of_freedom, closed
    )


def _steady_motion(lowered: LoweredModel, continuous: bool) -> SteadyMotion | None:
    rotation = lowered.model.settings.steady_rotation
    if rotation is None:
        return None
    ratios = np.array(list(speed_ratios(lowered.model, rotation).values()))
    if continuous:
        return continuous_motion(rotation, ratios)
    return steady_motion(rotation, ratios, lowered.system.scheme)


def _go_on(lowered: LoweredModel, source: StateFile) -> InitialState:
    """The state of another run, as far as the model has its bodies."""
    step = source.snapshot.step
    state, work = _allocated(lowered, step)
    hand_over(lowered, source, state, work)
    linearize(lowered.system, state, work)
    degrees_of_freedom = count_degrees_of_freedom(lowered, state, work)
    without = redundant_rows(lowered, state, work)
    removed = RemovedRows(lowered, sorted(without))
    if without:
        lowered = lower(lowered.model, without, lowered.horizon)
        state, work = _allocated(lowered, step)
        hand_over(lowered, source, state, work)
    _start_work(lowered.system, state, work)
    start_extremes(lowered.system, state, work)
    set_poles(lowered, state, work)
    closed = AssemblyError(0.0, "", 0.0, "")
    return InitialState(lowered, state, work, closed, 0.0, 0.0, removed, degrees_of_freedom)


def _allocated(lowered: LoweredModel, step: int = 0) -> tuple[State, Workspace]:
    """A state with bodies in their given poses, and loads and drives at a step."""
    state, work = allocate(lowered)
    t = lowered.h * np.full(1, step, dtype=np.float64)
    work.loads.value[:] = [signal.samples(t, lowered.h)[0] for signal in lowered.load_signals]
    work.drives.value[:] = [signal(float(t[0])) for signal in lowered.drives]
    work.motors.value[:] = [signal.samples(t, lowered.h)[0] for signal in lowered.motor_signals]
    for d, drive in enumerate(lowered.drives):
        work.drives.rate[d], work.drives.acceleration[d] = drive.derivatives(float(t[0]))
    _check_values(lowered, work)
    return state, work


def _check_values(lowered: LoweredModel, work: Workspace) -> None:
    """ModelError for a drive that is no number at the start."""
    drives = work.drives
    finite = np.isfinite([drives.value, drives.rate, drives.acceleration]).all(axis=0)
    for d in np.flatnonzero(~finite):
        values = ", ".join(f"{v[d]:g}" for v in (drives.value, drives.rate, drives.acceleration))
        row = int(lowered.system.couplings.driven[d])
        raise ModelError(
            f"{lowered.owner_of(row)}: expected finite values of its drive and of both "
            f"derivatives at the start, found {values}"
        )


def _assembly_error(lowered: LoweredModel, state: State, work: Workspace) -> AssemblyError:
    couplings = lowered.system.couplings
    evaluate(lowered.system, state, work)
    hard = couplings.compliant == 0
    opening = np.abs(work.couplings.phi) * (hard & lowered.measures_lengths)
    velocity = np.abs(row_rates(couplings, work)) * (hard & (couplings.drive < 0))
    return AssemblyError(*_largest(lowered, opening), *_largest(lowered, velocity))


def _largest(lowered: LoweredModel, values: Array) -> tuple[float, str]:
    """The largest of the values of all rows, and its joint or motion."""
    if not values.any():
        return 0.0, ""
    row = int(np.argmax(values))
    return float(values[row]), lowered.owner_of(row)


def _moved(lowered: LoweredModel, state: State) -> float:
    """The largest difference to a given position [m] or rotation [rad]."""
    x = np.array([pose.x for pose in lowered.poses])
    R = np.array([pose.R for pose in lowered.poses])
    chord = np.linalg.norm(state.bodies.R - R, axis=(1, 2)) / np.sqrt(8.0)  # sin(angle / 2)
    angle = 2.0 * np.arcsin(np.minimum(chord, 1.0))
    return float(max(np.abs(state.bodies.x - x).max(), angle.max()))


def _targets(lowered: LoweredModel, suffix: str) -> list[Target]:
    """Joint coordinates at the start (no suffix) or their rates."""
    joints = {joint.name: joint for joint in lowered.model.joints}
    return [
        Target(i, float(joints[joint].start[coordinate + suffix]))
        for i, (joint, coordinate) in enumerate(lowered.observers)
        if coordinate + suffix in joints[joint].start and coordinate not in joints[joint].drives
    ]


def _start_unloaded(lowered: LoweredModel, state: State, work: Workspace) -> None:
    """Set multipliers and accelerations at t = 0, for bodies without elastic displacements."""
    system = lowered.system
    evaluate(system, state, work)
    # phi of a force law is lambda less the force of the law
    state.couplings.lam[:] -= work.couplings.phi * system.couplings.compliant
    state.couplings.lam[system.couplings.laws.motors.row] = work.motors.torque
    evaluate(system, state, work)
    linearize(system, state, work)
    v_dot, lam = _accelerations(lowered, state, work)
    state.bodies.v_dot[:] = v_dot
    state.bodies.a[:] = v_dot
    state.couplings.lam[:] += lam
    evaluate(system, state, work)
    _start_history(lowered, state)


def _accelerations(lowered: LoweredModel, state: State, work: Workspace) -> tuple[Array, Array]:
    """v_dot (n_b, 6), and the multipliers of constraints (n_rows,), 0 for those of force laws."""
    system = lowered.system
    hard = constraint_rows(system)
    B_r, B_a = constraint_jacobian(system, state, work)
    A_el = interface_accelerance(lowered)
    inverse = inverse_inertia(system)
    # with v_dot = 0 the residual of equilibrium is v~ J v - f_r
    free = -inverse @ work.bodies.residual.ravel()
    lam = np.zeros(len(state.couplings.lam))
    if len(hard):
        convective_terms(system, state, work)
        gap = (
            work.couplings.convective[hard]
            + B_a @ elastic_accelerations(lowered, state.interfaces.p)
            + B_r @ free
        )
        schur = B_r @ inverse @ B_r.T + B_a @ A_el @ B_a.T
        scale = 1.0 / np.sqrt(np.maximum(schur.diagonal(), 1e-300))
        # Rows in N and N m differ by many digits: scaled, the complement has a unit diagonal.
        lam[hard] = -scale * solve(scale[:, None] * schur * scale, scale * gap)
    # Of the saddle-point system the Schur complement is small: it has as many rows as constraints.
    v_dot = free + inverse @ (B_r.T @ lam[hard])
    return v_dot.reshape(-1, 6), lam


def _start_history(lowered: LoweredModel, state: State) -> None:
    """The loads at t = 0 accelerate the modes at once, but not in eq. (55)."""
    elastic, scheme = lowered.system.elastic, lowered.system.scheme
    # Equation (55) weighs the load at t = 0 by half: there nothing acts at once.
    if scheme.weight != 1.0:
        return
    state.past.p_start[:] = state.interfaces.p
    for e in range(len(elastic.body)):
        dofs = slice(elastic.dof[e], elastic.dof[e + 1])
        p = state.interfaces.p[dofs]
        state.interfaces.acceleration[dofs] = lowered.responses.accelerances[e] @ p
        state.interfaces.a[dofs] = state.interfaces.acceleration[dofs]
        modes = slice(elastic.modes.range[e], elastic.modes.range[e + 1])
        if modes.start < modes.stop:
            state.modes.acceleration[modes] = modes_of(lowered, e).T @ p
            state.modes.a[modes] = state.modes.acceleration[modes]


def _start_loaded(lowered: LoweredModel, state: State, work: Workspace) -> None:
    """Set modes and displacements at rest under the loads, which have always acted."""
    elastic = lowered.system.elastic
    for e in range(len(elastic.body)):
        dofs = slice(elastic.dof[e], elastic.dof[e + 1])
        p = state.interfaces.p[dofs]
        state.interfaces.u[dofs] = lowered.responses.compliances[e] @ p
        energy = 0.5 * p @ state.interfaces.u[dofs]
        energy += hardening_energy(elastic, e, state.interfaces.u)
        modes = slice(elastic.modes.range[e], elastic.modes.range[e + 1])
        if modes.start < modes.stop:
            state.energies.modal[0] += energy
            state.modes.eta[modes] = (modes_of(lowered, e).T @ p) / elastic.modes.stiffness[modes]
        else:
            state.energies.convolved[0] += energy
            start, n_c = elastic.G_0_start[e], len(p)
            G_0 = elastic.G_0[start : start + n_c * n_c].reshape(n_c, n_c)
            state.past.p_rest[dofs] = p
            # The past of a static load is one number per dof: its whole history without the present
            # step.
            state.past.u_rest[dofs] = state.interfaces.u[dofs] - G_0 @ p
    add_curvatures(elastic, state, work)


def modes_of(lowered: LoweredModel, e: int) -> Array:
    """The modes of flexible body e at its interfaces (n_c, m)."""
    elastic = lowered.system.elastic
    n_c = int(elastic.dof[e + 1] - elastic.dof[e])
    m = int(elastic.modes.range[e + 1] - elastic.modes.range[e])
    start = int(elastic.modes.phi_start[e])
    return elastic.modes.phi[start : start + n_c * m].reshape(n_c, m)


def _start_work(system: System, state: State, work: Workspace) -> None:
    """Loads, drives and their forces at t = 0, from which their work is counted."""
    loads = state.loads
    loads.value[:] = work.loads.value[: len(loads.value)]
    for m, f in enumerate(system.loads.frame.tolist()):
        loads.vector[m] = load_vector(system.loads, m, work)
        loads.position[m], loads.axes[m] = work.frames.r[f], work.frames.D[f]
    for t in range(len(system.patterns.body)):
        keep_pattern(system.patterns, t, state, work)
    state.drives.value[:] = work.drives.value
    state.drives.force[:] = -state.couplings.lam[system.couplings.driven] * work.drives.slope
