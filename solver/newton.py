"""The equations of a time step and their exact tangent.

Unknowns: delta x and delta Theta of every body, lambda, and the active interface displacements u, which are eliminated
(K_ab: derivatives of the generalized forces; r rigid, a active):

    h^2 (J v_dot + v~ J v - f_r) = 0         du = E (K_ar dr + B_a^T dlam) + C^-1 r_u,   C = I - w G_0 K_aa
    phi(x, R, u, t) = 0                      E = C^-1 w G_0,   r_u = history + w G_0 p - u
    u - history - w G_0 p(x, R, u, lam) = 0

    [ h^2 (S_rr - K_rr - K_ra E K_ar)   -(B_r + B_a E^T K_ra^T)^T ] [ dr       ]     [ h^2 (r_eq - K_ra C^-1 r_u) ]
    [ B_r + B_a E K_ar                   B_a E B_a^T / h^2        ] [ h^2 dlam ] = - [ phi + B_a C^-1 r_u         ]

Rotation increments psi follow from delta Theta = T(psi) delta psi. Source: methods 5.4; here u is eliminated exactly.
"""

from .compiled import Array, compiled
from .constraints import add_joints, evaluate_joints
from .dense import solve_in_place
from .frames import add_frame_tangents, load_bodies, map_frames, move_frames
from .history import instantaneous
from .loads import add_loads, evaluate_loads
from .rotations import (
    normalise,
    quaternion_exponential,
    quaternion_matrix,
    quaternion_product,
    tangent_inverse,
)
from .system import Bodies, Elastic, Scheme, State, System, Workspace
from .vectors import cross, rotate

ROUNDING = 64 * 2.2e-16


@compiled
def evaluate(system: System, loads: Array, drive: Array, state: State, work: Workspace) -> None:
    """Wrenches, generalized forces and residuals of the present state."""
    frames = system.frames
    move_frames(frames, frames.n_acting, state, work)
    work.wrench[:] = 0.0
    evaluate_loads(system.loads, loads, work)
    evaluate_joints(system.joints, state.lam, drive, work)
    load_bodies(frames, state, work)
    _equilibrium(system.bodies, state, work)
    _compatibility(system.elastic, system.scheme, state, work)


@compiled
def relative_residual(system: System, state: State, work: Workspace) -> float:
    """The largest residual over what the tolerance is measured against; at rounding level it returns 0.

    Equilibrium against the sum of the magnitudes of its terms; constraints and interface displacements against the
    largest motion of the step (translations in m, rotations in rad) and the rounding of positions.
    """
    scheme = system.scheme
    n_b = len(system.bodies.mass)
    length, angle, size, worst = 0.0, 0.0, 0.0, 0.0
    for b in range(n_b):
        for i in range(3):
            length = max(length, abs(scheme.h * state.v[b, i]) + abs(scheme.h * scheme.h * state.v_dot[b, i]))
            angle = max(angle, abs(work.psi[b, i]) + abs(scheme.h * scheme.h * state.v_dot[b, 3 + i]))
            size = max(size, abs(state.x[b, i]))
    for f in range(system.frames.n_acting):
        for i in range(3):
            size = max(size, abs(work.lever[f, i]))
    length += angle * size
    for b in range(n_b):
        for i in range(6):
            scale = work.force_scale[b, i // 3]
            r = abs(work.residual[b, i])
            if r > ROUNDING * scale and r > 1e-300:
                worst = max(worst, r / scale)
    for i in range(len(work.phi)):
        rotation = system.joints.rotation[i]
        worst = max(worst, _beyond(work.phi[i], angle if rotation else length, 1.0 if rotation else size, scheme))
    for i in range(len(work.u_residual)):
        worst = max(worst, _beyond(work.u_residual[i], length + angle, size, scheme))
    return worst


@compiled
def _beyond(residual: float, motion: float, size: float, scheme: Scheme) -> float:
    """A residual over the motion of the step, 0 where it is rounding of a quantity of the given size."""
    floor = ROUNDING * size
    return abs(residual) / max(motion, floor / scheme.tolerance) if abs(residual) > floor else 0.0


@compiled
def correct(system: System, loads: Array, drive: Array, state: State, work: Workspace) -> bool:
    """One Newton iteration: solve for the corrections and apply them. False if the iteration matrix is singular."""
    bodies, scheme, elastic = system.bodies, system.scheme, system.elastic
    n_q, n_rows, n_a = 6 * len(bodies.mass), len(state.lam), len(elastic.active)
    n = n_q + n_rows
    h2 = scheme.h * scheme.h
    K, B, C, E, EB, S, rhs = work.K, work.B, work.C, work.E, work.EB, work.S, work.rhs

    map_frames(system.frames, state, work)
    K[:] = 0.0
    B[:] = 0.0
    add_frame_tangents(system.frames, n_q, state, work)
    add_joints(system.joints, system.frames, n_q, work)
    add_loads(system.loads, system.frames, n_q, loads, work)

    for i in range(n_q):
        for j in range(n_q):
            S[i, j] = -h2 * K[i, j]
        for j in range(n_rows):
            S[i, n_q + j] = -B[j, i]
            S[n_q + j, i] = B[j, i]
        rhs[i, 0] = -h2 * work.residual[i // 6, i % 6]
    for i in range(n_rows):
        for j in range(n_rows):
            S[n_q + i, n_q + j] = 0.0
        rhs[n_q + i, 0] = -work.phi[i]
    _add_inertia(bodies, scheme, state, work)

    if n_a:
        _flexibility(elastic, scheme, n_q, work)
        if not solve_in_place(C, E):
            return False
        # EB: the response of du to dr and to dlam
        for i in range(n_a):
            for j in range(n):
                EB[i, j] = 0.0
            for k in range(n_a):
                factor = E[i, k]
                if factor != 0.0:
                    for j in range(n_q):
                        EB[i, j] += factor * K[n_q + k, j]
                    for j in range(n_rows):
                        EB[i, n_q + j] += factor * B[j, n_q + k] / h2
        for i in range(n_q):
            for k in range(n_a):
                factor = h2 * K[i, n_q + k]
                if factor != 0.0:
                    for j in range(n):
                        S[i, j] -= factor * EB[k, j]
                    rhs[i, 0] += factor * E[k, n_a]
        for i in range(n_rows):
            for k in range(n_a):
                factor = B[i, n_q + k]
                if factor != 0.0:
                    for j in range(n):
                        S[n_q + i, j] += factor * EB[k, j]
                    rhs[n_q + i, 0] -= factor * E[k, n_a]

    if not solve_in_place(S, rhs):
        return False

    for i in range(n_a):
        change = E[i, n_a]
        for j in range(n):
            change += EB[i, j] * rhs[j, 0]
        state.u[elastic.active[i]] += change
    for i in range(n_rows):
        state.lam[i] += rhs[n_q + i, 0] / h2
    for b in range(len(bodies.mass)):
        _move_body(b, scheme, state, work)
    return True


@compiled
def set_rotation(b: int, state: State, work: Workspace) -> None:
    """R = R_n exp(skew(psi)), from the quaternion at the start of the step."""
    increment, product = work.q_temp, state.quaternion[b]
    quaternion_exponential(work.psi[b], increment)
    quaternion_product(work.quaternion[b], increment, product)
    normalise(product)
    quaternion_matrix(product, state.R[b])


@compiled
def _equilibrium(bodies: Bodies, state: State, work: Workspace) -> None:
    """residual = J v_dot + v~ J v - f_r, with gravity in f_r."""
    for b in range(len(bodies.mass)):
        mass = bodies.mass[b]
        omega = (state.v[b, 3], state.v[b, 4], state.v[b, 5])
        momentum = rotate(bodies.J_rot, b, omega)
        gyroscopic = cross(omega, momentum)
        inertia = rotate(bodies.J_rot, b, (state.v_dot[b, 3], state.v_dot[b, 4], state.v_dot[b, 5]))
        for i in range(3):
            weight = mass * bodies.gravity[i]
            work.residual[b, i] = mass * state.v_dot[b, i] - weight - work.force[b, i]
            work.residual[b, 3 + i] = inertia[i] + gyroscopic[i] - work.force[b, 3 + i]
            work.force_scale[b, 0] += abs(mass * state.v_dot[b, i]) + abs(weight)
            work.force_scale[b, 1] += abs(inertia[i]) + abs(gyroscopic[i])


@compiled
def _compatibility(elastic: Elastic, scheme: Scheme, state: State, work: Workspace) -> None:
    """u_residual = history + w G_0 p - u at the active dofs."""
    for e in range(len(elastic.body)):
        first = elastic.dof[e]
        begin, end = elastic.active_range[e], elastic.active_range[e + 1]
        for i in range(begin, end):
            row = elastic.active[i]
            total = work.history[row] - state.u[row]
            for j in range(begin, end):
                k = elastic.active[j]
                total += scheme.weight * instantaneous(elastic, e, row - first, k - first) * state.p[k]
            work.u_residual[i] = total


@compiled
def _flexibility(elastic: Elastic, scheme: Scheme, n_q: int, work: Workspace) -> None:
    """C = I - w G_0 K_aa; E = [w G_0, r_u], to be multiplied by C^-1."""
    n_a = len(elastic.active)
    C, E, K = work.C, work.E, work.K
    E[:] = 0.0
    for e in range(len(elastic.body)):
        first = elastic.dof[e]
        begin, end = elastic.active_range[e], elastic.active_range[e + 1]
        for i in range(begin, end):
            for j in range(begin, end):
                G = instantaneous(elastic, e, elastic.active[i] - first, elastic.active[j] - first)
                E[i, j] = scheme.weight * G
    for i in range(n_a):
        for j in range(n_a):
            C[i, j] = 0.0
        C[i, i] = 1.0
        for k in range(n_a):
            if E[i, k] != 0.0:
                for j in range(n_a):
                    C[i, j] -= E[i, k] * K[n_q + k, n_q + j]
        E[i, n_a] = work.u_residual[i]


@compiled
def _add_inertia(bodies: Bodies, scheme: Scheme, state: State, work: Workspace) -> None:
    """S += h^2 S_rr with S_rr = beta' m I on x and (beta' J + gamma' (skew(w) J - skew(J w))) T^-1(psi) on Theta."""
    h2 = scheme.h * scheme.h
    S, D, T = work.S, work.frame_tangent, work.m_temp
    for b in range(len(bodies.mass)):
        J = bodies.J_rot[b]
        omega = (state.v[b, 3], state.v[b, 4], state.v[b, 5])
        momentum = rotate(bodies.J_rot, b, omega)
        for j in range(3):
            S[6 * b + j, 6 * b + j] += h2 * scheme.beta_prime * bodies.mass[b]
            e = (1.0 if j == 0 else 0.0, 1.0 if j == 1 else 0.0, 1.0 if j == 2 else 0.0)
            spin = cross(omega, (J[0, j], J[1, j], J[2, j]))
            turned = cross(momentum, e)
            for i in range(3):
                D[i, j] = scheme.beta_prime * J[i, j] + scheme.gamma_prime * (spin[i] - turned[i])
        tangent_inverse(work.psi[b], T)
        for i in range(3):
            for j in range(3):
                total = D[i, 0] * T[0, j] + D[i, 1] * T[1, j] + D[i, 2] * T[2, j]
                S[6 * b + 3 + i, 6 * b + 3 + j] += h2 * total


@compiled
def _move_body(b: int, scheme: Scheme, state: State, work: Workspace) -> None:
    """Apply the corrections of body b to position, rotation, velocity and acceleration, eqs (72)-(74)."""
    tangent_inverse(work.psi[b], work.m_temp)
    for i in range(3):
        dx = work.rhs[6 * b + i, 0]
        dpsi = 0.0
        for j in range(3):
            dpsi += work.m_temp[i, j] * work.rhs[6 * b + 3 + j, 0]
        state.x[b, i] += dx
        state.v[b, i] += scheme.gamma_prime * dx
        state.v_dot[b, i] += scheme.beta_prime * dx
        work.rhs[6 * b + i, 0] = dpsi
    for i in range(3):
        dpsi = work.rhs[6 * b + i, 0]
        work.psi[b, i] += dpsi
        state.v[b, 3 + i] += scheme.gamma_prime * dpsi
        state.v_dot[b, 3 + i] += scheme.beta_prime * dpsi
    set_rotation(b, state, work)
