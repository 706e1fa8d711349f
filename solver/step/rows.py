"""Primitive rows: scalar coordinates of two frames A and B, with gradients and tangents.

With a = D_A a_A, a' = D_A a'_A, b = D_B b_B carried by the frames, and Delta = r_B - r_A, all in
space:

    translation   c = a . Delta             gradient: r_A: -a,  theta_A: a x Delta,  r_B: a
    rotation      c = a . b                 gradient: theta_A: a x b,  theta_B: -a x b
    distance      c = |Delta|               gradient: r_A: -n,  r_B: n,  n = Delta / |Delta|
    angle         c = atan2(a' . b, a . b)  gradient: from those of the two rotation rows

Angles are continued over full turns. In code f and g are the numbers of frames A and B.

A wrench lambda times the gradient changes, at constant lambda, by lambda times the tangent H (12,
12) of the row: with N(a, b) = skew(b) skew(a) = a b^T - (a . b) I, d(a x b) = N dtheta_A - N^T
dtheta_B. Source: docs/theory.md, Frames, joints, loads.
"""

import math

from ..arrays import Array
from ..compiler.marks import compiled
from .system import Rows, Workspace
from .vectors import UNITS, Vector, add, cross, dot, rotate, row, scale, subtract

TRANSLATION, ROTATION, DISTANCE, ANGLE = 0, 1, 2, 3


@compiled
def measures_length(kind: int) -> bool:
    return kind in (TRANSLATION, DISTANCE)


@compiled
def carried_axis(rows: Rows, i: int, angle: float) -> Vector:
    """The axis of row i in frame A, turned by an angle from a towards a'."""
    a = row(rows.a, i)
    if angle == 0.0:
        return a
    return add(scale(math.cos(angle), a), scale(math.sin(angle), row(rows.a_turned, i)))


@compiled
def evaluate_row(
    rows: Rows, i: int, angle: float, near: float, work: Workspace, gradient: Array
) -> float:
    """The value of row i, and its gradient (12,) by (r, theta) of A and B.

    angle: by which the axis in A is turned; near: of the values of an angle, the nearest to it.
    """
    f, g, kind = rows.frame_a[i], rows.frame_b[i], rows.kind[i]
    gradient[:] = 0.0
    if kind == TRANSLATION:
        delta = subtract(row(work.frames.r, g), row(work.frames.r, f))
        a = rotate(work.frames.D, f, carried_axis(rows, i, 0.0))
        lever = cross(a, delta)
        for k in range(3):
            gradient[k] = -a[k]
            gradient[3 + k] = lever[k]
            gradient[6 + k] = a[k]
        return dot(a, delta)
    if kind == DISTANCE:
        delta = subtract(row(work.frames.r, g), row(work.frames.r, f))
        length = math.sqrt(dot(delta, delta))
        for k in range(3):
            gradient[k] = -delta[k] / length
            gradient[6 + k] = delta[k] / length
        return length
    a = rotate(work.frames.D, f, carried_axis(rows, i, angle))
    b = rotate(work.frames.D, g, row(rows.b, i))
    normal, value = cross(a, b), dot(a, b)
    if kind == ANGLE:
        turned = rotate(work.frames.D, f, row(rows.a_turned, i))
        sine, cosine = dot(turned, b), value
        square = sine * sine + cosine * cosine
        normal = scale(1.0 / square, subtract(scale(cosine, cross(turned, b)), scale(sine, normal)))
        value = math.atan2(sine, cosine)
        value += 2.0 * math.pi * round((near - value) / (2.0 * math.pi))
    for k in range(3):
        gradient[3 + k] = normal[k]
        gradient[9 + k] = -normal[k]
    return value


@compiled
def add_row_tangent(
    rows: Rows, i: int, angle: float, factor: float, work: Workspace, H: Array
) -> None:
    """H += factor times the tangent of row i."""
    f, g, kind = rows.frame_a[i], rows.frame_b[i], rows.kind[i]
    if kind == TRANSLATION:
        delta = subtract(row(work.frames.r, g), row(work.frames.r, f))
        lam_a = scale(factor, rotate(work.frames.D, f, carried_axis(rows, i, 0.0)))
        for j in range(3):
            axis_e = cross(lam_a, UNITS[j])
            turned = cross(delta, axis_e)
            for k in range(3):
                H[k, 3 + j] += axis_e[k]
                H[6 + k, 3 + j] -= axis_e[k]
                H[3 + k, j] -= axis_e[k]
                H[3 + k, 6 + j] += axis_e[k]
                H[3 + k, 3 + j] += turned[k]
    elif kind == DISTANCE:
        delta = subtract(row(work.frames.r, g), row(work.frames.r, f))
        length = math.sqrt(dot(delta, delta))
        n = scale(1.0 / length, delta)
        for j in range(3):
            for k in range(3):
                value = factor * ((1.0 if j == k else 0.0) - n[j] * n[k]) / length
                H[k, j] += value
                H[6 + k, 6 + j] += value
                H[k, 6 + j] -= value
                H[6 + k, j] -= value
    else:
        b = rotate(work.frames.D, g, row(rows.b, i))
        a = rotate(work.frames.D, f, carried_axis(rows, i, angle))
        if kind == ROTATION:
            _add_rotation(a, b, factor, H)
        else:
            _add_angle(a, rotate(work.frames.D, f, row(rows.a_turned, i)), b, factor, H)


@compiled
def _add_rotation(a: Vector, b: Vector, factor: float, H: Array) -> None:
    value = dot(a, b)
    for j in range(3):
        for k in range(3):
            N = factor * (a[k] * b[j] - (value if j == k else 0.0))
            H[3 + k, 3 + j] += N
            H[9 + k, 3 + j] -= N
            H[3 + j, 9 + k] -= N
            H[9 + j, 9 + k] += N


@compiled
def _add_angle(a: Vector, turned: Vector, b: Vector, factor: float, H: Array) -> None:
    """H += factor times the tangent of theta = atan2(s, c), with q = s^2 + c^2.

    The gradient is (c g_s - s g_c) / q, with the gradients g of s and c; its derivative has the
    terms of H_s, H_c and those of the factors: d(c/q) = ((s^2 - c^2) dc - 2 s c ds) / q^2 and
    d(s/q) = ((c^2 - s^2) ds - 2 s c dc) / q^2.
    """
    s, c = dot(turned, b), dot(a, b)
    q = s * s + c * c
    _add_rotation(turned, b, factor * c / q, H)
    _add_rotation(a, b, -factor * s / q, H)
    g_s, g_c = cross(turned, b), cross(a, b)
    same, mixed = (c * c - s * s) / (q * q), 2.0 * s * c / (q * q)
    for k in range(3):
        for j in range(3):
            value = -g_s[k] * (same * g_c[j] + mixed * g_s[j]) - g_c[k] * (
                same * g_s[j] - mixed * g_c[j]
            )
            H[3 + k, 3 + j] += factor * value
            H[9 + k, 9 + j] += factor * value
            H[3 + k, 9 + j] -= factor * value
            H[9 + k, 3 + j] -= factor * value
