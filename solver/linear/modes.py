"""Modes of a linear model: eigenvalues and shapes, with gyroscopic forces and damping.

First-order form x' = A x in x = (y, v / sigma, e): y the rigid coordinates and the modes of the
bodies, v = y', e the dampers of Maxwell branches, with B y = B v = 0 for the constraints. Instead
of A, whose entries would drown slow motions in the rounding of fast ones,

    (A - sigma)^-1,   eigenvalues 1 / (lambda - sigma)

is applied by the small equations at the real frequency sigma, in which the modes of the bodies are
summed exactly. sigma lies far below the first elastic frequency.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, eig, qr

from ..arrays import Array
from ..errors import ModelError
from ..start.inertia import inverse_root
from ..start.matrices import dense_of
from .equations import Equations
from .flexibility import ModalBody

Complex = NDArray[np.complex128]
SHIFT = 1e-3
"""sigma over a frequency of the model"""
ZERO = 1e-4
"""of sigma: eigenvalues below are motions that nothing resists"""
LARGEST = 1500
"""states up to which all modes are found at once"""


class FirstOrder:
    """(A - sigma)^-1 on coordinates that the constraints leave free.

    basis (n_y, n_free): y = basis a. States a, b, e: y = basis a, v = sigma basis b.
    """

    def __init__(self, equations: Equations) -> None:
        self.equations = equations
        self.bodies: list[ModalBody] = equations.modal_bodies
        t = equations.tangent
        self.phi = block_diag(np.zeros((0, 0)), *(body.phi_active for body in self.bodies))
        self.stiffness = _joined([body.stiffness for body in self.bodies])
        self.damping = _joined([body.damping for body in self.bodies])
        # z = phi eta + bend z
        Z = self.phi + t.bend @ self.phi
        self.embed = block_diag(np.eye(t.sizes.n_r), Z)
        self.basis, self.coordinates = self._basis()
        self.n_free = self.basis.shape[1]
        self.n_e = len(equations.relaxation.row)
        self.sigma = SHIFT * self._frequency()
        self.factors = equations.factorized(self.sigma)
        if not self.factors.conditioned:
            self.sigma *= 1.37
            self.factors = equations.factorized(self.sigma)

    @property
    def n(self) -> int:
        """The number of states."""
        return 2 * self.n_free + self.n_e

    def _basis(self) -> tuple[Array, Array]:
        """The basis, orthonormal in the rigid inertia and that of the modes, and its inverse."""
        system, t = self.equations.pose.system, self.equations.tangent
        root = dense_of(inverse_root(system))
        scale = block_diag(root, np.eye(len(self.stiffness)))
        hard = system.couplings.compliant == 0
        B = t.gradients[hard] @ self.embed @ scale
        length = np.linalg.norm(B, axis=1)
        B /= np.where(length > 0.0, length, 1.0)[:, None]
        Q, _ = qr(B.T)
        free: Array = Q[:, len(B) :]
        inverse = block_diag(np.linalg.inv(root), np.eye(len(self.stiffness)))
        return scale @ free, free.T @ inverse

    def _frequency(self) -> float:
        """A frequency of the model [rad/s]: the lowest of a free body, or those of springs."""
        if len(self.stiffness):
            return float(np.sqrt(self.stiffness.min()))
        t = self.equations.tangent
        compliant = np.flatnonzero(self.equations.pose.system.couplings.compliant)
        rows = t.sizes.rows.start + compliant
        springs = t.gradients[compliant].T @ t.K[rows]
        K = t.K[t.sizes.rigid] + springs[t.sizes.rigid] + 1e-300
        reduced = self.coordinates @ _inverse_inertia(self) @ K @ self.basis
        largest = float(np.sqrt(np.abs(reduced).max(initial=0.0)))
        spin = self.equations.pose.speed
        return max(largest, spin) or 1.0

    def solve(self, y: Any, v: Any, e: Any) -> "States":
        """(A - sigma)^-1 of a state: positions, rates, dampers, multipliers."""
        t, sigma, relaxation = self.equations.tangent, self.sigma, self.equations.relaxation
        sizes, n_r = t.sizes, t.sizes.n_r
        Y, V = self.embed @ y, self.embed @ v
        known = t.M @ (sigma * Y + V) + t.C @ Y
        b = np.zeros((len(known), y.shape[1]), dtype=known.dtype)
        b[sizes.rigid], b[sizes.rows] = -known[sizes.rigid], -known[sizes.rows]
        decay = 1.0 + sigma * relaxation.tau
        pull = (relaxation.kappa * relaxation.tau / decay)[:, None] * e
        np.add.at(b, sizes.rows.start + relaxation.row, -pull)
        pi = known[sizes.active]
        d = (sigma * sigma + self.damping * sigma + self.stiffness)[:, None]
        modal = -(sigma + self.damping)[:, None] * y[n_r:] - v[n_r:]
        b[sizes.active] = self.phi @ (modal / d)
        found = self.factors.solve(b, pi)
        eta = (self.phi.T @ found.pi + modal) / d
        q = np.vstack([found.xi, eta])
        strain = relaxation.gradient @ np.vstack([found.xi, found.z])
        e_new = (strain - relaxation.tau[:, None] * e) / decay[:, None]
        return States(q, sigma * q + y, e_new, found.lam)

    def split(self, x: Any) -> tuple[Any, Any, Any]:
        """Positions, rates and dampers of states (n, k)."""
        n = self.n_free
        return self.basis @ x[:n], self.sigma * (self.basis @ x[n : 2 * n]), x[2 * n :]

    def joined(self, states: "States") -> Any:
        """States (n, k) of positions, rates and dampers."""
        a, b = self.coordinates @ states.y, self.coordinates @ states.v / self.sigma
        return np.vstack([a, b, states.e])

    def apply(self, x: Any) -> Any:
        return self.joined(self.solve(*self.split(x)))

    @cached_property
    def matrix(self) -> Array:
        """(A - sigma)^-1 (n, n)."""
        matrix: Array = self.apply(np.eye(self.n))
        return matrix


@dataclass(frozen=True, eq=False)
class States:
    """Positions y, rates v, dampers e and multipliers, a column for each state."""

    y: Any
    v: Any
    e: Any
    lam: Any


def _inverse_inertia(form: FirstOrder) -> Array:
    root = dense_of(inverse_root(form.equations.pose.system))
    inverse: Array = root @ root.T
    return inverse


def _joined(arrays: list[Array]) -> Array:
    return np.concatenate([np.empty(0), *arrays])


@dataclass(frozen=True, eq=False)
class Modes:
    """Modes of a linear model, in the order of their frequencies.

    values (n,): eigenvalues [rad/s], one of each complex pair, and real ones; those of motions that
    nothing resists are 0, once for each. y (n_y, n): rigid coordinates and modes of the bodies;
    lam (n_i, n): multipliers.
    """

    values: Complex
    y: Complex
    lam: Complex

    def __len__(self) -> int:
        return len(self.values)

    @property
    def frequencies(self) -> Array:
        """With damping [Hz]; 0 of motions that do not oscillate."""
        frequencies: Array = np.abs(self.values.imag) / (2.0 * np.pi)
        return frequencies

    @property
    def ratios(self) -> Array:
        """Damping ratios, negative where a mode grows; 0 of motions that nothing resists."""
        size = np.abs(self.values)
        ratios: Array = -self.values.real / np.where(size > 0.0, size, 1.0)
        return ratios

    @property
    def rigid(self) -> int:
        """The number of motions that nothing resists."""
        return int((self.values == 0.0).sum())

    @property
    def unstable(self) -> Array:
        """True of modes that grow (n,)."""
        growing: Array = self.values.real > 1e-9 * np.abs(self.values)
        return growing


def modes_of(form: FirstOrder, n: int | None) -> Modes:
    """The first n modes, or all; `ModelError` where all are too many."""
    values, x = _eigenvalues(form, n)
    zeros = np.abs(values) < ZERO * form.sigma
    upper = (values.imag > 0.0) | (values.imag == 0.0)
    chosen = np.flatnonzero(upper & ~zeros)
    chosen = chosen[np.lexsort((values[chosen].real, np.abs(values[chosen])))]
    still = _motions_without_resistance(form, x[:, zeros], int(zeros.sum()))
    values, x = values[chosen], x[:, chosen]
    states = form.solve(*form.split(x * (values - form.sigma)))
    found = Modes(
        np.concatenate([np.zeros(still.shape[1]), values]),
        np.hstack([still, states.y]),
        np.hstack([np.zeros((len(states.lam), still.shape[1])), states.lam]),
    )
    if n is None or n >= len(found):
        return found
    return Modes(found.values[:n], found.y[:, :n], found.lam[:, :n])


def _eigenvalues(form: FirstOrder, n: int | None) -> tuple[Complex, Complex]:
    if form.n <= LARGEST or n is None or 2 * n + 26 >= form.n:
        if form.n > LARGEST:
            raise ModelError(
                f"{form.n} states: expected at most {LARGEST} to find all modes, ask for fewer"
            )
        mu, x = eig(form.matrix, check_finite=False)
    else:
        from scipy.sparse.linalg import LinearOperator, eigs

        operator = LinearOperator(
            (form.n, form.n), matvec=lambda x: form.apply(x.reshape(-1, 1))[:, 0], dtype=float
        )
        mu, x = eigs(operator, 2 * n + 24, v0=np.ones(form.n))
    return form.sigma + 1.0 / mu, x


def _motions_without_resistance(form: FirstOrder, x: Complex, n: int) -> Complex:
    """Real motions y, one for each pair of zero eigenvalues, or for each single one.

    A free motion has two, position and velocity, with one eigenvector between them; a rigid body
    that only dampers hold has one.
    """
    if n == 0:
        return np.zeros((len(form.basis), 0), dtype=np.complex128)
    n_free = form.n_free
    y = np.hstack([x[:n_free].real, x[:n_free].imag])
    U, size, _ = np.linalg.svd(y, full_matrices=False)
    kept = int((size > 1e-3 * size[0]).sum())
    still: Complex = (form.basis @ U[:, :kept]).astype(np.complex128)
    return still


def frames_of(form: FirstOrder, y: Any) -> Any:
    """Elastic displacements of all dofs (n_u, k) of motions y."""
    n_r, phi = form.equations.sizes.n_r, block_diag(np.zeros((0, 0)), *(b.phi for b in form.bodies))
    return form.equations.bends @ phi @ y[n_r:]
