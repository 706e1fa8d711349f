"""A body of `dense_elements`, all matrices dense: frames, rigid motion, modes, time stepping."""

from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import block_diag, eigh


def arms(X):
    """(n, 3, 6): displacements of points at X (n, 3) under displacement and small rotation."""
    A = np.zeros((len(X), 3, 6))
    A[:, :, :3] = np.eye(3)
    A[:, 0, 4], A[:, 0, 5] = X[:, 2], -X[:, 1]
    A[:, 1, 3], A[:, 1, 5] = -X[:, 2], X[:, 0]
    A[:, 2, 3], A[:, 2, 4] = X[:, 1], -X[:, 0]
    return A


@dataclass
class DenseBody:
    """K, M (n, n) of nodes at points (p, 3) with `width` = 3 or 6 dofs each.

    frames: by name X (3,) and D (6 or 3, n), q = D u; sensors: by name S (s, n); T: all nodes from
    those that follow no rigid frame, and these.
    """

    points: np.ndarray
    K: np.ndarray
    M: np.ndarray
    width: int
    frames: dict = field(default_factory=dict)
    sensors: dict = field(default_factory=dict)
    T: np.ndarray | None = None

    def add_mass(self, D, mass, inertia):
        self.M = self.M + D.T @ block_diag(mass * np.eye(3), inertia)[: len(D), : len(D)] @ D

    def tie(self, frames):
        """Nodes (solids) of rigid frames follow them: frames: [(name, X, nodes)]."""
        tied = np.concatenate([nodes for _, _, nodes in frames]) if frames else np.array([], int)
        free = np.setdiff1d(np.arange(len(self.points)), tied)
        n = 3 * len(free)
        T = np.zeros((3 * len(self.points), n + 6 * len(frames)))
        T[(3 * free[:, None] + np.arange(3)).ravel(), np.arange(n)] = 1.0
        for i, (_, X, nodes) in enumerate(frames):
            rows = (3 * nodes[:, None] + np.arange(3)).ravel()
            T[rows, n + 6 * i : n + 6 * i + 6] = arms(self.points[nodes] - X).reshape(-1, 6)
        self.T = T
        self.K, self.M = T.T @ self.K @ T, T.T @ self.M @ T
        self.sensors = {name: S @ T for name, S in self.sensors.items()}
        self.frames = {name: (X, D @ T) for name, (X, D) in self.frames.items()}
        for i, (name, X, _) in enumerate(frames):
            pick = np.zeros((6, T.shape[1]))
            pick[:, n + 6 * i : n + 6 * i + 6] = np.eye(6)
            self.frames[name] = (X, pick)

    def rigid(self, about):
        """Rigid motions (n, 6) about a point."""
        A = arms(self.points - about)
        if self.width == 6:
            U = np.zeros((len(A), 6, 6))
            U[:, :3], U[:, 3:, 3:] = A, np.eye(3)
            return U.reshape(-1, 6)
        U = A.reshape(-1, 6)
        return U if self.T is None else np.linalg.lstsq(self.T, U, rcond=None)[0]

    def inertia(self):
        """Mass, center and moments of inertia about it."""
        U = self.rigid(np.zeros(3))
        moments = U.T @ self.M @ U
        mass = moments[0, 0]
        center = np.array([moments[1, 5], moments[2, 3], moments[0, 4]]) / mass
        U = self.rigid(center)
        return mass, center, (U.T @ self.M @ U)[3:, 3:]

    def modes(self):
        """Squares (m,) and shapes (n, m) of unit mass of the elastic modes, free."""
        squares, V = eigh(self.K, self.M)
        return squares[6:], V[:, 6:]

    def held(self, D):
        """All modes with D u = 0: squares and shapes."""
        N = np.linalg.svd(D, full_matrices=True)[2][len(D) :].T
        squares, V = eigh(N.T @ self.K @ N, N.T @ self.M @ N)
        return squares, N @ V

    def with_rigid(self):
        """All modes of the free body: the rigid ones, of squares 0, first."""
        squares, V = self.modes()
        _, center, _ = self.inertia()
        U = self.rigid(center)
        U = U @ np.linalg.inv(np.linalg.cholesky(U.T @ self.M @ U)).T
        return np.concatenate([np.zeros(6), squares]), np.hstack([U, V])

    def damping(self, table):
        """C (n, n) of a table [damping], of the elastic motion of the free body."""
        squares, V = self.modes()
        omega = np.sqrt(squares)
        if "modal" in table:
            ratios = table["modal"]
            zeta = np.interp(omega / (2 * np.pi), ratios["frequencies"], ratios["ratios"])
        elif "rayleigh" in table:
            zeta = 0.5 * (
                table["rayleigh"]["mass"] / omega + table["rayleigh"]["stiffness"] * omega
            )
        else:
            zeta = np.zeros_like(omega)
        MV = self.M @ V
        return (MV * (2 * zeta * omega)) @ MV.T

    @property
    def rows(self):
        """Of all frames, in their order."""
        return np.vstack([D for _, D in self.frames.values()])


@dataclass
class Motion:
    """Of modal coordinates (n + 1, m), and what is left over for constraints."""

    eta: np.ndarray
    rate: np.ndarray
    acceleration: np.ndarray
    stretch: np.ndarray
    """eta + sum a q: by which the stiffness pulls"""


def stepped(squares, C, load, h, rho_inf, tau=(), amplitude=()):
    """From rest, by generalized-alpha: load (n + 1, m).

    eta'' + C eta' + squares (eta + sum a q) = load,   q' + q / tau = eta' by the trapezoidal rule
    """
    alpha_m, alpha_f = (2 * rho_inf - 1) / (rho_inf + 1), rho_inf / (rho_inf + 1)
    gamma = 0.5 - alpha_m + alpha_f
    beta = 0.25 * (1 - alpha_m + alpha_f) ** 2
    ratio = (1 - alpha_f) / (1 - alpha_m)
    tau, amplitude = np.array(tau), np.array(amplitude)
    kept = ((1 - h / (2 * tau)) / (1 + h / (2 * tau)))[:, None]
    gain = (1 / (1 + h / (2 * tau)))[:, None]
    harder = 1.0 + float(amplitude @ gain[:, 0])
    step = np.eye(len(C)) + gamma * h * ratio * C + np.diag(beta * h * h * ratio * squares * harder)
    inverse = np.linalg.inv(step)
    eta = rate = np.zeros(len(C))
    acceleration = a = load[0]
    q = np.zeros((len(tau), len(C)))
    found = [(eta, rate, acceleration, eta)]
    for f in load[1:]:
        known = (alpha_f * acceleration - alpha_m * a) / (1 - alpha_m)
        new = eta + h * rate + h * h * ((0.5 - beta) * a + beta * known)
        rate = rate + h * ((1 - gamma) * a + gamma * known)
        stretch = new + amplitude @ (kept * q + gain * (new - eta))
        acceleration = inverse @ (f - C @ rate - squares * stretch)
        a = ratio * acceleration + known
        new, rate = (
            new + beta * h * h * ratio * acceleration,
            rate + gamma * h * ratio * acceleration,
        )
        q = kept * q + gain * (new - eta)
        eta = new
        found.append((eta, rate, acceleration, eta + amplitude @ q))
    return Motion(*map(np.array, zip(*found, strict=True)))
