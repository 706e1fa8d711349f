"""Where one set of axes is in another."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from ..files.arrays import Array


@dataclass(frozen=True)
class Pose:
    """Axes within others: x = R y + p of a point with the coordinates y in these axes.

    R (3, 3): these axes as columns; p (3,): their origin [m].
    """

    R: Array
    p: Array

    def __matmul__(self, inner: "Pose") -> "Pose":
        """The pose of axes that are given in these ones."""
        return Pose(self.R @ inner.R, self.of(inner.p))

    def of(self, y: Array) -> Array:
        """A point (3,), or points (n, 3), of these axes in the outer ones."""
        points: Array = y @ self.R.T + self.p
        return points

    def seen(self, x: Array) -> Array:
        """A point (3,) of the outer axes in these ones."""
        point: Array = (x - self.p) @ self.R
        return point

    def relative(self, other: "Pose") -> "Pose":
        """Another pose of the same outer axes, in these ones."""
        return Pose(self.R.T @ other.R, self.seen(other.p))


def at(p: Sequence[float] | Array, R: Array | None = None) -> Pose:
    """Axes at a point (3,), which are those of the outside unless given."""
    return Pose(np.eye(3) if R is None else R, np.array(p, dtype=float))


# The outer axes themselves.
AT_ORIGIN = at((0.0, 0.0, 0.0))


def by_fixed_axes(rpy: Sequence[float] | Array) -> Array:
    """The rotation (3, 3) by angles about x, y and z of the outside, in this order [rad].

    R = R_z(yaw) R_y(pitch) R_x(roll)
    """
    rotation: Array = Rotation.from_euler("xyz", rpy).as_matrix()
    return rotation


def by_quaternion(xyzw: Sequence[float] | Array) -> Array:
    """The rotation (3, 3) of a quaternion of any length, whose real part is the last."""
    rotation: Array = Rotation.from_quat(np.array(xyzw, dtype=float)).as_matrix()
    return rotation


def by_rotation_vector(vector: Array) -> Array:
    """The rotation (3, 3) about a vector (3,), by its length [rad]."""
    rotation: Array = Rotation.from_rotvec(vector).as_matrix()
    return rotation


def rotation_vector(R: Array) -> Array:
    """The rotation vector (3,) of a rotation [rad]."""
    vector: Array = Rotation.from_matrix(R).as_rotvec()
    return vector
