"""Finite rotations: rotation vectors, unit quaternions (w, x, y, z), tangents of the exponential.

Conventions: skew(a) b = a x b; R maps body to space; delta R = R skew(delta Theta) with delta Theta
material; delta Theta = T(psi) delta psi with the material (right) tangent T. Source: methods,
sections 1 (eqs 4-6) and 9. Compiled functions write into `out`, their last argument, and allocate
nothing.
"""

import math

import numpy as np

from ..arrays import Array
from ..compiler.marks import compiled

# Series of c_4 and c_5 in s: the ninth term is below rounding at s = 1.
STUMPFF_4 = np.array([(-1.0) ** i / math.factorial(4 + 2 * i) for i in range(9)])
STUMPFF_5 = np.array([(-1.0) ** i / math.factorial(5 + 2 * i) for i in range(9)])


@compiled
def stumpff(square: float) -> tuple[float, float, float, float, float, float]:
    """The functions c_k(s) = sum_i (-s)^i / (k + 2i)!, k = 0..5, of the squared angle s = theta^2.

    c_0 = cos, c_1 = sin/theta, c_2 = (1 - cos)/theta^2, c_3 = (theta - sin)/theta^3; c_k = 1/k! - s
    c_{k+2}; 2 dc_k/ds = k c_{k+2} - c_{k+1}. The power series below one radian leaves nothing to
    cancellation.
    """
    # 1 - cos and theta - sin lose all digits for small angles; the series does not.
    if square < 1.0:
        c4, c5 = STUMPFF_4[8], STUMPFF_5[8]
        for i in range(7, -1, -1):
            c4 = STUMPFF_4[i] + square * c4
            c5 = STUMPFF_5[i] + square * c5
        c2, c3 = 0.5 - square * c4, 1.0 / 6.0 - square * c5
        return 1.0 - square * c2, 1.0 - square * c3, c2, c3, c4, c5
    angle = math.sqrt(square)
    c0, c1 = math.cos(angle), math.sin(angle) / angle
    c2, c3 = (1.0 - c0) / square, (1.0 - c1) / square
    return c0, c1, c2, c3, (0.5 - c2) / square, (1.0 / 6.0 - c3) / square


@compiled
def _polynomial(psi: Array, constant: float, linear: float, quadratic: float, out: Array) -> None:
    """constant I + linear skew(psi) + quadratic skew(psi)^2.

    skew(psi)^2 = psi psi^T - |psi|^2 I
    """
    x, y, z = psi[0], psi[1], psi[2]
    diagonal = constant - quadratic * (x * x + y * y + z * z)
    out[0, 0] = diagonal + quadratic * x * x
    out[1, 1] = diagonal + quadratic * y * y
    out[2, 2] = diagonal + quadratic * z * z
    out[0, 1] = quadratic * x * y - linear * z
    out[1, 0] = quadratic * x * y + linear * z
    out[0, 2] = quadratic * x * z + linear * y
    out[2, 0] = quadratic * x * z - linear * y
    out[1, 2] = quadratic * y * z - linear * x
    out[2, 1] = quadratic * y * z + linear * x


@compiled
def square_norm(a: Array) -> float:
    return float(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@compiled
def exponential(psi: Array, out: Array) -> None:
    """R = exp(skew(psi)) = I + c_1 skew(psi) + c_2 skew(psi)^2."""
    _, c1, c2, _, _, _ = stumpff(square_norm(psi))
    _polynomial(psi, 1.0, c1, c2, out)


@compiled
def exponential_and_tangent(psi: Array, R: Array, T: Array) -> None:
    """Both of a small rotation: R = exp(skew(psi)) and T(psi)."""
    _, c1, c2, c3, _, _ = stumpff(square_norm(psi))
    _polynomial(psi, 1.0, c1, c2, R)
    _polynomial(psi, 1.0, -c2, c3, T)


@compiled
def tangent(psi: Array, out: Array) -> None:
    """T(psi) = I - c_2 skew(psi) + c_3 skew(psi)^2: delta Theta = T delta psi."""
    _, _, c2, c3, _, _ = stumpff(square_norm(psi))
    _polynomial(psi, 1.0, -c2, c3, out)


@compiled
def tangent_inverse(psi: Array, out: Array) -> None:
    """The inverse tangent T^-1(psi), for |psi| < 2 pi.

    I + skew(psi)/2 + (1 - (theta/2) cot(theta/2)) / theta^2 skew(psi)^2
    """
    _, _, c2, c3, c4, _ = stumpff(square_norm(psi))
    # (theta/2) cot(theta/2) = c_1 / (2 c_2), and 2 c_2 - c_1 = theta^2 (c_3 - 2 c_4)
    _polynomial(psi, 1.0, 0.5, (c3 - 2.0 * c4) / (2.0 * c2), out)


@compiled
def tangent_derivative(w: Array, moment: Array, out: Array) -> None:
    """d (T(w) m) / d w for a constant m: the stiffness of a moment on a small rotation, (3, 3)."""
    _, _, c2, c3, c4, c5 = stumpff(square_norm(w))
    slope2, slope3 = 2.0 * c4 - c3, 3.0 * c5 - c4  # (dc_k/dtheta) / theta
    x, y, z = w[0], w[1], w[2]
    mx, my, mz = moment[0], moment[1], moment[2]
    cx, cy, cz = y * mz - z * my, z * mx - x * mz, x * my - y * mx  # w x m
    dx, dy, dz = y * cz - z * cy, z * cx - x * cz, x * cy - y * cx  # w x (w x m)
    dot = x * mx + y * my + z * mz
    # T m = m - c_2 w x m + c_3 (w (w.m) - |w|^2 m)
    for i in range(3):
        a = -slope2 * (cx, cy, cz)[i] + slope3 * (dx, dy, dz)[i]
        for j in range(3):
            out[i, j] = a * w[j] + c3 * (w[i] * moment[j] - 2.0 * moment[i] * w[j])
        out[i, i] += c3 * dot
    out[0, 1] -= c2 * mz
    out[0, 2] += c2 * my
    out[1, 0] += c2 * mz
    out[1, 2] -= c2 * mx
    out[2, 0] -= c2 * my
    out[2, 1] += c2 * mx


@compiled
def quaternion_exponential(psi: Array, out: Array) -> None:
    """The unit quaternion of exp(skew(psi))."""
    c0, c1, _, _, _, _ = stumpff(0.25 * square_norm(psi))
    out[0] = c0
    for i in range(3):
        out[1 + i] = 0.5 * c1 * psi[i]


@compiled
def quaternion_product(p: Array, q: Array, out: Array) -> None:
    """The rotation q followed, in space, by p: R(out) = R(p) R(q).

    `out` must be neither p nor q.
    """
    out[0] = p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3]
    out[1] = p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2]
    out[2] = p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1]
    out[3] = p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0]


@compiled
def normalize(q: Array) -> None:
    length = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    for i in range(4):
        q[i] /= length


@compiled
def quaternion_matrix(q: Array, out: Array) -> None:
    """The rotation matrix of a unit quaternion."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    out[0, 0] = 1.0 - 2.0 * (y * y + z * z)
    out[1, 1] = 1.0 - 2.0 * (x * x + z * z)
    out[2, 2] = 1.0 - 2.0 * (x * x + y * y)
    out[0, 1] = 2.0 * (x * y - w * z)
    out[1, 0] = 2.0 * (x * y + w * z)
    out[0, 2] = 2.0 * (x * z + w * y)
    out[2, 0] = 2.0 * (x * z - w * y)
    out[1, 2] = 2.0 * (y * z - w * x)
    out[2, 1] = 2.0 * (y * z + w * x)


@compiled
def relative_rotation(A: Array, B: Array, out: Array) -> None:
    """The rotation vector, in space, that carries A to B: log(B A^T). Exact up to half a turn."""
    # The quaternion of B A^T from its trace and antisymmetric part; half angles below 45 degrees
    # keep w large.
    trace = 0.0
    for i in range(3):
        out[i] = 0.0
    for k in range(3):
        for i in range(3):
            trace += B[i, k] * A[i, k]
        out[0] += B[2, k] * A[1, k] - B[1, k] * A[2, k]
        out[1] += B[0, k] * A[2, k] - B[2, k] * A[0, k]
        out[2] += B[1, k] * A[0, k] - B[0, k] * A[1, k]
    sine = 0.5 * math.sqrt(square_norm(out))
    angle = math.atan2(sine, 0.5 * (trace - 1.0))
    # sin x = x to rounding below 1e-8; above, the quotient has all digits.
    scale = 0.5 * angle / sine if sine > 1e-8 else 0.5
    for i in range(3):
        out[i] *= scale


def rotation_matrix(psi: Array) -> Array:
    """exp(skew(psi)), (3, 3)."""
    R = np.empty((3, 3))
    exponential(psi, R)
    return R


def quaternion_of(R: Array) -> Array:
    """The unit quaternion (w >= 0) of a rotation matrix, from its largest component (Shepperd)."""
    # 4 q q^T, column by column
    products = np.array(
        [
            [
                1 + R[0, 0] + R[1, 1] + R[2, 2],
                R[2, 1] - R[1, 2],
                R[0, 2] - R[2, 0],
                R[1, 0] - R[0, 1],
            ],
            [
                R[2, 1] - R[1, 2],
                1 + R[0, 0] - R[1, 1] - R[2, 2],
                R[0, 1] + R[1, 0],
                R[0, 2] + R[2, 0],
            ],
            [
                R[0, 2] - R[2, 0],
                R[0, 1] + R[1, 0],
                1 - R[0, 0] + R[1, 1] - R[2, 2],
                R[1, 2] + R[2, 1],
            ],
            [
                R[1, 0] - R[0, 1],
                R[0, 2] + R[2, 0],
                R[1, 2] + R[2, 1],
                1 - R[0, 0] - R[1, 1] + R[2, 2],
            ],
        ]
    )
    # The largest component is at least 1/2: no division by a small number.
    q: Array = products[int(np.argmax(np.diagonal(products)))]
    unit: Array = q / np.copysign(np.linalg.norm(q), q[0])
    return unit
