"""The state at t = 0: positions as given, velocities made to fit the constraints, accelerations and multipliers.

    [ J   -B_r^T               ] [ v_dot ]   [ f_r - v~ J v                       ]
    [ B_r  B_a A_el B_a^T      ] [ lam   ] = [ -(phi_ddot at v_dot = 0) - B_a A_el p ]

A_el: the interface mobilities, p: the loads on interfaces. Elastic displacements and velocities start at zero.
Source: methods 5.4.
"""

from dataclasses import dataclass

import numpy as np

from .compilation import CompiledModel
from .compiled import Array
from .constraints import carried_axis
from .equations import evaluate
from .errors import ModelError
from .loads import load_vector
from .newton import linearise
from .rotations import quaternion_of
from .system import State, System, Workspace


@dataclass(frozen=True, eq=False)
class Beginning:
    """The state at t = 0, its workspace, and by how much the given velocities had to change [m/s, rad/s]."""

    state: State
    work: Workspace
    velocity_correction: float


def begin(compiled: CompiledModel) -> Beginning:
    """A state that satisfies positions, velocities and equilibrium at t = 0."""
    state, work = _allocate(compiled)
    loads = np.array([signal.samples(np.zeros(1), compiled.h)[0] for signal in compiled.load_signals])
    drive = np.array([signal(0.0) for signal in compiled.drives])
    system = compiled.system
    evaluate(system, loads, drive, state, work)
    linearise(system, loads, state, work)
    correction = _fit_velocities(compiled, state, work)
    evaluate(system, loads, drive, state, work)
    v_dot, lam = _accelerations(compiled, state, work)
    state.v_dot[:] = v_dot
    state.a[:] = v_dot
    state.lam[:] = lam
    evaluate(system, loads, drive, state, work)
    _start_history(compiled, state)
    _start_accounts(system, loads, drive, state, work)
    return Beginning(state, work, correction)


def _fit_velocities(compiled: CompiledModel, state: State, work: Workspace) -> float:
    """Project the velocities onto B_r v + phi_t = 0 in the metric of the mass; the largest change."""
    system = compiled.system
    n_q = 6 * len(system.bodies.mass)
    B = work.B[:, :n_q]
    rates = np.array([drive.derivatives(0.0)[0] for drive in compiled.drives])
    phi_t = np.array(
        [work.drive_slope[i] * rates[d] if d >= 0 else 0.0 for i, d in enumerate(system.joints.drive.tolist())]
    )
    # Least squares in L^-1 v with L L^T = J^-1, rows scaled: without squaring, light bodies cost no digits.
    L = np.linalg.cholesky(_inverse_inertia(system))
    scale = 1.0 / np.linalg.norm(B @ L, axis=1)
    gap = B @ state.v.ravel() + phi_t
    correction = -L @ np.linalg.lstsq(scale[:, None] * (B @ L), scale * gap, rcond=1e-11)[0]
    left = B @ (state.v.ravel() + correction) + phi_t
    if len(left) and np.abs(left).max() > 1e-8 * max(1.0, float(np.abs(phi_t).max())):
        row = int(np.argmax(np.abs(left)))
        joint = compiled.model.joints[int(np.searchsorted(system.joints.row, row, side="right")) - 1]
        raise ModelError(f"joint {joint.name!r}: no velocities of rigid motion satisfy it at the start")
    state.v[:] += correction.reshape(-1, 6)
    return float(np.abs(correction).max(initial=0.0))


def _accelerations(compiled: CompiledModel, state: State, work: Workspace) -> tuple[Array, Array]:
    system = compiled.system
    n_q, n_rows = 6 * len(system.bodies.mass), len(state.lam)
    B_r, B_a = work.B[:, :n_q], work.B[:, n_q:]
    A_el = _mobility(compiled)
    p = state.p[system.elastic.active]
    inverse = _inverse_inertia(system)
    # with v_dot = 0 the residual of equilibrium is v~ J v - f_r
    free = -inverse @ work.residual.ravel()
    gap = _convective(compiled, state, work) + B_a @ (A_el @ p) + B_r @ free
    schur = B_r @ inverse @ B_r.T + B_a @ A_el @ B_a.T
    scale = 1.0 / np.sqrt(np.maximum(np.diagonal(schur), 1e-300))
    scaled = schur * np.outer(scale, scale)
    if n_rows and (rank := int(np.linalg.matrix_rank(scaled, tol=1e-11, hermitian=True))) < n_rows:
        raise ModelError(f"joints: {n_rows} rows of which {rank} are independent: some constraints are redundant")
    lam = -scale * np.linalg.solve(scaled, scale * gap)
    v_dot = free + inverse @ (B_r.T @ lam)
    return v_dot.reshape(-1, 6), lam


def _inverse_inertia(system: System) -> Array:
    n_q = 6 * len(system.bodies.mass)
    inverse = np.zeros((n_q, n_q))
    for b, (mass, J_rot) in enumerate(zip(system.bodies.mass, system.bodies.J_rot, strict=True)):
        inverse[6 * b : 6 * b + 3, 6 * b : 6 * b + 3] = np.eye(3) / mass
        inverse[6 * b + 3 : 6 * b + 6, 6 * b + 3 : 6 * b + 6] = np.linalg.inv(J_rot)
    return inverse


def _mobility(compiled: CompiledModel) -> Array:
    """A_el of all active dofs (n_a, n_a)."""
    elastic = compiled.system.elastic
    A_el = np.zeros((len(elastic.active), len(elastic.active)))
    for e, element in enumerate(compiled.superelements):
        rows = slice(elastic.active_range[e], elastic.active_range[e + 1])
        dofs = elastic.active[rows] - elastic.dof[e]
        A_el[rows, rows] = element.mobility[np.ix_(dofs, dofs)]
    return A_el


def _convective(compiled: CompiledModel, state: State, work: Workspace) -> Array:
    """The second time derivative of every row at v_dot = 0 (n_rows,): centripetal terms and the drives."""
    joints, frames = compiled.system.joints, compiled.system.frames
    derivatives = [drive.derivatives(0.0) for drive in compiled.drives]
    drive = np.array([signal(0.0) for signal in compiled.drives])
    spin = np.zeros((len(frames.body), 3))
    velocity, acceleration = np.zeros_like(spin), np.zeros_like(spin)
    for f, b in enumerate(frames.body.tolist()):
        if b >= 0:
            arm = work.r[f] - state.x[b]
            spin[f] = state.R[b] @ state.v[b, 3:]
            velocity[f] = state.v[b, :3] + np.cross(spin[f], arm)
            acceleration[f] = np.cross(spin[f], np.cross(spin[f], arm))
    second = np.zeros(len(state.lam))
    for j, (A, B) in enumerate(zip(joints.frame_a, joints.frame_b, strict=True)):
        delta = work.r[B] - work.r[A]
        for i in range(joints.row[j], joints.row[j + 1]):
            in_a, slope_in_a, _ = carried_axis(joints, i, drive)
            a, slope = work.D[A] @ in_a, work.D[A] @ slope_in_a
            s_1, s_2 = derivatives[joints.drive[i]] if joints.drive[i] >= 0 else (0.0, 0.0)
            a_1, a_2 = np.cross(spin[A], a), np.cross(spin[A], np.cross(spin[A], a))
            if joints.rotation[i]:
                b = work.D[B] @ joints.b[i]
                b_1, b_2 = np.cross(spin[B], b), np.cross(spin[B], np.cross(spin[B], b))
                a_2 = a_2 + 2.0 * s_1 * np.cross(spin[A], slope) + s_2 * slope - s_1**2 * a
                a_1 = a_1 + s_1 * slope
                second[i] = a_2 @ b + 2.0 * a_1 @ b_1 + a @ b_2
            else:
                second[i] = a @ (acceleration[B] - acceleration[A]) + 2.0 * a_1 @ (velocity[B] - velocity[A])
                second[i] += a_2 @ delta - s_2
    return second


def _start_history(compiled: CompiledModel, state: State) -> None:
    """The loads at t = 0 accelerate the modes at once; eq. (55) knows no initial loads."""
    elastic, scheme = compiled.system.elastic, compiled.system.scheme
    if scheme.weight != 1.0:
        return
    if len(state.p_history):
        state.p_history[0] = state.p
    for e in range(len(elastic.body)):
        begin, end = elastic.mode_range[e], elastic.mode_range[e + 1]
        p = state.p[elastic.dof[e] : elastic.dof[e + 1]]
        start = elastic.phi_start[e]
        phi = elastic.phi[start : start + len(p) * (end - begin)].reshape(len(p), end - begin)
        state.eta_acceleration[begin:end] = phi.T @ p
        state.eta_a[begin:end] = phi.T @ p


def _start_accounts(system: System, loads: Array, drive: Array, state: State, work: Workspace) -> None:
    for m, value in enumerate(loads):
        state.load_vector[m, :3] = load_vector(system.loads, m, value, work)
    state.drive[:] = drive
    for i, d in enumerate(system.joints.drive.tolist()):
        if d >= 0:
            state.drive_force[d] = -state.lam[i] * work.drive_slope[i]


def _allocate(compiled: CompiledModel) -> tuple[State, Workspace]:
    system = compiled.system
    n_b, n_f, n_j = len(system.bodies.mass), len(system.frames.body), len(system.joints.frame_a)
    n_rows, n_l, n_d = len(system.joints.rotation), len(system.loads.frame), len(compiled.drives)
    n_u, n_a, n_modes = int(system.elastic.dof[-1]), len(system.elastic.active), len(system.elastic.stiffness)
    n_q = 6 * n_b
    directly = n_u > 0 and bool((np.diff(system.elastic.mode_range) == 0).any())
    starts = [body.start for body in compiled.model.bodies.values()]
    state = State(
        step=np.zeros(1, dtype=np.int64),
        x=np.array([pose.x for pose in compiled.poses]),
        quaternion=np.array([quaternion_of(pose.R) for pose in compiled.poses]),
        R=np.array([pose.R for pose in compiled.poses]),
        v=np.array([[*start.velocity, *start.angular_velocity] for start in starts]),
        v_dot=np.zeros((n_b, 6)),
        a=np.zeros((n_b, 6)),
        lam=np.zeros(n_rows),
        u=np.zeros(n_u),
        p=np.zeros(n_u),
        eta=np.zeros(n_modes),
        eta_rate=np.zeros(n_modes),
        eta_acceleration=np.zeros(n_modes),
        eta_a=np.zeros(n_modes),
        p_history=np.zeros((compiled.n_steps + 1 if directly else 0, n_u)),
        load_vector=np.zeros((n_l, 3)),
        drive=np.zeros(n_d),
        drive_force=np.zeros(n_d),
        elastic_energy=np.zeros(1),
        work=np.zeros(1),
    )
    work = Workspace(
        quaternion=state.quaternion.copy(),
        psi=np.zeros((n_b, 3)),
        u_n=np.zeros(n_u),
        p_n=np.zeros(n_u),
        load_position=np.zeros((n_l, 3)),
        load_axes=np.zeros((n_l, 3, 3)),
        r=np.array([pose.x for pose in compiled.frame_poses]).reshape(n_f, 3),
        D=np.array([pose.R for pose in compiled.frame_poses]).reshape(n_f, 3, 3),
        lever=np.zeros((n_f, 3)),
        T=np.tile(np.eye(3), (n_f, 1, 1)),
        wrench=np.zeros((n_f, 6)),
        phi=np.zeros(n_rows),
        gradient=np.zeros((n_rows, 12)),
        delta=np.zeros((n_j, 3)),
        joint_wrench=np.zeros((n_j, 6)),
        moment_tangent=np.zeros((n_j, 3, 3)),
        drive_slope=np.zeros(n_rows),
        force=np.zeros((n_b, 6)),
        force_scale=np.zeros((n_b, 2)),
        residual=np.zeros((n_b, 6)),
        history=np.zeros(n_u),
        u_residual=np.zeros(n_a),
        map=np.zeros((n_f, 6, 12)),
        frame_tangent=np.zeros((12, 12)),
        product=np.zeros((6, 12)),
        K=np.zeros((n_q + n_a, n_q + n_a)),
        B=np.zeros((n_rows, n_q + n_a)),
        C=np.zeros((n_a, n_a)),
        E=np.zeros((n_a, n_a + 1)),
        EB=np.zeros((n_a, n_q + n_rows)),
        S=np.zeros((n_q + n_rows, n_q + n_rows)),
        rhs=np.zeros((n_q + n_rows, 1)),
        scratch_3=np.zeros(3),
        scratch_4=np.zeros(4),
        scratch_4b=np.zeros(4),
        scratch_33=np.zeros((3, 3)),
    )
    return state, work
