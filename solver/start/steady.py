"""Steady rotation as generalized-alpha steps it.

A point on a circle about c turns by theta = |Omega| h in every step. In the plane across the axis,
as a complex number, it grows by z = exp(i theta), and so must all that the scheme carries along:

    x_1 = x + h v + h^2 ((1/2 - beta) a + beta a_1),    v_1 = v + h ((1 - gamma) a + gamma a_1)
    (1 - alpha_m) a_1 + alpha_m a = (1 - alpha_f) v_dot_1 + alpha_f v_dot

With a_1 = z a and so on, v, a and v_dot are multiples of x - c. They differ from those of a
continuous rotation, i Omega and -Omega^2, by theta^2, enough to make flexible bodies ring. How the
bodies turn is stepped exactly as it is.
"""

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..model.settings import SteadyRotation
from ..step.records.scheme import Scheme
from ..step.system import State


@dataclass(frozen=True, eq=False)
class SteadyMotion:
    """A steady rotation in the scheme.

    angular_velocity and center as in `SteadyRotation`; velocity, pseudo_acceleration and
    acceleration (3, 3): v, a and v_dot of a point by x - center.
    """

    angular_velocity: Array
    center: Array
    velocity: Array
    pseudo_acceleration: Array
    acceleration: Array

    def impose(self, state: State) -> None:
        """Velocities and accelerations of all bodies where they are."""
        arm = state.bodies.x - self.center
        state.bodies.v[:, :3] = arm @ self.velocity.T
        state.bodies.v[:, 3:] = np.einsum("bji,j->bi", state.bodies.R, self.angular_velocity)
        state.bodies.v_dot[:, :3] = arm @ self.acceleration.T
        state.bodies.a[:, :3] = arm @ self.pseudo_acceleration.T


def steady_motion(rotation: SteadyRotation, scheme: Scheme) -> SteadyMotion:
    """Velocity, pseudo-acceleration and acceleration of a steady rotation in the scheme.

    Its numerical dissipation, of order theta^3, shows as an acceleration along the path; that is
    left out, for nothing in equilibrium could balance it.
    """
    speed = float(np.linalg.norm(rotation.angular_velocity))
    h, beta, gamma = scheme.h, scheme.beta, scheme.gamma
    # expm1: z - 1 would cancel in slow rotation.
    z, step = np.exp(1j * speed * h), np.expm1(1j * speed * h)
    slope = (1.0 - gamma) + gamma * z
    square = slope + ((0.5 - beta) + beta * z) * step
    a = step**2 / (h**2 * square)
    v = slope * step / (h * square)
    v_dot = (
        ((1.0 - scheme.alpha_m) * z + scheme.alpha_m)
        / ((1.0 - scheme.alpha_f) * z + scheme.alpha_f)
        * a
    )
    axis = rotation.angular_velocity / speed if speed > 0.0 else np.zeros(3)
    return SteadyMotion(
        angular_velocity=rotation.angular_velocity,
        center=rotation.center,
        velocity=_turned(v, axis),
        pseudo_acceleration=_turned(a, axis),
        # The imaginary part is the dissipation along the path.
        acceleration=_turned(v_dot.real, axis),
    )


def continuous_motion(rotation: SteadyRotation) -> SteadyMotion:
    """A steady rotation without a scheme: v = Omega x (x - c), v_dot = Omega x v."""
    speed = float(np.linalg.norm(rotation.angular_velocity))
    axis = rotation.angular_velocity / speed if speed > 0.0 else np.zeros(3)
    return SteadyMotion(
        angular_velocity=rotation.angular_velocity,
        center=rotation.center,
        velocity=_turned(1j * speed, axis),
        pseudo_acceleration=_turned(-(speed**2) + 0j, axis),
        acceleration=_turned(-(speed**2) + 0j, axis),
    )


def _turned(factor: complex, axis: Array) -> Array:
    """The matrix that multiplies by a complex number in the plane across an axis (3, 3)."""
    x, y, z = axis
    across = np.eye(3) - np.outer(axis, axis)
    ahead = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    matrix: Array = np.real(factor) * across + np.imag(factor) * ahead
    return matrix
