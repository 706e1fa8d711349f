"""Frames: where they are, what a wrench on them means for their body, and the chain rule between the two.

    r = x + R (X + u),   D = R exp(skew(w)) D_0
    delta r     = delta x - R skew(X + u) delta Theta + R delta u           (in space)
    delta theta = R (delta Theta + T(w)^T delta w)                          (in space)

so that a force f and a moment m on the frame, in space, F = R^T f and M = R^T m in body axes, load the body with

    f on x,   (X + u) x F + M on Theta,   F on u,   T(w) M on w.

Source: methods 5.2, with the rotation of the frame turned from its own axes to space: D D_0^T W^T = R.
"""

from .compiled import Array, compiled
from .rotations import exponential, tangent, tangent_derivative, tangent_inverse
from .system import Frames, State, Workspace
from .vectors import Vector, add, add_to_row, cross, multiply, rotate, rotate_back, row, scale, subtract, triple


@compiled
def move_frames(frames: Frames, n: int, state: State, work: Workspace) -> None:
    """Positions and axes of the first n frames."""
    for f in range(n):
        b = frames.body[f]
        if b < 0:
            continue
        lever = row(frames.X, f)
        k = frames.dof[f]
        if k >= 0:
            lever = add(lever, (state.u[k], state.u[k + 1], state.u[k + 2]))
        r = add(row(state.x, b), rotate(state.R, b, lever))
        for i in range(3):
            work.lever[f, i] = lever[i]
            work.r[f, i] = r[i]
        if k >= 0 and frames.rotations[f]:
            w = state.u[k + 3 : k + 6]
            tangent(w, work.T[f])
            exponential(w, work.scratch_33)
            _multiply(work.scratch_33, frames.D_0[f], work.D[f])
            _rotate_columns(state.R[b], work.D[f])
        else:
            _multiply(state.R[b], frames.D_0[f], work.D[f])


@compiled
def move_frame_velocities(frames: Frames, n: int, state: State, work: Workspace) -> None:
    """V = [R (omega x lever + du/dt) + dx/dt;  R (omega + T(w)^T dw/dt)] of the first n frames."""
    for f in range(n):
        b = frames.body[f]
        if b < 0:
            continue
        local, spin = local_velocity(frames, f, state, work)
        velocity = add(row(state.v, b), rotate(state.R, b, local))
        spin = rotate(state.R, b, spin)
        for i in range(3):
            work.V[f, i] = velocity[i]
            work.V[f, 3 + i] = spin[i]


@compiled
def local_velocity(frames: Frames, f: int, state: State, work: Workspace) -> tuple[Vector, Vector]:
    """In body axes: omega x lever + du/dt, and omega + T(w)^T dw/dt."""
    omega = spin_of(state, frames.body[f])
    velocity, spin = cross(omega, row(work.lever, f)), omega
    k = frames.dof[f]
    if k >= 0:
        velocity = add(velocity, triple(state.u_rate, k))
        if frames.rotations[f]:
            spin = add(spin, rotate_back(work.T, f, triple(state.u_rate, k + 3)))
    return velocity, spin


@compiled
def frame_acceleration(frames: Frames, f: int, state: State, work: Workspace) -> tuple[Vector, Vector]:
    """The time derivative of V of a moving frame, in space.

    x'' + R (omega' x l + omega x (omega x l + 2 u') + u''),   R (omega' + T^T w'' + (T^T)' w' + omega x T^T w')
    """
    b = frames.body[f]
    omega, alpha = spin_of(state, b), (state.v_dot[b, 3], state.v_dot[b, 4], state.v_dot[b, 5])
    lever = row(work.lever, f)
    k = frames.dof[f]
    rate = triple(state.u_rate, k) if k >= 0 else (0.0, 0.0, 0.0)
    local = add(cross(alpha, lever), cross(omega, add(cross(omega, lever), scale(2.0, rate))))
    turning = alpha
    if k >= 0:
        local = add(local, triple(state.u_acceleration, k))
        if frames.rotations[f]:
            w_rate = triple(state.u_rate, k + 3)
            _tangent_slope(state, k + 3, w_rate, work)
            slope = scale(-1.0, multiply(work.scratch_33, w_rate))
            turning = add(turning, rotate_back(work.T, f, triple(state.u_acceleration, k + 3)))
            turning = add(turning, add(slope, cross(omega, rotate_back(work.T, f, w_rate))))
    return add(row(state.v_dot, b), rotate(state.R, b, local)), rotate(state.R, b, turning)


@compiled
def _tangent_slope(state: State, k: int, m: Vector, work: Workspace) -> None:
    """`work.scratch_33` = d(T(v) m)/dv at v = -w, for T(w)^T = T(-w)."""
    for i in range(3):
        work.scratch_3[i] = -state.u[k + i]
        work.scratch_3b[i] = m[i]
    tangent_derivative(work.scratch_3, work.scratch_3b, work.scratch_33)


@compiled
def map_frame_velocities(frames: Frames, gamma_prime: float, psi: Array, state: State, work: Workspace) -> None:
    """The derivatives (6, 12) of V by (delta x, delta Theta, delta u, delta w), with rates gamma' times increments.

    delta omega = gamma' T^-1(psi) delta Theta,   delta (du/dt) = gamma' delta u
    """
    for f in range(frames.n_acting):
        b = frames.body[f]
        if b < 0:
            continue
        A = work.rate_map[f]
        A[:] = 0.0
        local, spin = local_velocity(frames, f, state, work)
        lever, omega = row(work.lever, f), spin_of(state, b)
        tangent_inverse(psi[b], work.scratch_33)
        for j in range(3):
            e = (1.0 if j == 0 else 0.0, 1.0 if j == 1 else 0.0, 1.0 if j == 2 else 0.0)
            d_omega = scale(gamma_prime, multiply(work.scratch_33, e))
            by_turn = rotate(state.R, b, add(cross(e, local), cross(d_omega, lever)))
            spin_by_turn = rotate(state.R, b, add(cross(e, spin), d_omega))
            by_u = rotate(state.R, b, add(cross(omega, e), scale(gamma_prime, e)))
            A[j, j] = gamma_prime
            for i in range(3):
                A[i, 3 + j] = by_turn[i]
                A[3 + i, 3 + j] = spin_by_turn[i]
                A[i, 6 + j] = by_u[i]
        k = frames.dof[f]
        if k >= 0 and frames.rotations[f]:
            _tangent_slope(state, k + 3, triple(state.u_rate, k + 3), work)
            for j in range(3):
                e = (1.0 if j == 0 else 0.0, 1.0 if j == 1 else 0.0, 1.0 if j == 2 else 0.0)
                change = subtract(scale(gamma_prime, rotate_back(work.T, f, e)), multiply(work.scratch_33, e))
                by_w = rotate(state.R, b, change)
                for i in range(3):
                    A[3 + i, 9 + j] = by_w[i]


@compiled
def spin_of(state: State, b: int) -> Vector:
    return state.v[b, 3], state.v[b, 4], state.v[b, 5]


@compiled
def load_bodies(frames: Frames, state: State, work: Workspace) -> None:
    """Generalized forces of the wrenches on the acting frames: `work.force` on the bodies and `state.p`."""
    work.force[:] = 0.0
    work.force_scale[:] = 0.0
    for f in range(frames.n_acting):
        k = frames.dof[f]
        if k >= 0:
            state.p[k : k + 3 + 3 * frames.rotations[f]] = 0.0
    for f in range(frames.n_acting):
        b = frames.body[f]
        if b < 0:
            continue
        force, moment = wrench(work, f)
        F, M = rotate_back(state.R, b, force), rotate_back(state.R, b, moment)
        about_center = cross(row(work.lever, f), F)
        add_to_row(work.force, b, 0, force)
        add_to_row(work.force, b, 3, add(about_center, M))
        work.force_scale[b, 0] += abs(F[0]) + abs(F[1]) + abs(F[2])
        work.force_scale[b, 1] += abs(M[0]) + abs(M[1]) + abs(M[2])
        work.force_scale[b, 1] += abs(about_center[0]) + abs(about_center[1]) + abs(about_center[2])
        k = frames.dof[f]
        if k >= 0:
            _add(state.p, k, F)
            if frames.rotations[f]:
                _add(state.p, k + 3, rotate(work.T, f, M))


@compiled
def map_frames(frames: Frames, state: State, work: Workspace) -> None:
    """The maps (6, 12) from (delta x, delta Theta, delta u, delta w) to (delta r, delta theta) of the acting frames."""
    for f in range(frames.n_acting):
        b = frames.body[f]
        if b < 0:
            continue
        A = work.map[f]
        R = state.R[b]
        lever = row(work.lever, f)
        for i in range(3):
            A[i, i] = 1.0
            # row i of -R skew(lever) is lever x (row i of R)
            turned = cross(lever, row(R, i))
            for j in range(3):
                A[i, 3 + j] = turned[j]
                A[3 + i, 3 + j] = R[i, j]
                A[i, 6 + j] = R[i, j]
                A[3 + i, 9 + j] = 0.0
                if frames.rotations[f]:
                    for m in range(3):
                        A[3 + i, 9 + j] += R[i, m] * work.T[f, j, m]


@compiled
def width(frames: Frames, f: int) -> int:
    """The number of columns of the map of a frame: 0 in space, 6 rigid, 9 or 12 on an interface."""
    if frames.body[f] < 0:
        return 0
    if frames.active[f] < 0:
        return 6
    return 9 + 3 * int(frames.rotations[f])


@compiled
def column(frames: Frames, n_q: int, f: int, i: int) -> int:
    """The column of B and K where column i of the map of frame f belongs."""
    return int(6 * frames.body[f] + i if i < 6 else n_q + frames.active[f] + i - 6)


@compiled
def add_frame_tangents(frames: Frames, n_q: int, state: State, work: Workspace) -> None:
    """K += derivative of the map of the frames under their present wrenches, held constant in space.

    d(f_Theta) = -F x du + ((X + u) x (F x .) + M x .) dTheta,   d(p_u) = F x dTheta
    d(p_w) = d(T(w) M)/dw dw + T(w) (M x dTheta)
    """
    for f in range(frames.n_acting):
        b = frames.body[f]
        if b < 0:
            continue
        force, moment = wrench(work, f)
        F, M = rotate_back(state.R, b, force), rotate_back(state.R, b, moment)
        lever = row(work.lever, f)
        for j in range(3):
            e = (1.0 if j == 0 else 0.0, 1.0 if j == 1 else 0.0, 1.0 if j == 2 else 0.0)
            dF, dM = cross(F, e), cross(M, e)
            _add_to_column(work.K, 6 * b + 3, 6 * b + 3 + j, add(cross(lever, dF), dM), 1.0)
            if frames.active[f] >= 0:
                z = n_q + frames.active[f]
                _add_to_column(work.K, 6 * b + 3, z + j, dF, -1.0)
                _add_to_column(work.K, z, 6 * b + 3 + j, dF, 1.0)
                if frames.rotations[f]:
                    _add_to_column(work.K, z + 3, 6 * b + 3 + j, rotate(work.T, f, dM), 1.0)
        if frames.active[f] >= 0 and frames.rotations[f]:
            z = n_q + frames.active[f] + 3
            k = frames.dof[f] + 3
            for i in range(3):
                work.scratch_3[i] = M[i]
            tangent_derivative(state.u[k : k + 3], work.scratch_3, work.scratch_33)
            for i in range(3):
                for j in range(3):
                    work.K[z + i, z + j] += work.scratch_33[i, j]


@compiled
def add_pair_tangent(frames: Frames, n_q: int, f: int, g: int, first_f: int, first_g: int, work: Workspace) -> None:
    """K += A_f^T (the 6x6 block of `work.frame_tangent` at first_f, first_g) A_g."""
    n_f, n_g = width(frames, f), width(frames, g)
    if n_f == 0 or n_g == 0:
        return
    for i in range(6):
        for j in range(n_g):
            total = 0.0
            for m in range(6):
                total += work.frame_tangent[first_f + i, first_g + m] * work.map[g, m, j]
            work.product[i, j] = total
    for i in range(n_f):
        z = column(frames, n_q, f, i)
        for j in range(n_g):
            total = 0.0
            for m in range(6):
                total += work.map[f, m, i] * work.product[m, j]
            work.K[z, column(frames, n_q, g, j)] += total


@compiled
def wrench(work: Workspace, f: int) -> tuple[Vector, Vector]:
    w = work.wrench
    return (w[f, 0], w[f, 1], w[f, 2]), (w[f, 3], w[f, 4], w[f, 5])


@compiled
def _add(a: Array, first: int, b: Vector) -> None:
    a[first] += b[0]
    a[first + 1] += b[1]
    a[first + 2] += b[2]


@compiled
def _add_to_column(K: Array, i: int, j: int, a: Vector, sign: float) -> None:
    K[i, j] += sign * a[0]
    K[i + 1, j] += sign * a[1]
    K[i + 2, j] += sign * a[2]


@compiled
def _multiply(A: Array, B: Array, out: Array) -> None:
    for i in range(3):
        for j in range(3):
            out[i, j] = A[i, 0] * B[0, j] + A[i, 1] * B[1, j] + A[i, 2] * B[2, j]


@compiled
def _rotate_columns(R: Array, D: Array) -> None:
    """D <- R D"""
    for j in range(3):
        a, b, c = D[0, j], D[1, j], D[2, j]
        for i in range(3):
            D[i, j] = R[i, 0] * a + R[i, 1] * b + R[i, 2] * c
