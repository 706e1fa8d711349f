"""Time stepping of the whole floating-frame model with the second order of its elastic motion.

As in `monolithic.py`, with all modes eta of the beam as unknowns that have equations of their own:

    z = [u_C; d] = phi eta + 1/2 A(q, q),   q = T eta,   J = J_0 + mat(d),   Gamma = h(q, q')
    d/dt (J omega + Gamma) + omega x (J omega + Gamma) = moments
    eta'' + 2 zeta Omega eta' + Omega^2 eta = (dz/deta)^T [p; s(omega)] + T^T f
    f_l = -omega' . h_kl q_k - omega . (h_kl - h_lk) q'_k - dW/dq_l

d has the rate that the scheme gives a coordinate with its values, which differs from dd/dt by terms
of second order in the step. Nothing is eliminated, and nothing is shared with the solver.
"""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
from scipy import sparse

from .monolithic import Reference


def unit_matrices():
    """mat(d) = sum_c d_c E_c, for d = (11, 22, 33, 23, 13, 12), (6, 3, 3)."""
    E = np.zeros((6, 3, 3))
    for c, (i, j) in enumerate([(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]):
        E[c, i, j] = E[c, j, i] = 1.0
    return E


MAT = unit_matrices()


def modal_structure(element):
    """The modes of a superelement as a structure of unit masses."""
    modes = element.modes
    m = len(modes.omega)
    return SimpleNamespace(
        M=sparse.eye(m),
        K=sparse.diags(modes.omega**2),
        U=np.zeros((m, 0)),
        P_C=sparse.csr_matrix(modes.phi),
        rigid=SimpleNamespace(mass=element.mass, J_rot=element.J_rot),
        interfaces=element.interfaces,
    )


@dataclass
class RotatingReference(Reference):
    """structure: a superelement with modes and `rotation`."""

    iterations: int = 25
    enough: float = 1e-16

    def __post_init__(self):
        self.element, self.rotation = self.structure, self.structure.rotation
        self.structure = modal_structure(self.element)
        if self.element.modes.chain is not None:
            self.tau = tuple(self.element.modes.chain.tau)
            self.amplitude = tuple(self.element.modes.chain.amplitude)
        super().__post_init__()

    def _modal_damping(self):
        modes = self.element.modes
        return np.diag(2.0 * modes.zeta * modes.omega)

    def interfaces(self, u):
        q = self.rotation.T @ u
        return self.P_C @ u + 0.5 * self.rotation.A_interface @ q @ q

    def interface_gradient(self, u):
        q = self.rotation.T @ u
        return self.P_C + self.rotation.A_interface @ q @ self.rotation.T

    def _inertia_changes(self, u):
        """d (6,) and its gradient by u (6, m)."""
        T, A, linear = self.rotation.T, self.rotation.A_inertia, self.rotation.phi_inertia
        q = T @ u
        return linear @ u + 0.5 * A @ q @ q, linear + A @ q @ T

    def _start(self, x, R, u, v, torque, tip_force):
        self.rate_of_d = lambda d: self._inertia_changes(u)[1] @ v[12:]
        v_dot, lam = super()._start(x, R, u, v, torque, tip_force)
        d, D = self._inertia_changes(u)
        self.stepped = (d, D @ v[12:], D @ v_dot[12:], D @ v_dot[12:])
        return v_dot, lam

    def _step(self, *state):
        d, rate, d_ddot, a = self.stepped
        h, ratio = self.h, (1 - self.alpha_f) / (1 - self.alpha_m)
        a_star = (self.alpha_f * d_ddot - self.alpha_m * a) / (1 - self.alpha_m)
        predicted = d + h * rate + h * h * ((0.5 - self.beta) * a + self.beta * a_star)
        rate = rate + h * ((1 - self.gamma) * a + self.gamma * a_star)
        self.rate_of_d = lambda d: rate + self.d_v / self.d_q * (d - predicted)
        found = super()._step(*state)
        d, _ = self._inertia_changes(found[2])
        d_ddot = (d - predicted) / self.d_q
        self.stepped = (d, self.rate_of_d(d), d_ddot, a_star + ratio * d_ddot)
        return found

    def _equations(self, x, R, u, v, v_dot, lam, torque, tip_force):
        residual, phi, B = super()._equations(x, R, u, v, v_dot, lam, torque, tip_force)
        residual[9:12] += self._changing_momentum(u, v, v_dot)
        residual[12:] -= self._inertia_forces(u, v, v_dot) + self.rotation.T.T @ self._stress(u)
        return residual, phi, B

    def _changing_momentum(self, u, v, v_dot):
        """What the changes of the inertia, and Gamma, add to the rate of angular momentum."""
        T, h = self.rotation.T, self.rotation.gyroscopic
        omega = v[9:12]
        q, q_dot, q_ddot = T @ u, T @ v[12:], T @ v_dot[12:]
        d, _ = self._inertia_changes(u)
        change, rate = np.tensordot(d, MAT, 1), np.tensordot(self.rate_of_d(d), MAT, 1)
        momentum = change @ omega + h @ q_dot @ q
        return (
            change @ v_dot[9:12]
            + rate @ omega
            + h @ q_dot @ q_dot
            + h @ q_ddot @ q
            + np.cross(omega, momentum)
        )

    def _inertia_forces(self, u, v, v_dot):
        """On u: what omega . J omega / 2 + omega . h(q, q') gives (m,)."""
        T, h = self.rotation.T, self.rotation.gyroscopic
        omega, omega_dot = v[9:12], v_dot[9:12]
        q, q_dot = T @ u, T @ v[12:]
        s = 0.5 * MAT @ omega @ omega
        turned = np.tensordot(omega, h, 1)
        force = np.tensordot(omega_dot, h, 1).T @ q + (turned.T - turned) @ q_dot
        return self._inertia_changes(u)[1].T @ s - T.T @ force

    def _stress(self, u):
        """-dW/dq (r,)"""
        force, cubic, quartic = (
            np.zeros(self.rotation.r),
            self.rotation.cubic,
            self.rotation.quartic,
        )
        if cubic is not None:
            k = len(cubic)
            q = (self.rotation.T @ u)[:k]
            force[:k] = -0.5 * (cubic @ q @ q + quartic @ q @ q @ q)
        return force
