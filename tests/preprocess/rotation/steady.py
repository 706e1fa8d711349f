"""Vibrations of one supported body about steady rotation, from the numbers of its superelement.

    L = 1/2 m v^2 + 1/2 w.J w + w.h(q, q') + 1/2 eta'^2 - 1/2 omega^2 eta^2 + F.x_F - lambda.c

in the coordinates v = [x, psi, y] with outputs y = phi eta, and their rates, differentiated
numerically; all functions take rows of points.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg as sl
from duhamel.superelement import Superelement
from scipy.spatial.transform import Rotation as Turn

STEP = 1e-3
RIGID = 6


@dataclass(frozen=True)
class Support:
    """Rows 0 to 2 hold the place of an interface, 3 to 5 its orientation."""

    interface: int
    rows: Sequence[int] = range(6)


class Steady:
    """A body that turns by `spin` [rad/s] with its supports, under a dead force on an interface.

    The axis of rotation goes through the first interface.
    """

    def __init__(self, element: Superelement, supports, spin=(0, 0, 0), force=(0, 0, 0), at=1):
        self.element, self.supports = element, supports
        self.spin, self.force, self.at = np.array(spin, float), np.array(force, float), at
        rotation, modes = element.rotation, element.modes
        self.A = np.concatenate([rotation.A_interface, rotation.A_inertia])
        self.phi = np.vstack([modes.phi, rotation.phi_inertia, rotation.T])
        self.squares = modes.omega**2
        self.n = RIGID + len(self.phi)
        self.rigid, self.eta = np.zeros(RIGID), np.zeros(len(modes.omega))
        self.reactions = np.zeros(sum(len(support.rows) for support in supports))

    def parts(self, v):
        """x, the turn R, z = y + 1/2 A(q, q), and q."""
        y, q = np.split(v[:, RIGID:], [len(self.A)], axis=1)
        z = y + 0.5 * np.einsum("ckl,pk,pl->pc", self.A, q, q, optimize=True)
        x = v[:, :3] - self.element.interfaces[0].X
        return x, Turn.from_rotvec(v[:, 3:RIGID]), z, q

    def kinetic(self, v, rate):
        """Without 1/2 eta'^2; rates are those in the turning frame, near psi = 0."""
        x, R, z, q = self.parts(v)
        d = z[:, -6:]
        J = self.element.J_rot + d[:, [[0, 5, 4], [5, 1, 3], [4, 3, 2]]]
        psi, psi_rate = v[:, 3:RIGID], rate[:, 3:RIGID]
        turning = psi_rate - 0.5 * np.cross(psi, psi_rate)
        w = R.inv().apply(self.spin) + turning
        speed = rate[:, :3] + np.cross(self.spin, x)
        h = self.element.rotation.gyroscopic
        Gamma = np.einsum("ikl,pk,pl->pi", h, q, rate[:, RIGID + len(self.A) :], optimize=True)
        linear = 0.5 * self.element.mass * (speed**2).sum(axis=1)
        return linear + 0.5 * np.einsum("pi,pij,pj->p", w, J, w) + (w * Gamma).sum(axis=1)

    def pose(self, v, interface):
        """Place and rotation vector (p, 6) of an interface."""
        x, R, z, _ = self.parts(v)
        u = z[:, RIGID * interface : RIGID * (interface + 1)]
        place = x + R.apply(self.element.interfaces[interface].X + u[:, :3])
        return np.hstack([place, (R * Turn.from_rotvec(u[:, 3:])).as_rotvec()])

    def constraints(self, v):
        start = np.zeros((1, self.n))
        held = [
            (self.pose(v, support.interface) - self.pose(start, support.interface))
            for support in self.supports
        ]
        return np.hstack(
            [c[:, list(support.rows)] for c, support in zip(held, self.supports, strict=True)]
        )

    def lagrangian(self, v, rate):
        """Without what is linear in the modes."""
        value = self.kinetic(v, rate) - self.constraints(v) @ self.reactions
        return value + self.pose(v, self.at)[:, :3] @ self.force if self.force.any() else value

    @property
    def v(self):
        return np.concatenate([self.rigid, self.phi @ self.eta])

    @property
    def modes(self):
        """Rows of v in terms of [rigid, eta]."""
        return sl.block_diag(np.eye(RIGID), self.phi.T)

    def stiffness(self):
        """K in [rigid, eta], and the derivative B of the constraints."""
        L = self.modes
        K = -L @ hessian(lambda v: self.lagrangian(v, 0.0 * v), self.v) @ L.T
        K[RIGID:, RIGID:] += np.diag(self.squares)
        return K, differences(self.constraints, self.v) @ L.T

    def inertia(self):
        """The mass matrix M and the gyroscopic matrix G in [rigid, eta]."""
        L, at = self.modes, np.concatenate([self.v, np.zeros(self.n)])
        H = hessian(lambda both: self.kinetic(*np.split(both, 2, axis=1)), at)
        M, C = (L @ X @ L.T for X in (H[self.n :, self.n :], H[self.n :, : self.n]))
        M[RIGID:, RIGID:] += np.eye(len(self.eta))
        return M, C - C.T

    def solve(self):
        """Newton's method to the steady state."""
        elastic, stiff = self.squares**-0.5, self.element.mass * max(1.0, self.spin @ self.spin)
        scale = np.concatenate([np.full(RIGID, stiff**-0.5), elastic, 0.0 * self.reactions])
        scale[RIGID + len(elastic) :] = stiff**0.5
        for _ in range(20):
            K, B = self.stiffness()
            rest = differences(lambda v: self.lagrangian(v, 0.0 * v)[:, None], self.v)[0]
            gradient = self.modes @ rest
            gradient[RIGID:] -= self.squares * self.eta
            S = np.block([[K, B.T], [B, np.zeros((len(B), len(B)))]])
            residual = np.concatenate([gradient, -self.constraints(self.v[None])[0]])
            step = scale * sl.lstsq(S * np.outer(scale, scale), scale * residual, cond=1e-13)[0]
            rigid, eta, reactions = np.split(step, [RIGID, RIGID + len(self.eta)])
            self.rigid, self.eta = self.rigid + rigid, self.eta + eta
            self.reactions = self.reactions + reactions
            if np.abs(rigid).max() < 1e-9:
                return self
        raise AssertionError("no steady state")

    def frequencies(self, keep=30):
        """Circular frequencies, ascending, and the motions [rigid, eta] (., n) of vibrations."""
        K, B = self.stiffness()
        Z = sl.null_space(B)
        K, M, G = (Z.T @ X @ Z for X in (K, *self.inertia()))
        _, Y = sl.eigh(K, M)
        Y, n = Y[:, :keep], min(keep, len(K))
        K, M, G = (Y.T @ X @ Y for X in (K, M, G))
        free = np.linalg.solve(M, -np.hstack([K, G]))
        values, vectors = np.linalg.eig(np.vstack([np.eye(n, 2 * n, n), free]))
        up = np.flatnonzero(values.imag > 1e-9)
        up = up[np.argsort(values[up].imag)]
        return values[up].imag, Z @ Y @ vectors[:n, up]

    def least_stiffness(self):
        """The lowest eigenvalue of K of what the supports allow: negative once it has buckled."""
        K, B = self.stiffness()
        Z = sl.null_space(B)
        M = sl.block_diag(self.element.mass * np.eye(3), self.element.J_rot, np.eye(len(self.eta)))
        return sl.eigh(Z.T @ K @ Z, Z.T @ M @ Z, eigvals_only=True, subset_by_index=[0, 0])[0]


def differences(f, at):
    """The derivative (k, n) of f (p, k) by central differences."""
    steps = STEP * np.eye(len(at))
    return (f(at + steps) - f(at - steps)).T / (2.0 * STEP)


def hessian(f, at):
    """The second derivative (n, n) of f (p,) by central differences."""
    n = len(at)
    steps = STEP * np.eye(n)
    total = np.zeros((n, n))
    for i in range(n):
        for sign in (1.0, -1.0):
            ahead, behind = (at + sign * steps[i] + way * steps for way in (1.0, -1.0))
            total[i] += sign * (f(ahead) - f(behind))
    return (total + total.T) / (8.0 * STEP**2)
