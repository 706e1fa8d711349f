"""Time stepping of the unreduced floating-frame model: every elastic displacement of the beam is an
unknown.

A hub turns about a pivot at its center and carries a beam that is clamped to its rim. Plain numpy,
written for clarity, and apart from the finite element matrices nothing is shared with the solver:

    hub, beam:  m x'' = f + m g,   J omega' + omega x J omega = t      (rigid motion of frames)
    beam:       M u'' + C u' + K s = P^T P_C^T p,   P^T = I - M U U^T      (all nodes)
                s = u + sum a_k q_k,   q_k' + q_k / tau_k = u'   (by the trapezoidal rule)
    pivot:      x_hub = 0, and for a revolute joint (R_hub e_3) . e_1 = (R_hub e_3) . e_2 = 0
    clamp:      x_hub + R_hub X = x + R (X_root + u_root),   log(R_hub^T R exp(w_root)) = 0

by generalized-alpha (Arnold, Bruls 2007) in the accelerations v_dot of the end of the step, with
multipliers. The iteration matrix leaves out terms of the order of h^2 and is kept within a step: a
fixed number of iterations, ample, brings all residuals down to rounding.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import lu_factor, lu_solve
from scipy.spatial.transform import Rotation

ITERATIONS = 10


def skew(a):
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def exp(psi):
    return Rotation.from_rotvec(psi).as_matrix()


def log(R):
    return Rotation.from_matrix(R).as_rotvec()


def tangent(w):
    """exp(skew(w))^T d exp(skew(w)) = skew(T(w) dw), from the exponential series of -skew(w)."""
    term = total = np.eye(3)
    for k in range(2, 30):
        term = term @ -skew(w) / k
        total = total + term
    return total


@dataclass
class Reference:
    """structure: the beam; J_hub (3, 3) and m_hub; rim (3,) on the hub; revolute about e_3, or
    spherical.
    """

    structure: object
    J_hub: np.ndarray
    m_hub: float
    rim: np.ndarray
    h: float
    rho_inf: float
    revolute: bool = True
    gravity: np.ndarray = field(default_factory=lambda: np.zeros(3))
    zeta: float = 0.0
    tau: tuple = ()
    amplitude: tuple = ()
    iterations: int = ITERATIONS
    enough: float = 0.0

    def __post_init__(self):
        rho, h = self.rho_inf, self.h
        self.alpha_m, self.alpha_f = (2 * rho - 1) / (rho + 1), rho / (rho + 1)
        self.gamma = 0.5 - self.alpha_m + self.alpha_f
        self.beta = 0.25 * (1 - self.alpha_m + self.alpha_f) ** 2
        ratio = (1 - self.alpha_f) / (1 - self.alpha_m)
        # the share of the end's v_dot in displacements and in velocities
        self.d_q, self.d_v = h * h * self.beta * ratio, h * self.gamma * ratio
        s = self.structure
        self.M, self.K, self.U = s.M.toarray(), s.K.toarray(), s.U
        self.C = self._modal_damping()
        self.F = s.P_C.T.toarray() - self.M @ self.U @ (self.U.T @ s.P_C.T.toarray())
        self.P_C = s.P_C.toarray()
        self.m, self.J = s.rigid.mass, s.rigid.J_rot
        self.X_root, self.X_tip = s.interfaces[0].X, s.interfaces[1].X
        self.n_u = len(self.M)
        self.n_rows = 11 if self.revolute else 9
        self.q = np.zeros((len(self.tau), self.n_u))
        half = h / (2 * np.asarray(self.tau))
        self.kept, self.gain = ((1 - half) / (1 + half))[:, None], (1 / (1 + half))[:, None]
        self.d_K = self.d_q * (1 + sum(self.amplitude * self.gain[:, 0]))

    def _modal_damping(self):
        """C = M Phi diag(2 zeta omega) Phi^T M"""
        L = np.linalg.cholesky(self.M)
        inverse = np.linalg.inv(L)
        square, Q = np.linalg.eigh(inverse @ self.K @ inverse.T)
        modes = (inverse.T @ Q)[:, 6:]
        # rounding must not leave damping of rigid motion
        Phi = self.M @ (modes - self.U @ (self.U.T @ (self.M @ modes)))
        return Phi * (2 * self.zeta * np.sqrt(square[6:])) @ Phi.T

    def run(self, torque, tip_force=None, spin=(0.0, 0.0, 0.0)):
        """Hub torque about e_3 (n + 1,) and a dead force on the tip (n + 1, 3), both from t = 0 on.

        Gives the rotation of the hub as matrices (n + 1, 3, 3), the interface displacements (n + 1,
        12), the rigid velocities (n + 1, 12), and force and moment of the clamp on the beam, in
        space (n + 1, 6).
        """
        tip_force = np.zeros((len(torque), 3)) if tip_force is None else tip_force
        spin = np.asarray(spin, dtype=float)
        x = np.array([np.zeros(3), self.rim - self.X_root])
        R = np.array([np.eye(3), np.eye(3)])
        v = np.concatenate([np.zeros(3), spin, np.cross(spin, x[1]), spin, np.zeros(self.n_u)])
        u = np.zeros(self.n_u)
        self.q[:] = 0.0
        self.s = u
        v_dot, lam = self._start(x, R, u, v, torque[0], tip_force[0])
        a = v_dot.copy()
        history = [(R[0], self.interfaces(u), v[:12], self._clamp_wrench(R, u, lam))]
        for t, f in zip(torque[1:], tip_force[1:], strict=True):
            x, R, u, v, v_dot, a, lam = self._step(x, R, u, v, v_dot, a, lam, t, f)
            history.append((R[0], self.interfaces(u), v[:12], self._clamp_wrench(R, u, lam)))
        return [np.array(column) for column in zip(*history, strict=True)]

    def interfaces(self, u):
        """Displacements of the interfaces (n_c,)."""
        return self.P_C @ u

    def interface_gradient(self, u):
        """Of these by u (n_c, n_u)."""
        return self.P_C

    def _step(self, x, R, u, v, v_dot_n, a_n, lam, torque, tip_force):
        h = self.h
        v_dot, lam = np.zeros_like(v_dot_n), lam.copy()
        factors = None
        for _ in range(self.iterations):
            a = (1 - self.alpha_f) * v_dot + self.alpha_f * v_dot_n - self.alpha_m * a_n
            a = a / (1 - self.alpha_m)
            dq = h * v + h * h * ((0.5 - self.beta) * a_n + self.beta * a)
            v_new = v + h * ((1 - self.gamma) * a_n + self.gamma * a)
            x_new = x + np.array([dq[0:3], dq[6:9]])
            R_new = np.array([R[0] @ exp(dq[3:6]), R[1] @ exp(dq[9:12])])
            u_new = u + dq[12:]
            q_new = self.kept * self.q + self.gain * dq[12:]
            self.s = u_new + np.asarray(self.amplitude) @ q_new
            residual, phi, B = self._equations(
                x_new, R_new, u_new, v_new, v_dot, lam, torque, tip_force
            )
            if factors is None:
                factors = lu_factor(self._iteration_matrix(B, v_new))
            change = lu_solve(factors, -np.concatenate([residual, phi / self.d_q]))
            v_dot = v_dot + change[: len(v_dot)]
            lam = lam + change[len(v_dot) :]
            if self.d_q * np.abs(change[: len(v_dot)]).max() < self.enough:
                break
        if self.d_q * np.abs(change[: len(v_dot)]).max() > 1e-14:
            raise RuntimeError("the reference did not converge")
        self.q = q_new
        return x_new, R_new, u_new, v_new, v_dot, a, lam

    def _iteration_matrix(self, B, v):
        """d residual / d v_dot and d phi / d v_dot / d_q, without derivatives of B^T lambda."""
        n = 12 + self.n_u
        A = np.zeros((n + self.n_rows, n + self.n_rows))
        A[0:3, 0:3], A[6:9, 6:9] = self.m_hub * np.eye(3), self.m * np.eye(3)
        for first, J in ((3, self.J_hub), (9, self.J)):
            omega = v[first : first + 3]
            A[first : first + 3, first : first + 3] = J + self.d_v * (
                skew(omega) @ J - skew(J @ omega)
            )
        A[12:n, 12:n] = self.M + self.d_v * self.C + self.d_K * self.K
        A[:n, n:] = -self._filtered(B.T)
        A[n:, :n] = B
        return A

    def _filtered(self, forces):
        """Generalized forces whose part on u has been made free of rigid accelerations."""
        elastic = forces[12:] - self.M @ (self.U @ (self.U.T @ forces[12:]))
        return np.concatenate([forces[:12], elastic])

    def _equations(self, x, R, u, v, v_dot, lam, torque, tip_force):
        """Residuals of equilibrium (12 + n_u,) and of the constraints and the Jacobian B
        of these.
        """
        u_C, D = self.interfaces(u), self.interface_gradient(u)
        phi, B = self._constraints(x, R, u_C, D)
        F = R[1].T @ tip_force
        forces = B.T @ lam
        forces[0:3] += self.m_hub * self.gravity
        forces[3:6] += R[0].T @ [0.0, 0.0, torque]
        forces[6:9] += tip_force + self.m * self.gravity
        forces[9:12] += np.cross(self.X_tip + u_C[6:9], F)
        forces[12:] += D[6:9].T @ F
        forces = self._filtered(forces)
        inertia = np.concatenate(
            [
                self.m_hub * v_dot[0:3],
                self.J_hub @ v_dot[3:6] + np.cross(v[3:6], self.J_hub @ v[3:6]),
                self.m * v_dot[6:9],
                self.J @ v_dot[9:12] + np.cross(v[9:12], self.J @ v[9:12]),
                self.M @ v_dot[12:] + self.C @ v[12:] + self.K @ self.s,
            ]
        )
        return inertia - forces, phi, B

    def _constraints(self, x, R, u_C, D):
        lever, w = self.X_root + u_C[:3], u_C[3:6]
        W = exp(w)
        phi = [x[0]]
        B_q, B_C = np.zeros((self.n_rows, 12)), np.zeros((self.n_rows, 12))
        B_q[0:3, 0:3] = np.eye(3)
        if self.revolute:
            phi.append((R[0] @ [0, 0, 1])[:2])
            B_q[3:5, 3:6] = -(R[0] @ skew([0, 0, 1]))[:2]
        i = self.n_rows - 6
        phi += [x[1] + R[1] @ lever - x[0] - R[0] @ self.rim, log(R[0].T @ R[1] @ W)]
        B_q[i : i + 3, 0:3] = -np.eye(3)
        B_q[i : i + 3, 3:6] = R[0] @ skew(self.rim)
        B_q[i : i + 3, 6:9] = np.eye(3)
        B_q[i : i + 3, 9:12] = -R[1] @ skew(lever)
        B_C[i : i + 3, 0:3] = R[1]
        # where the constraint holds, both frames have the same axes and d log is the difference of
        # the rotations
        B_q[i + 3 :, 3:6] = -np.eye(3)
        B_q[i + 3 :, 9:12] = W.T
        B_C[i + 3 :, 3:6] = tangent(w)
        return np.concatenate(phi), np.hstack([B_q, B_C @ D])

    def _start(self, x, R, u, v, torque, tip_force):
        """Accelerations and multipliers that satisfy equilibrium and the constraints' second
        derivative.
        """
        n = 12 + self.n_u
        v_dot, lam = np.zeros(n), np.zeros(self.n_rows)
        residual, _, B = self._equations(x, R, u, v, v_dot, lam, torque, tip_force)
        # centripetal terms; the axes of hub and beam turn together, so that the other rows have
        # none
        convective = np.zeros(self.n_rows)
        spin = v[3:6]
        lever = np.cross(spin, np.cross(spin, self.X_root)) - np.cross(
            spin, np.cross(spin, self.rim)
        )
        convective[self.n_rows - 6 : self.n_rows - 3] = lever
        A = self._iteration_matrix(B, np.zeros(n))
        A[12:n, 12:n] = self.M
        solution = np.linalg.solve(A, -np.concatenate([residual, convective]))
        return solution[:n], solution[n:]

    def _clamp_wrench(self, R, u, lam):
        moment = lam[-3:]
        return np.concatenate([lam[-6:-3], R[0] @ moment])
