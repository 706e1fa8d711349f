"""The deformation of a body between its interfaces, from their motions alone."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from ..files.arrays import Array
from ..superelement import Outline

# Relative to the largest eigenvalue of the conditions: what is smaller is rounding.
RELATIVE_ZERO_EIGENVALUE = 1e-13
# With more interfaces these lie so close together that their displacements alone show the turns.
MAX_TURNING_INTERFACES = 300
# 16 MiB of numbers, so that memory does not grow with the number of points.
TABLE_BATCH_NUMBERS = 1 << 21


class Blend:
    """Displacements u(X) of a body that take the displacements and rotations of its interfaces.

        u(X) = a + B X + sum_i (c_i r_i^3 - D_i grad r_i^3),   r_i = |X - X_i|
        u(X_i) = u_i,   grad u(X_i) = skew(theta_i) where interfaces have rotations

    Rigid motions are exact, and on the line between two interfaces it is the cubic that a straight
    beam bends to. A section of a beam moves with its node, u + (curl u) / 2 x arm. Source: H.
    Wendland, Scattered Data Approximation (2005), ch. 16; docs/theory.md, Bodies in pictures.

    places (i, 3): interfaces in body axes [m]; turns (i,): whether each has rotations.
    """

    def __init__(self, outline: Outline, places: Array, turns: Sequence[bool]) -> None:
        self._outline = outline
        both = np.vstack([outline.anchors, places])
        # In lengths of the body, so that r^3 and the linear terms are of one size.
        self._size = float(np.linalg.norm(np.ptp(both, axis=0))) or 1.0
        self._places = places / self._size
        followed = np.array(turns, dtype=bool) & (len(places) <= MAX_TURNING_INTERFACES)
        self._turning = np.flatnonzero(followed)
        # Interfaces on a line or in a plane leave some linear terms open; these are then zero.
        self._inverse = np.linalg.pinv(
            self._conditions(), rcond=RELATIVE_ZERO_EIGENVALUE, hermitian=True
        )

    def displacement(self, u: Array, theta: Array) -> Array:
        """(k, p, 3) from displacements and small rotations (k, i, 3) of the interfaces."""
        coefficients = self._coefficients(u, theta)
        outline = self._outline
        if outline.node is None:
            return self._summed(self._values, outline.points, coefficients)
        # Once for each node: all points of a section move with it.
        _, first, of_point = np.unique(outline.node, return_index=True, return_inverse=True)
        nodes = outline.anchors[first]
        turns = 0.5 * self._curl(nodes, coefficients)
        moved = self._summed(self._values, nodes, coefficients)[:, of_point]
        moved += np.cross(turns[:, of_point], outline.points - outline.anchors)
        return moved

    def _coefficients(self, u: Array, theta: Array) -> Array:
        """(n, k, 3) of all functions."""
        turned = theta[:, self._turning].transpose(1, 0, 2)
        # A small rotation theta gives du/dx_i = theta x e_i.
        slopes = [np.cross(turned, along) for along in self._size * np.eye(3)]
        known = np.concatenate([u.transpose(1, 0, 2), *slopes, np.zeros((4, *u[:, 0].shape))])
        found: Array = self._inverse @ known.reshape(len(known), -1)
        return found.reshape(known.shape)

    def _curl(self, points: Array, coefficients: Array) -> Array:
        """curl u (k, p, 3) at points."""
        x, y, z = (
            self._summed(partial(self._slopes, axis), points, coefficients) / self._size
            for axis in range(3)
        )
        return np.stack([y[..., 2] - z[..., 1], z[..., 0] - x[..., 2], x[..., 1] - y[..., 0]], -1)

    def _summed(self, table: Callable[[Array], Array], points: Array, coefficients: Array) -> Array:
        """Sum (k, p, 3) of functions at points (p, 3) by their coefficients (n, k, 3)."""
        n, k, _ = coefficients.shape
        flat = coefficients.reshape(n, -1)
        summed = np.empty((k, len(points), 3))
        batch = max(TABLE_BATCH_NUMBERS // (3 * n), 1)
        for first in range(0, len(points), batch):
            here = slice(first, first + batch)
            rows = table(points[here] / self._size) @ flat
            summed[:, here] = rows.reshape(-1, k, 3).transpose(1, 0, 2)
        return summed

    def _values(self, x: Array) -> Array:
        """The functions (p, n) at points x (p, 3)."""
        away, r = self._away(x)
        turning = self._turning
        gradients = [-3.0 * r[:, turning] * away[:, turning, axis] for axis in range(3)]
        return np.hstack([r**3, *gradients, np.ones((len(x), 1)), x])

    def _slopes(self, axis: int, x: Array) -> Array:
        """Their derivatives (p, n) along an axis."""
        away, r = self._away(x)
        near, d = r[:, self._turning], away[:, self._turning]
        # The second derivative of r^3 is zero at r = 0, where the direction is none.
        over = np.divide(d[..., axis], near, out=np.zeros_like(near), where=near > 0.0)
        seconds = [-3.0 * ((other == axis) * near + over * d[..., other]) for other in range(3)]
        linear = np.zeros((len(x), 4))
        linear[:, 1 + axis] = 1.0
        return np.hstack([3.0 * r * away[..., axis], *seconds, linear])

    def _away(self, x: Array) -> tuple[Array, Array]:
        """X - X_i (p, i, 3) and its length (p, i)."""
        away = x[:, None] - self._places
        return away, np.linalg.norm(away, axis=2)

    def _conditions(self) -> Array:
        """The symmetric matrix (n, n) of what is known, and of the sums that shall be zero."""
        turning = self._places[self._turning]
        known = np.vstack(
            [self._values(self._places), *(self._slopes(axis, turning) for axis in range(3))]
        )
        n = len(known)
        matrix = np.zeros((n + 4, n + 4))
        matrix[:n] = known
        # Side conditions: the coefficients of the functions are orthogonal to linear fields.
        matrix[n:, :n] = known[:, n:].T
        return matrix
