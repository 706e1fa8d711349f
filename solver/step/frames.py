"""Frames: motion, wrenches on their bodies, and the chain rule between the two.

    r = x + R (X + u),   D = R exp(skew(w)) D_0
    delta r     = R (delta X - skew(X + u) delta Theta + delta u)           (in space)
    delta theta = R (delta Theta + T(w)^T delta w)                          (in space)

with delta X = R^T delta x, so that nothing but R changes when a body rotates. A force f and a
moment m on the frame, in space, F = R^T f and M = R^T m in body axes, load the body with

    F on X,   (X + u) x F + M on Theta,   F on u,   T(w) M on w.

Source: docs/theory.md, Frames, joints, loads, with the rotation of the frame turned to space:
D D_0^T W^T = R.
"""

from ..arrays import Array, Index
from ..compiler.marks import compiled
from .bodies import spin_of
from .records.frames import Frames
from .records.matrix import Pattern
from .rotations import exponential_and_tangent, tangent_derivative, tangent_inverse
from .system import State, Workspace
from .vectors import (
    UNIT_AXES,
    Vector,
    add,
    add_to_row,
    cross,
    magnitude,
    multiply,
    rotate,
    rotate_back,
    row,
    scale,
    subtract,
    triple,
)

Wrench = tuple[Vector, Vector]
"""force and moment, in space"""
Pair = tuple[int, int]
"""of frames A and B, by their numbers"""


@compiled
def move_frames(frames: Frames, n: int, state: State, work: Workspace) -> None:
    """Positions and axes of the first n frames."""
    for f in range(n):
        b = frames.body[f]
        # Frames fixed in space have been placed once, when the arrays were made.
        if b < 0:
            continue
        lever = row(frames.X, f)
        k = frames.dof[f]
        if k >= 0:
            lever = add(lever, triple(state.interfaces.u, k))
        r = add(row(state.bodies.x, b), rotate(state.bodies.R, b, lever))
        for i in range(3):
            work.frames.lever[f, i] = lever[i]
            work.frames.r[f, i] = r[i]
        if k >= 0 and frames.rotations[f]:
            w = state.interfaces.u[k + 3 : k + 6]
            # Both at once, since they share the trigonometric functions.
            exponential_and_tangent(w, work.frames.small_rotation, work.frames.T[f])
            _multiply(work.frames.small_rotation, frames.D_0[f], work.frames.D[f])
            _rotate_columns(state.bodies.R[b], work.frames.D[f])
        else:
            _multiply(state.bodies.R[b], frames.D_0[f], work.frames.D[f])


@compiled
def move_frame_velocities(frames: Frames, n: int, state: State, work: Workspace) -> None:
    """V = [R (omega x lever + du/dt) + dx/dt;  R (omega + T(w)^T dw/dt)] of the first n frames."""
    for f in range(n):
        b = frames.body[f]
        if b < 0:
            continue
        local, spin = local_velocity(frames, f, state, work)
        velocity = add(row(state.bodies.v, b), rotate(state.bodies.R, b, local))
        spin = rotate(state.bodies.R, b, spin)
        for i in range(3):
            work.frames.V[f, i] = velocity[i]
            work.frames.V[f, 3 + i] = spin[i]


@compiled
def local_velocity(frames: Frames, f: int, state: State, work: Workspace) -> tuple[Vector, Vector]:
    """In body axes: omega x lever + du/dt, and omega + T(w)^T dw/dt."""
    omega = spin_of(state, frames.body[f])
    velocity, spin = cross(omega, row(work.frames.lever, f)), omega
    k = frames.dof[f]
    if k >= 0:
        velocity = add(velocity, triple(state.interfaces.rate, k))
        if frames.rotations[f]:
            spin = add(spin, rotate_back(work.frames.T, f, triple(state.interfaces.rate, k + 3)))
    return velocity, spin


@compiled
def move_frame_accelerations(frames: Frames, n: int, state: State, work: Workspace) -> None:
    """A, the time derivative of V, of the first n frames."""
    for f in range(n):
        if frames.body[f] >= 0:
            linear, angular = frame_acceleration(frames, f, state, work)
            for i in range(3):
                work.frames.A[f, i] = linear[i]
                work.frames.A[f, 3 + i] = angular[i]


@compiled
def frame_acceleration(
    frames: Frames, f: int, state: State, work: Workspace
) -> tuple[Vector, Vector]:
    """The time derivative of V of a moving frame, in space.

    x'' + R (omega' x l + omega x (omega x l + 2 u') + u'')
    R (omega' + T^T w'' + (T^T)' w' + omega x T^T w')
    """
    b = frames.body[f]
    omega, v_dot = spin_of(state, b), state.bodies.v_dot
    alpha = v_dot[b, 3], v_dot[b, 4], v_dot[b, 5]
    lever = row(work.frames.lever, f)
    k = frames.dof[f]
    rate = triple(state.interfaces.rate, k) if k >= 0 else (0.0, 0.0, 0.0)
    local = add(cross(alpha, lever), cross(omega, add(cross(omega, lever), scale(2.0, rate))))
    angular = alpha
    if k >= 0:
        local = add(local, triple(state.interfaces.acceleration, k))
        if frames.rotations[f]:
            w_rate = triple(state.interfaces.rate, k + 3)
            _tangent_slope(state, k + 3, w_rate, work)
            slope = scale(-1.0, multiply(work.frames.T_slope, w_rate))
            w_acceleration = triple(state.interfaces.acceleration, k + 3)
            angular = add(angular, rotate_back(work.frames.T, f, w_acceleration))
            angular = add(angular, add(slope, cross(omega, rotate_back(work.frames.T, f, w_rate))))
    linear = add(row(v_dot, b), rotate(state.bodies.R, b, local))
    return linear, rotate(state.bodies.R, b, angular)


@compiled
def _tangent_slope(state: State, k: int, m: Vector, work: Workspace) -> None:
    """`work.frames.T_slope` = d(T(v) m)/dv at v = -w, for T(w)^T = T(-w)."""
    for i in range(3):
        work.frames.minus_w[i] = -state.interfaces.u[k + i]
        work.frames.moment[i] = m[i]
    tangent_derivative(work.frames.minus_w, work.frames.moment, work.frames.T_slope)


@compiled
def map_frame_velocities(frames: Frames, gamma_prime: float, state: State, work: Workspace) -> None:
    """Derivatives (6, 12) of V by the coordinates of frames.

        delta (dx/dt) = gamma' R delta X,   delta omega = gamma' T^-1(psi) delta Theta,
        delta (du/dt) = gamma' delta u

    gamma': change of a rate with its coordinate in a step.
    """
    for f in range(frames.n_acting):
        b = frames.body[f]
        if b < 0:
            continue
        rate_map = work.frames.rate_map[f]
        rate_map[:] = 0.0
        local, spin = local_velocity(frames, f, state, work)
        lever, omega = row(work.frames.lever, f), spin_of(state, b)
        tangent_inverse(work.bodies.psi[b], work.frames.T_inverse)
        for j in range(3):
            e = UNIT_AXES[j]
            d_omega = scale(gamma_prime, multiply(work.frames.T_inverse, e))
            by_rotation = rotate(state.bodies.R, b, add(cross(e, local), cross(d_omega, lever)))
            spin_by_rotation = rotate(state.bodies.R, b, add(cross(e, spin), d_omega))
            by_u = rotate(state.bodies.R, b, add(cross(omega, e), scale(gamma_prime, e)))
            for i in range(3):
                rate_map[i, j] = gamma_prime * state.bodies.R[b, i, j]
                rate_map[i, 3 + j] = by_rotation[i]
                rate_map[3 + i, 3 + j] = spin_by_rotation[i]
                rate_map[i, 6 + j] = by_u[i]
        k = frames.dof[f]
        if k >= 0 and frames.rotations[f]:
            _tangent_slope(state, k + 3, triple(state.interfaces.rate, k + 3), work)
            for j in range(3):
                e = UNIT_AXES[j]
                change = subtract(
                    scale(gamma_prime, rotate_back(work.frames.T, f, e)),
                    multiply(work.frames.T_slope, e),
                )
                by_w = rotate(state.bodies.R, b, change)
                for i in range(3):
                    rate_map[3 + i, 9 + j] = by_w[i]


@compiled
def load_bodies(frames: Frames, state: State, work: Workspace) -> None:
    """Generalized forces of the wrenches on the acting frames, on bodies and interfaces."""
    work.bodies.force[:] = 0.0
    for f in range(frames.n_acting):
        k = frames.dof[f]
        if k >= 0:
            state.interfaces.p[k : k + 3 + 3 * frames.rotations[f]] = 0.0
    for f in range(frames.n_acting):
        b = frames.body[f]
        if b < 0:
            continue
        force, moment = wrench_on(work, f)
        F, M = rotate_back(state.bodies.R, b, force), rotate_back(state.bodies.R, b, moment)
        about_center = cross(row(work.frames.lever, f), F)
        add_to_row(work.bodies.force, b, 0, force)
        add_to_row(work.bodies.force, b, 3, add(about_center, M))
        k = frames.dof[f]
        if k >= 0:
            # F loads the rigid motion and the deformation: both are coordinates of the body.
            _add(state.interfaces.p, k, F)
            if frames.rotations[f]:
                _add(state.interfaces.p, k + 3, rotate(work.frames.T, f, M))


@compiled
def add_wrench_scale(frames: Frames, f: int, wrench: Wrench, state: State, work: Workspace) -> None:
    """The magnitudes of a wrench on frame f, in space, join the force scales of its body."""
    b = frames.body[f]
    if b < 0:
        return
    force, moment = wrench
    about_center = cross(row(work.frames.lever, f), rotate_back(state.bodies.R, b, force))
    work.bodies.force_scale[b, 0] += magnitude(force)
    work.bodies.force_scale[b, 1] += magnitude(moment) + magnitude(about_center)


@compiled
def width(frames: Frames, f: int) -> int:
    """The number of coordinates of a frame: 0 in space, 6 rigid, 9 or 12 on an active interface."""
    if frames.body[f] < 0:
        return 0
    if frames.active[f] < 0:
        return 6
    return 9 + 3 * int(frames.rotations[f])


@compiled
def pull_back(
    frames: Frames, f: int, wrench: Wrench, state: State, work: Workspace, out: Array
) -> None:
    """Generalized forces (12,) on X, Theta, u and w of a wrench on frame f, in space.

    The transpose of the map of the frame.
    """
    b = frames.body[f]
    if b < 0:
        return
    force, moment = wrench
    F, M = rotate_back(state.bodies.R, b, force), rotate_back(state.bodies.R, b, moment)
    about_center = add(cross(row(work.frames.lever, f), F), M)
    small = rotate(work.frames.T, f, M)
    for i in range(3):
        out[i] = F[i]
        out[3 + i] = about_center[i]
        out[6 + i] = F[i]
        out[9 + i] = small[i]


@compiled
def pull_back_pair(
    frames: Frames, pair: Pair, gradient: Array, state: State, work: Workspace, out: Array
) -> None:
    """A derivative by (r, theta) of two frames (12,) as one by the coordinates of both (24,)."""
    first = triple(gradient, 0), triple(gradient, 3)
    second = triple(gradient, 6), triple(gradient, 9)
    pull_back(frames, pair[0], first, state, work, out[:12])
    pull_back(frames, pair[1], second, state, work, out[12:])


@compiled
def pull_back_tangent(frames: Frames, pair: Pair, H: Array, state: State, work: Workspace) -> None:
    """`pair_tangent` = map^T H map for H (12, 12) by (delta r, delta theta) of two frames."""
    half, tangent = work.frames.half_tangent, work.frames.pair_tangent
    for k in range(12):
        for f, n in ((pair[0], 0), (pair[1], 6)):
            pull_back(frames, f, _column(H, n, k), state, work, half[k, 2 * n : 2 * n + 12])
    for z in range(24):
        for f, n in ((pair[0], 0), (pair[1], 6)):
            pull_back(frames, f, _column(half, n, z), state, work, tangent[z, 2 * n : 2 * n + 12])


@compiled
def _column(H: Array, n: int, k: int) -> Wrench:
    """Rows n to n + 5 of column k."""
    return (H[n, k], H[n + 1, k], H[n + 2, k]), (H[n + 3, k], H[n + 4, k], H[n + 5, k])


@compiled
def add_frame_tangents(frames: Frames, pattern: Pattern, state: State, work: Workspace) -> None:
    """K += the derivative of the map of the frames, under wrenches held constant in space.

    d(f_Theta) = -F x du + ((X + u) x (F x .) + M x .) dTheta,   d(p_u) = F x dTheta
    d(p_w) = d(T(w) M)/dw dw + T(w) (M x dTheta)
    """
    for f in range(frames.n_acting):
        b = frames.body[f]
        if b < 0:
            continue
        start, stride = pattern.body_block[b, 0], pattern.body_block[b, 1]
        rotation = start + 3 * stride + 3
        force, moment = wrench_on(work, f)
        F, M = rotate_back(state.bodies.R, b, force), rotate_back(state.bodies.R, b, moment)
        lever = row(work.frames.lever, f)
        z = frames.column[f]
        small = z >= 0 and frames.rotations[f] == 1
        for j in range(3):
            e = UNIT_AXES[j]
            dF, dM = cross(F, e), cross(M, e)
            _add_to_column(work.matrix.S, rotation + j, stride, add(cross(lever, dF), dM))
            if z >= 0:
                # The lever contains u, so the moment on the body changes with the deformation.
                _add_to_column(work.matrix.S, start + 3 * stride + z + j, stride, scale(-1.0, dF))
                _add_to_column(work.matrix.S, start + z * stride + 3 + j, stride, dF)
            if small:
                by_rotation = rotate(work.frames.T, f, dM)
                target = start + (z + 3) * stride + 3 + j
                _add_to_column(work.matrix.S, target, stride, by_rotation)
        if small:
            k = frames.dof[f] + 3
            for i in range(3):
                work.frames.moment[i] = M[i]
            tangent_derivative(
                state.interfaces.u[k : k + 3], work.frames.moment, work.frames.T_slope
            )
            for i in range(3):
                target = start + (z + 3 + i) * stride + z + 3
                for j in range(3):
                    work.matrix.S[target + j] += work.frames.T_slope[i, j]


@compiled
def add_pair_tangent(
    frames: Frames, pair: Pair, tangent: Array, first: Pair, block: Index, work: Workspace
) -> None:
    """Add entries of a tangent to a block between the bodies of two frames.

    tangent: derivative of generalized forces by the coordinates of frames; first: row and column of
    its first entry for this pair; block (2,): place and stride of the block (`Pattern`).
    """
    f, g = pair
    for i in range(width(frames, f)):
        target = block[0] + block[1] * coordinate(frames, f, i)
        for j in range(width(frames, g)):
            column = coordinate(frames, g, j)
            work.matrix.S[target + column] += tangent[first[0] + i, first[1] + j]


@compiled
def coordinate(frames: Frames, f: int, i: int) -> int:
    """The number of coordinate i of frame f among those of its body."""
    return int(i if i < 6 else frames.column[f] + i - 6)


@compiled
def wrench_on(work: Workspace, f: int) -> Wrench:
    """Force and moment on frame f, in space."""
    w = work.frames.wrench
    return (w[f, 0], w[f, 1], w[f, 2]), (w[f, 3], w[f, 4], w[f, 5])


@compiled
def _add(a: Array, first: int, b: Vector) -> None:
    a[first] += b[0]
    a[first + 1] += b[1]
    a[first + 2] += b[2]


@compiled
def _add_to_column(S: Array, start: int, stride: int, a: Vector) -> None:
    S[start] += a[0]
    S[start + stride] += a[1]
    S[start + 2 * stride] += a[2]


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
