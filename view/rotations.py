"""Rotations over time as unit quaternions (n, 4), in the order w, x, y, z."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


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


def twists(q: Array) -> Array:
    """The angles (n, 3) by which rotations turn about each of the axes x, y, z, continuous over any
    number of turns.

        angle_a = 2 atan2(q_a, q_w)

    is the twist about the axis a that is left when the rotation is split into a twist and a swing
    of the axis [rad]. It has no value where the swing is half a turn, and is followed if it changes
    by less than half a turn from one row to the next.
    """
    half: Any = np.arctan2(q[:, 1:], q[:, :1])
    # q and -q are one rotation, so half angles are known up to multiples of pi.
    twist: Array = 2.0 * np.unwrap(half, axis=0, period=np.pi)
    return twist
