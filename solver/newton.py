"""Newton's method on the equations of a time step, with their exact tangent.

Unknowns: delta x and delta Theta of every body (dr), lambda, and the displacements u of the active interface dofs,
which are eliminated. K_ab: derivatives of the generalized forces, r rigid, a active; B: of the rows' coordinates; A: of
their residuals, A = B for a constraint, and lambda + stiffness c + ... = 0 for a spring, times h^2, whose Z is 1.

    du = E (K_ar dr + B_a^T dlam) + C^-1 r_u,     C = I - w G_0 K_aa,   E = C^-1 w G_0

    [ h^2 (S_rr - K_rr - K_ra E K_ar)   -(B_r^T + K_ra E B_a^T) ] [ dr       ]     [ h^2 (r_eq - K_ra C^-1 r_u) ]
    [ A_r + A_a E K_ar                   Z + A_a E B_a^T / h^2  ] [ h^2 dlam ] = - [ phi + A_a C^-1 r_u         ]

S_rr: inertia, with delta Theta = T(psi) delta psi. All blocks are of order one. Source: methods 5.4; u exactly.
"""

from .compiled import Array, compiled
from .couplings import add_couplings
from .dense import solve_in_place
from .frames import add_frame_tangents, map_frame_velocities, map_frames
from .history import instantaneous
from .loads import add_loads
from .rotations import (
    normalise,
    quaternion_exponential,
    quaternion_matrix,
    quaternion_product,
    tangent_inverse,
)
from .system import Bodies, Elastic, Scheme, State, System, Workspace
from .vectors import cross, rotate


@compiled
def correct(system: System, loads: Array, drive: Array, state: State, work: Workspace) -> bool:
    """One Newton iteration: solve for the corrections and apply them. False if the iteration matrix is singular."""
    linearise(system, loads, drive, state, work)
    assemble(system, state, work)
    if len(system.elastic.active) and not eliminate(system, work):
        return False
    if not solve_in_place(work.S, work.rhs):
        return False
    apply_correction(system, state, work)
    return True


@compiled
def linearise(system: System, loads: Array, drive: Array, state: State, work: Workspace) -> None:
    """K, B and A at the present state, which `evaluate` has seen last."""
    n_q = 6 * len(system.bodies.mass)
    map_frames(system.frames, state, work)
    if system.couplings.n_compliant:
        map_frame_velocities(system.frames, system.scheme.gamma_prime, work.psi, state, work)
    work.K[:] = 0.0
    work.B[:] = 0.0
    work.B_rate[:] = 0.0
    add_frame_tangents(system.frames, n_q, state, work)
    add_couplings(system.couplings, system.frames, n_q, system.scheme.h, state.lam, drive, work)
    add_loads(system.loads, system.frames, n_q, loads, work)


@compiled
def set_rotation(b: int, state: State, work: Workspace) -> None:
    """R = R_n exp(skew(psi)), from the quaternion at the start of the step."""
    increment, product = work.scratch_4, state.quaternion[b]
    quaternion_exponential(work.psi[b], increment)
    quaternion_product(work.quaternion[b], increment, product)
    normalise(product)
    quaternion_matrix(product, state.R[b])


@compiled
def assemble(system: System, state: State, work: Workspace) -> None:
    """S and rhs as if all bodies were rigid."""
    n_q, n_rows = 6 * len(system.bodies.mass), len(state.lam)
    h2 = system.scheme.h * system.scheme.h
    S, rhs, K, A, B = work.S, work.rhs, work.K, work.A, work.B
    S[:] = 0.0
    for i in range(n_q):
        for j in range(n_q):
            S[i, j] = -h2 * K[i, j]
        rhs[i, 0] = -h2 * work.residual[i // 6, i % 6]
    for i in range(n_rows):
        for j in range(n_q):
            S[n_q + i, j] = A[i, j]
            S[j, n_q + i] = -B[i, j]
        rhs[n_q + i, 0] = -work.phi[i]
        if system.couplings.compliant[i]:
            S[n_q + i, n_q + i] = 1.0
            rhs[n_q + i, 0] *= h2
    _add_inertia(system.bodies, system.scheme, state, work)


@compiled
def eliminate(system: System, work: Workspace) -> bool:
    """Add to S and rhs what the interface displacements do; EB becomes du / d(dr, h^2 dlam)."""
    n_q, n_rows, n_a = 6 * len(system.bodies.mass), len(work.phi), len(system.elastic.active)
    h2 = system.scheme.h * system.scheme.h
    S, rhs, K, A, B, E, EB = work.S, work.rhs, work.K, work.A, work.B, work.E, work.EB
    _flexibility(system.elastic, system.scheme, n_q, work)
    if not solve_in_place(work.C, E):
        return False
    EB[:] = 0.0
    for i in range(n_a):
        response = EB[i]
        for k in range(n_a):
            if E[i, k] != 0.0:
                for j in range(n_q):
                    response[j] += E[i, k] * K[n_q + k, j]
                for j in range(n_rows):
                    response[n_q + j] += E[i, k] / h2 * B[j, n_q + k]
    for i in range(n_q):
        for k in range(n_a):
            _add_row(-h2 * K[i, n_q + k], EB[k], E[k, n_a], S[i], rhs[i])
    for i in range(n_rows):
        for k in range(n_a):
            _add_row(A[i, n_q + k], EB[k], E[k, n_a], S[n_q + i], rhs[n_q + i])
    return True


@compiled
def _add_row(factor: float, response: Array, constant: float, row: Array, right: Array) -> None:
    if factor != 0.0:
        for j in range(len(row)):
            row[j] += factor * response[j]
        right[0] -= factor * constant


@compiled
def apply_correction(system: System, state: State, work: Workspace) -> None:
    """Add the corrections to u, lambda and the motion of the bodies."""
    n_q, n_a = 6 * len(system.bodies.mass), len(system.elastic.active)
    h2 = system.scheme.h * system.scheme.h
    for i in range(n_a):
        change = work.E[i, n_a]
        for j in range(len(work.rhs)):
            change += work.EB[i, j] * work.rhs[j, 0]
        state.u[system.elastic.active[i]] += change
    for i in range(len(state.lam)):
        state.lam[i] += work.rhs[n_q + i, 0] / h2
    for b in range(len(system.bodies.mass)):
        _move_body(b, system.scheme, state, work)


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
    S, D, T = work.S, work.frame_tangent, work.scratch_33
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
    T = work.scratch_33
    tangent_inverse(work.psi[b], T)
    first = 6 * b + 3
    x, y, z = work.rhs[first, 0], work.rhs[first + 1, 0], work.rhs[first + 2, 0]
    for i in range(3):
        dx = work.rhs[6 * b + i, 0]
        dpsi = T[i, 0] * x + T[i, 1] * y + T[i, 2] * z
        state.x[b, i] += dx
        state.v[b, i] += scheme.gamma_prime * dx
        state.v_dot[b, i] += scheme.beta_prime * dx
        work.psi[b, i] += dpsi
        state.v[b, 3 + i] += scheme.gamma_prime * dpsi
        state.v_dot[b, 3 + i] += scheme.beta_prime * dpsi
    set_rotation(b, state, work)
