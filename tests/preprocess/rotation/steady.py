"""Vibrations of one supported body about steady rotation, from the numbers of its superelement.

    L = 1/2 m v^2 + 1/2 w.J w + w.h(q, q') + 1/2 eta'^2 - 1/2 omega^2 eta^2 + F.x_F - lambda.c

in the coordinates v = [x, psi, y] with outputs y = phi eta, differentiated numerically.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg as sl
from duhamel.superelement import Superelement
from scipy.spatial.transform import Rotation as Turn

STEP = 1e-4
RIGID = 6


def skew(a):
    return np.cross(np.eye(3), a)


def matrix(d):
    return np.array([[d[0], d[5], d[4]], [d[5], d[1], d[3]], [d[4], d[3], d[2]]])


@dataclass(frozen=True)
class Support:
    """Rows 0 to 2 hold the place of an interface, 3 to 5 its orientation."""

    interface: int
    rows: Sequence[int] = range(6)


class Steady:
    """A body that turns by `spin` [rad/s] with its supports, under a dead force on an interface."""

    def __init__(self, element: Superelement, supports, spin=(0, 0, 0), force=(0, 0, 0), at=1):
        self.element, self.supports = element, supports
        self.rotation, self.modes = element.rotation, element.modes
        self.spin, self.force, self.at = np.array(spin, float), np.array(force, float), at
        # The axis of rotation goes through the first interface.
        self.place = -element.interfaces[0].X
        self.phi = np.vstack([self.modes.phi, self.rotation.phi_inertia, self.rotation.T])
        self.n = RIGID + len(self.phi)
        self.m = len(self.modes.omega)
        rows = sum(len(support.rows) for support in supports)
        self.rigid, self.eta, self.force_of_support = np.zeros(6), np.zeros(self.m), np.zeros(rows)

    @cached_property
    def A(self):
        return np.concatenate([self.rotation.A_interface, self.rotation.A_inertia])

    def parts(self, v):
        """x, R, z and q."""
        n_d = len(self.A)
        y, q = v[RIGID : RIGID + n_d], v[RIGID + n_d :]
        z = y + 0.5 * (self.A @ q) @ q
        return self.place + v[:3], Turn.from_rotvec(v[3:6]).as_matrix(), z, q

    def kinetic(self, v, rate):
        """T without 1/2 eta'^2, of rates in the turning frame."""
        x, R, z, q = self.parts(v)
        J = self.element.J_rot + matrix(z[-6:])
        S = skew(v[3:6])
        turning = rate[3:6] - 0.5 * S @ rate[3:6] + S @ (S @ rate[3:6]) / 6.0
        w, speed = R.T @ self.spin + turning, rate[:3] + np.cross(self.spin, x)
        Gamma = (self.rotation.gyroscopic @ rate[RIGID + len(self.A) :]) @ q
        return 0.5 * self.element.mass * speed @ speed + 0.5 * w @ J @ w + w @ Gamma

    def place_of(self, v, interface):
        x, R, z, _ = self.parts(v)
        u = z[6 * interface : 6 * interface + 6]
        turn = Turn.from_matrix(R) * Turn.from_rotvec(u[3:])
        return np.concatenate(
            [x + R @ (self.element.interfaces[interface].X + u[:3]), turn.as_rotvec()]
        )

    def constraints(self, v):
        start = np.zeros(self.n)
        return np.concatenate(
            [
                (self.place_of(v, s.interface) - self.place_of(start, s.interface))[list(s.rows)]
                for s in self.supports
            ]
        )

    def lagrangian(self, v, rate):
        """Without the linear part of the modes."""
        value = self.kinetic(v, rate) + self.force @ self.place_of(v, self.at)[:3]
        return value - self.force_of_support @ self.constraints(v)

    @property
    def v(self):
        return np.concatenate([self.rigid, self.phi @ self.eta])

    def solve(self):
        """Newton's method to the steady state."""
        for _ in range(20):
            K, B = self.stiffness()
            gradient = self.to_modes(self.gradient(self.v))
            gradient[RIGID:] -= self.modes.omega**2 * self.eta
            residual = np.concatenate([gradient, -self.constraints(self.v)])
            S = np.block([[K, B.T], [B, np.zeros((len(B), len(B)))]])
            scale = np.ones(len(S))
            scale[RIGID : RIGID + self.m] = 1.0 / self.modes.omega
            step = scale * sl.lstsq(S * np.outer(scale, scale), scale * residual, cond=1e-13)[0]
            self.rigid += step[:RIGID]
            self.eta += step[RIGID : RIGID + self.m]
            self.force_of_support += step[RIGID + self.m :]
            if np.abs(step[:RIGID]).max() < 1e-10:
                break
        return self

    def stiffness(self):
        """K and the derivative B of the constraints in [rigid, eta]."""
        zero = np.zeros(self.n)
        H = differences(lambda v: self.gradient(v), self.v)
        B = differences(self.constraints, self.v)
        K = self.to_modes(self.to_modes(-0.5 * (H + H.T)).T)
        K[RIGID:, RIGID:] += np.diag(self.modes.omega**2)
        assert not zero.any()
        return K, self.to_modes(B.T).T

    def gradient(self, v):
        rest = np.zeros(self.n)
        return differences(lambda v: np.atleast_1d(self.lagrangian(v, rest)), v)[0]

    def to_modes(self, rows):
        return np.concatenate([rows[:RIGID], self.phi.T @ rows[RIGID:]])

    def reduced(self):
        """K, M and the gyroscopic G of motions that the supports allow, and these motions."""
        K, B = self.stiffness()
        rest = np.zeros(self.n)

        def momenta(v, rate):
            return differences(lambda r: np.atleast_1d(self.kinetic(v, r)), rate)[0]

        M = differences(lambda rate: momenta(self.v, rate), rest)
        C = differences(lambda v: momenta(v, rest), self.v)
        M, G = (self.to_modes(self.to_modes(X).T).T for X in (0.5 * (M + M.T), C - C.T))
        M[RIGID:, RIGID:] += np.eye(self.m)
        Z = sl.null_space(B)
        return Z.T @ K @ Z, Z.T @ M @ Z, Z.T @ G @ Z, Z

    def frequencies(self, keep=30):
        """Circular frequencies, ascending, and the motions [rigid, eta] (., n) of vibrations."""
        K, M, G, Z = self.reduced()
        _, Y = sl.eigh(K, M)
        Y = Y[:, :keep]
        K, M, G, Z = Y.T @ K @ Y, Y.T @ M @ Y, Y.T @ G @ Y, Z @ Y
        n = len(K)
        first = np.block(
            [[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, K), -np.linalg.solve(M, G)]]
        )
        values, vectors = np.linalg.eig(first)
        up = np.flatnonzero(values.imag > 1e-9)
        up = up[np.argsort(values[up].imag)]
        return values[up].imag, Z @ vectors[:n, up]

    def least_stiffness(self):
        """The lowest eigenvalue of K against M: negative once the body has buckled."""
        K, M, _, _ = self.reduced()
        return sl.eigh(0.5 * (K + K.T), M, eigvals_only=True, subset_by_index=[0, 0])[0]


def differences(f, at):
    """The derivative of f by central differences."""
    columns = []
    for i in range(len(at)):
        ahead, behind = at.copy(), at.copy()
        ahead[i] += STEP
        behind[i] -= STEP
        columns.append((f(ahead) - f(behind)) / (2.0 * STEP))
    return np.array(columns).T
