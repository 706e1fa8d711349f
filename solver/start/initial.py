"""The state at t = 0: joints closed, velocities that fit them, then either equilibrium
(equilibrium.py) or, from bodies without elastic displacements,

    [ J   -B_r^T               ] [ v_dot ]   [ f_r - v~ J v                       ]
    [ B_r  B_a A_el B_a^T      ] [ lam   ] = [ -(phi_ddot at v_dot = 0) - B_a A_el p ]

A_el: the interface mobilities, p: the loads on interfaces. Source: docs/theory.md, The start.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import splu

from ..arrays import Array
from ..lower.allocation import allocate
from ..lower.lower import CompiledModel, compile_system
from ..model.model import Model
from ..step.equations import evaluate
from ..step.loads import load_vector
from ..step.newton import linearise
from ..step.rows import ROTATION
from ..step.system import State, System, Workspace
from .assembly import Wish, close_joints, fit_velocities
from .equilibrium import check_drives, check_steady, settle
from .inertia import interface_mobility, inverse_inertia
from .jacobian import constraint_jacobian, constraint_rows
from .redundancy import degrees_of_freedom as count_freedoms
from .redundancy import describe_rows, redundant_rows
from .steady import steady_motion


class Misfit(NamedTuple):
    """How far what a model gives is from satisfying its constraints, before anything is changed.

    The largest gap [m] and the joint it is at; the largest rate [m/s, rad/s] at which the
    velocities would open one. Rotations always meet: axes are given in space. Drives do not count
    among the rates.
    """

    opening: float
    opening_at: str
    velocity: float
    velocity_at: str


@dataclass(frozen=True, eq=False)
class Beginning:
    """A compiled model in its state at t = 0, and what it took to get there.

    moved: the largest difference between a given and the starting position [m] or rotation [rad];
    velocity_correction: the largest change of a velocity [m/s, rad/s]; removed: the redundant
    constraints left out, in words; degrees_of_freedom of the mechanism.
    """

    compiled: CompiledModel
    state: State
    work: Workspace
    misfit: Misfit
    moved: float
    velocity_correction: float
    removed: str
    degrees_of_freedom: int


def begin(model: Model) -> Beginning:
    """A state that satisfies positions, velocities and equilibrium at t = 0."""
    compiled = compile_system(model)
    state, work = allocate(compiled)
    misfit = _misfit(compiled, state, work)
    _close(compiled, state, work)
    degrees_of_freedom = count_freedoms(compiled, state, work)
    without = redundant_rows(compiled, state, work)
    removed = describe_rows(compiled, sorted(without))
    if without:
        compiled = compile_system(model, without)
        state, work = allocate(compiled)
        _close(compiled, state, work)
    loads, drive = _inputs(compiled)
    correction = 0.0
    if model.settings.start == "equilibrium":
        check_drives(compiled)
        rotation = model.settings.steady_rotation
        motion = None if rotation is None else steady_motion(rotation, compiled.system.scheme)
        settle(compiled, loads, drive, motion, state, work)
        check_steady(compiled, motion, state, work)
        state.coordinate[:] = work.coordinate
        _start_loaded(compiled, state)
    else:
        correction = fit_velocities(compiled, state, work, _wishes(compiled, "_rate"))
        _start_unloaded(compiled, loads, drive, state, work)
    _start_accounts(compiled.system, loads, drive, state, work)
    return Beginning(
        compiled,
        state,
        work,
        misfit,
        _moved(compiled, state),
        correction,
        removed,
        degrees_of_freedom,
    )


def _misfit(compiled: CompiledModel, state: State, work: Workspace) -> Misfit:
    couplings = compiled.system.couplings
    evaluate(compiled.system, *_inputs(compiled), state, work)
    hard = couplings.compliant == 0
    opening = np.abs(work.phi) * (hard & compiled.measures_lengths)
    velocity = np.abs(work.rate) * (hard & (couplings.drive < 0))
    return Misfit(*_largest(compiled, opening), *_largest(compiled, velocity))


def _largest(compiled: CompiledModel, values: Array) -> tuple[float, str]:
    """The largest of the values of all rows, and the joint or motion that it belongs to."""
    if not values.any():
        return 0.0, ""
    row = int(np.argmax(values))
    return float(values[row]), compiled.owner_of(row)


def _moved(compiled: CompiledModel, state: State) -> float:
    x, R = (
        np.array(given)
        for given in zip(*((pose.x, pose.R) for pose in compiled.poses), strict=True)
    )
    chord = np.linalg.norm(state.R - R, axis=(1, 2)) / np.sqrt(8.0)  # sin(turn / 2)
    turn = 2.0 * np.arcsin(np.minimum(chord, 1.0))
    return float(max(np.abs(state.x - x).max(), turn.max()))


def _close(compiled: CompiledModel, state: State, work: Workspace) -> None:
    close_joints(compiled, *_inputs(compiled), state, work, _wishes(compiled, ""))


def _inputs(compiled: CompiledModel) -> tuple[Array, Array]:
    """Loads and drives at t = 0."""
    loads = [signal.samples(np.zeros(1), compiled.h)[0] for signal in compiled.load_signals]
    return np.array(loads), np.array([signal(0.0) for signal in compiled.drives])


def _wishes(compiled: CompiledModel, suffix: str) -> list[Wish]:
    """What the joints shall start with: coordinates (no suffix) or their rates."""
    starts = {joint.name: joint.start for joint in compiled.model.joints}
    return [
        Wish(i, float(starts[joint][coordinate + suffix]))
        for i, (joint, coordinate) in enumerate(compiled.observers)
        if coordinate + suffix in starts[joint]
    ]


def _start_unloaded(
    compiled: CompiledModel, loads: Array, drive: Array, state: State, work: Workspace
) -> None:
    """Bodies start without elastic displacements; multipliers and accelerations take up the loads."""
    system = compiled.system
    evaluate(system, loads, drive, state, work)
    state.coordinate[:] = work.coordinate
    state.lam[:] -= (
        work.phi * system.couplings.compliant
    )  # phi of a force law is lambda less what the law says
    evaluate(system, loads, drive, state, work)
    linearise(system, loads, drive, state, work)
    v_dot, lam = _accelerations(compiled, drive, state, work)
    state.v_dot[:] = v_dot
    state.a[:] = v_dot
    state.lam[:] += lam
    evaluate(system, loads, drive, state, work)
    _start_history(compiled, state)


def _accelerations(
    compiled: CompiledModel, drive: Array, state: State, work: Workspace
) -> tuple[Array, Array]:
    """v_dot (n_b, 6) and the multipliers of the constraints (n_rows,), 0 for those of force laws,
    already at work.
    """
    system = compiled.system
    hard = constraint_rows(system)
    B_r, B_a = constraint_jacobian(system, state, work)
    A_el = interface_mobility(compiled)
    p = state.p[system.elastic.active]
    inverse = inverse_inertia(system)
    # with v_dot = 0 the residual of equilibrium is v~ J v - f_r
    free = -inverse @ work.residual.ravel()
    gap = _convective(compiled, drive, state, work) + B_a @ (A_el @ p) + B_r @ free
    schur = csr_array(B_r @ inverse @ B_r.T + B_a @ A_el @ B_a.T)
    scale = 1.0 / np.sqrt(np.maximum(schur.diagonal(), 1e-300))
    lam = np.zeros(len(state.lam))
    if len(hard):
        lam[hard] = -scale * splu(csc_array(scale[:, None] * schur * scale)).solve(scale * gap)
    v_dot = free + inverse @ (B_r.T @ lam[hard])
    return v_dot.reshape(-1, 6), lam


def _convective(compiled: CompiledModel, drive: Array, state: State, work: Workspace) -> Array:
    """The second time derivative of every constraint at v_dot = 0: centripetal terms and the
    drives.
    """
    couplings, frames = compiled.system.couplings, compiled.system.frames
    hard = constraint_rows(compiled.system)
    rows = couplings.rows
    A, B, rotation = rows.frame_a[hard], rows.frame_b[hard], rows.kind[hard] == ROTATION
    derivatives = [*(signal.derivatives(0.0) for signal in compiled.drives), (0.0, 0.0)]
    s_1, s_2 = np.array(derivatives)[couplings.drive[hard]].T[:, :, None]
    turn = np.where(rotation, np.append(drive, 0.0)[couplings.drive[hard]], 0.0)[:, None]
    spin, velocity, acceleration = work.V[:, 3:], work.V[:, :3], np.zeros((len(frames.body), 3))
    moving = frames.body >= 0
    arm = work.r[moving] - state.x[frames.body[moving]]
    acceleration[moving] = np.cross(spin[moving], np.cross(spin[moving], arm))

    a = _turned(work.D[A], np.cos(turn) * rows.a[hard] + np.sin(turn) * rows.a_turned[hard])
    a_1 = np.cross(spin[A], a)
    a_2 = np.cross(spin[A], a_1)
    lengths = _dot(a, acceleration[B] - acceleration[A]) + 2.0 * _dot(
        a_1, velocity[B] - velocity[A]
    )
    lengths += _dot(a_2, work.r[B] - work.r[A]) - s_2[:, 0]

    slope = _turned(work.D[A], np.cos(turn) * rows.a_turned[hard] - np.sin(turn) * rows.a[hard])
    a_1 += s_1 * slope
    a_2 += 2.0 * s_1 * np.cross(spin[A], slope) + s_2 * slope - s_1**2 * a
    b = _turned(work.D[B], rows.b[hard])
    b_1 = np.cross(spin[B], b)
    rotations = _dot(a_2, b) + 2.0 * _dot(a_1, b_1) + _dot(a, np.cross(spin[B], b_1))
    return np.where(rotation, rotations, lengths)


def _turned(D: Array, a: Array) -> Array:
    turned: Array = np.einsum("nij,nj->ni", D, a)
    return turned


def _dot(a: Array, b: Array) -> Array:
    product: Array = np.einsum("ni,ni->n", a, b)
    return product


def _start_history(compiled: CompiledModel, state: State) -> None:
    """The loads at t = 0 accelerate the modes at once; eq. (55) knows no initial loads."""
    elastic, scheme = compiled.system.elastic, compiled.system.scheme
    if scheme.weight != 1.0:
        return
    state.p_start[:] = state.p
    for e in range(len(elastic.body)):
        own = slice(elastic.dof[e], elastic.dof[e + 1])
        p = state.p[own]
        state.u_acceleration[own] = compiled.superelements[e].mobility @ p
        state.u_a[own] = state.u_acceleration[own]
        modes = slice(elastic.mode_range[e], elastic.mode_range[e + 1])
        if modes.start < modes.stop:
            state.eta_acceleration[modes] = _phi(compiled, e).T @ p
            state.eta_a[modes] = state.eta_acceleration[modes]


def _start_loaded(compiled: CompiledModel, state: State) -> None:
    """In equilibrium modes and displacements rest under the loads, which have always acted."""
    elastic = compiled.system.elastic
    for e in range(len(elastic.body)):
        own = slice(elastic.dof[e], elastic.dof[e + 1])
        p = state.p[own]
        state.u[own] = compiled.compliances[e] @ p
        state.elastic_energy[0] += 0.5 * p @ state.u[own]
        modes = slice(elastic.mode_range[e], elastic.mode_range[e + 1])
        if modes.start < modes.stop:
            state.eta[modes] = (_phi(compiled, e).T @ p) / elastic.stiffness[modes]
        else:
            start, n_c = elastic.G_0_start[e], len(p)
            G_0 = elastic.G_0[start : start + n_c * n_c].reshape(n_c, n_c)
            state.p_rest[own] = p
            state.history_rest[own] = state.u[own] - G_0 @ p


def _phi(compiled: CompiledModel, e: int) -> Array:
    """The modes of flexible body e at its interfaces (n_c, m)."""
    elastic = compiled.system.elastic
    n_c = int(elastic.dof[e + 1] - elastic.dof[e])
    m = int(elastic.mode_range[e + 1] - elastic.mode_range[e])
    start = int(elastic.phi_start[e])
    return elastic.phi[start : start + n_c * m].reshape(n_c, m)


def _start_accounts(
    system: System, loads: Array, drive: Array, state: State, work: Workspace
) -> None:
    state.load[:] = loads
    for m, (value, f) in enumerate(zip(loads, system.loads.frame, strict=True)):
        state.load_vector[m, :3] = load_vector(system.loads, m, value, work)
        work.load_position[m], work.load_axes[m] = work.r[f], work.D[f]
    state.drive[:] = drive
    for i, d in enumerate(system.couplings.drive.tolist()):
        if d >= 0:
            state.drive_force[d] = -state.lam[i] * work.drive_slope[i]
