"""Rotations over time as unit quaternions (n, 4), in the order w, x, y, z."""

from math import factorial
from typing import Any

import numpy as np

from ..files.arrays import Array


def rotate(q: Array, x: Array) -> Array:
    """R x for every rotation.   q (n, 4), x (n, 3) or (3,) -> (n, 3)"""
    w, r = q[:, :1], q[:, 1:]
    once = np.cross(r, x)
    rotated: Array = x + 2.0 * (w * once + np.cross(r, once))
    return rotated


def inverse(q: Array) -> Array:
    """R^T.   q (n, 4) or (4,)"""
    conjugate: Array = q * np.array([1.0, -1.0, -1.0, -1.0])
    return conjugate


def product(p: Array, q: Array) -> Array:
    """R_p R_q.   p (n, 4), q (n, 4) or (4,) -> (n, 4)"""
    q = np.broadcast_to(q, p.shape)
    w = p[:, :1] * q[:, :1] - np.sum(p[:, 1:] * q[:, 1:], axis=1, keepdims=True)
    r = p[:, :1] * q[:, 1:] + q[:, :1] * p[:, 1:] + np.cross(p[:, 1:], q[:, 1:])
    return np.hstack([w, r])


def twists(q: Array, expected: Array | float = 0.0) -> Array:
    """Angles (n, 3) of rotations about each of the axes x, y, z, continued over full turns [rad].

        angle_a = 2 atan2(q_a, q_w)

    is the twist about the axis a that is left when the rotation is split into a twist and a swing
    of the axis [rad]. It has no value where the swing is half a turn, and is followed if its change
    from one row to the next differs by less than half a turn from that of `expected`, (n, 3) or 0.
    """
    half: Any = np.arctan2(q[:, 1:], q[:, :1]) - 0.5 * expected
    # q and -q are one rotation, so half angles are known up to multiples of pi.
    twist: Array = 2.0 * np.unwrap(half, axis=0, period=np.pi) + expected
    return twist


def apply_tangent(w: Array, a: Array) -> Array:
    """T(w) a (n, 3) with the material tangent T of rotation vectors w (n, 3), for vectors a (n, 3).

        T(w) = I - c_2 skew(w) + c_3 skew(w)^2,   c_2 = (1 - cos t) / t^2,  c_3 = (t - sin t) / t^3,

    t = |w|; below one radian by power series, which leave nothing to cancellation.
    """
    square = np.sum(w * w, axis=1, keepdims=True)
    # Both branches are computed for all rows, so neither may divide by zero or overflow.
    small = np.minimum(square, 1.0)
    c_2 = sum((-small) ** i / factorial(2 + 2 * i) for i in range(10))
    c_3 = sum((-small) ** i / factorial(3 + 2 * i) for i in range(10))
    t = np.sqrt(np.maximum(square, 1.0))
    c_2 = np.where(square < 1.0, c_2, (1.0 - np.cos(t)) / t**2)
    c_3 = np.where(square < 1.0, c_3, (t - np.sin(t)) / t**3)
    once = np.cross(w, a)
    applied: Array = a - c_2 * once + c_3 * np.cross(w, once)
    return applied
