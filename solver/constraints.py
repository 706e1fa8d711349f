"""The primitive rows of joints between frames A and B, their wrenches and the tangent of those.

With a = D_A a_A and b = D_B b_B carried by the frames, and Delta = r_B - r_A:

    translation:  phi = a . Delta - d(t)     gradient: r_A: -a,  theta_A: a x Delta,  r_B: a
    rotation:     phi = a . b                gradient: theta_A: a x b,  theta_B: -a x b

`a` of a driven rotation row turns with the drive: cos(s) a + sin(s) a'. The wrench on a frame is gradient^T lambda,
for L + lambda^T phi. With f = sum lambda a over translation rows and n = sum lambda a x b, N = sum lambda skew(b)
skew(a) over rotation rows, all in space, the whole joint gives (A: -f, f x Delta + n; B: f, -n) and

    df = dtheta_A x f,   dn = N dtheta_A - N^T dtheta_B.                            Source: methods 5.3.
"""

import math

from .compiled import Array, compiled
from .frames import add_pair_tangent, column, width
from .system import Frames, Joints, Workspace
from .vectors import Vector, add, add_to_row, cross, dot, rotate, row, scale, subtract


@compiled
def carried_axis(joints: Joints, i: int, drive: Array) -> tuple[Vector, Vector, float]:
    """The axis of row i in frame A, its derivative with respect to the drive, and the driven distance."""
    a = row(joints.a, i)
    if joints.drive[i] < 0:
        return a, (0.0, 0.0, 0.0), 0.0
    s = drive[joints.drive[i]]
    if joints.rotation[i] == 0:
        return a, (0.0, 0.0, 0.0), s
    turned = row(joints.a_turned, i)
    c, s = math.cos(s), math.sin(s)
    return add(scale(c, a), scale(s, turned)), subtract(scale(c, turned), scale(s, a)), 0.0


@compiled
def evaluate_joints(joints: Joints, lam: Array, drive: Array, work: Workspace) -> None:
    """Residuals and gradients of all rows; the wrenches of the joints are added to those of their frames."""
    for j in range(len(joints.frame_a)):
        A, B = joints.frame_a[j], joints.frame_b[j]
        delta = subtract(row(work.r, B), row(work.r, A))
        f, n = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        N = work.moment_tangent[j]
        N[:] = 0.0
        for i in range(joints.row[j], joints.row[j + 1]):
            gradient = work.gradient[i]
            gradient[:] = 0.0
            axis, slope, distance = carried_axis(joints, i, drive)
            a = rotate(work.D, A, axis)
            if joints.rotation[i] == 0:
                work.phi[i] = dot(a, delta) - distance
                work.drive_slope[i] = -1.0
                lever = cross(a, delta)
                for k in range(3):
                    gradient[k] = -a[k]
                    gradient[3 + k] = lever[k]
                    gradient[6 + k] = a[k]
                f = add(f, scale(lam[i], a))
            else:
                b = rotate(work.D, B, row(joints.b, i))
                a_dot_b = dot(a, b)
                work.phi[i] = a_dot_b
                work.drive_slope[i] = dot(rotate(work.D, A, slope), b)
                normal = cross(a, b)
                for k in range(3):
                    gradient[3 + k] = normal[k]
                    gradient[9 + k] = -normal[k]
                    # skew(b) skew(a) = a b^T - (a . b) I
                    for m in range(3):
                        N[k, m] += lam[i] * a[k] * b[m]
                    N[k, k] -= lam[i] * a_dot_b
                n = add(n, scale(lam[i], normal))
        for k in range(3):
            work.delta[j, k] = delta[k]
            work.joint_wrench[j, k] = f[k]
            work.joint_wrench[j, 3 + k] = -n[k]
        add_to_row(work.wrench, A, 0, scale(-1.0, f))
        add_to_row(work.wrench, A, 3, add(cross(f, delta), n))
        add_to_row(work.wrench, B, 0, f)
        add_to_row(work.wrench, B, 3, scale(-1.0, n))


@compiled
def joint_tangent(j: int, work: Workspace) -> None:
    """`work.frame_tangent` (12, 12): derivative of the wrenches of joint j on A and B by (r, theta) of A and B."""
    K = work.frame_tangent
    K[:] = 0.0
    f = row(work.joint_wrench, j)
    delta = row(work.delta, j)
    for i in range(3):
        e = (1.0 if i == 0 else 0.0, 1.0 if i == 1 else 0.0, 1.0 if i == 2 else 0.0)
        f_e = cross(f, e)
        turned = cross(delta, f_e)
        for k in range(3):
            K[k, 3 + i] = f_e[k]
            K[6 + k, 3 + i] = -f_e[k]
            K[3 + k, i] = -f_e[k]
            K[3 + k, 6 + i] = f_e[k]
            K[3 + k, 3 + i] = turned[k] + work.moment_tangent[j, k, i]
            K[3 + k, 9 + i] = -work.moment_tangent[j, i, k]
            K[9 + k, 3 + i] = -work.moment_tangent[j, k, i]
            K[9 + k, 9 + i] = work.moment_tangent[j, i, k]


@compiled
def add_joints(joints: Joints, frames: Frames, n_q: int, work: Workspace) -> None:
    """The constraint Jacobian B of all rows, and K += the tangents of all joints."""
    for j in range(len(joints.frame_a)):
        A, B = joints.frame_a[j], joints.frame_b[j]
        for i in range(joints.row[j], joints.row[j + 1]):
            _add_row(frames, n_q, i, A, 0, work)
            _add_row(frames, n_q, i, B, 6, work)
        joint_tangent(j, work)
        add_pair_tangent(frames, n_q, A, A, 0, 0, work)
        add_pair_tangent(frames, n_q, A, B, 0, 6, work)
        add_pair_tangent(frames, n_q, B, A, 6, 0, work)
        add_pair_tangent(frames, n_q, B, B, 6, 6, work)


@compiled
def _add_row(frames: Frames, n_q: int, i: int, f: int, first: int, work: Workspace) -> None:
    for k in range(width(frames, f)):
        total = 0.0
        for m in range(6):
            total += work.gradient[i, first + m] * work.map[f, m, k]
        work.B[i, column(frames, n_q, f, k)] += total
