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
from typing import Any

import numpy as np

from ..arrays import Array
from ..model.settings import SteadyRotation
from ..step.records.scheme import Scheme
from ..step.system import State


@dataclass(frozen=True, eq=False)
class SteadyMotion:
    """A steady rotation in the scheme.

    angular_velocity (n_b, 3) of the bodies, center as in `SteadyRotation`; velocity,
    pseudo_acceleration and acceleration (n_b, 3, 3): v, a and v_dot of a point by x - center.
    """

    angular_velocity: Array
    center: Array
    velocity: Array
    pseudo_acceleration: Array
    acceleration: Array

    def impose(self, state: State) -> None:
        """Velocities and accelerations of all bodies where they are."""
        arm = state.bodies.x - self.center
        state.bodies.v[:, :3] = np.einsum("bij,bj->bi", self.velocity, arm)
        state.bodies.v[:, 3:] = np.einsum("bji,bj->bi", state.bodies.R, self.angular_velocity)
        state.bodies.v_dot[:, :3] = np.einsum("bij,bj->bi", self.acceleration, arm)
        state.bodies.a[:, :3] = np.einsum("bij,bj->bi", self.pseudo_acceleration, arm)

    @property
    def speed(self) -> float:
        """The largest angular velocity of a body [rad/s]."""
        return float(np.linalg.norm(self.angular_velocity, axis=1).max())


def steady_motion(rotation: SteadyRotation, ratios: Array, scheme: Scheme) -> SteadyMotion:
    """Velocity, pseudo-acceleration and acceleration of a steady rotation in the scheme.

    ratios (n_b,): the speeds of the bodies over that of the rotation.

    Its numerical dissipation, of order theta^3, shows as an acceleration along the path; that is
    left out, for nothing in equilibrium could balance it.
    """
    axis, speed = _axis_and_speeds(rotation, ratios)
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
    return SteadyMotion(
        angular_velocity=np.outer(speed, axis),
        center=rotation.center,
        velocity=_turned(v, axis),
        pseudo_acceleration=_turned(a, axis),
        # The imaginary part is the dissipation along the path.
        acceleration=_turned(v_dot.real, axis),
    )


def continuous_motion(rotation: SteadyRotation, ratios: Array) -> SteadyMotion:
    """A steady rotation without a scheme: v = Omega x (x - c), v_dot = Omega x v."""
    axis, speed = _axis_and_speeds(rotation, ratios)
    return SteadyMotion(
        angular_velocity=np.outer(speed, axis),
        center=rotation.center,
        velocity=_turned(1j * speed, axis),
        pseudo_acceleration=_turned(-(speed**2) + 0j, axis),
        acceleration=_turned(-(speed**2) + 0j, axis),
    )


def _axis_and_speeds(rotation: SteadyRotation, ratios: Array) -> tuple[Array, Array]:
    """The unit axis (3,), and the speeds of the bodies about it (n_b,) [rad/s]."""
    speed = float(np.linalg.norm(rotation.angular_velocity))
    axis = rotation.angular_velocity / speed if speed > 0.0 else np.zeros(3)
    return axis, speed * ratios


def _turned(factor: Any, axis: Array) -> Array:
    """Matrices that multiply by complex numbers (n,) in the plane across an axis (n, 3, 3)."""
    x, y, z = axis
    across = np.eye(3) - np.outer(axis, axis)
    ahead = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    matrices: Array = np.multiply.outer(factor.real, across) + np.multiply.outer(factor.imag, ahead)
    return matrices
