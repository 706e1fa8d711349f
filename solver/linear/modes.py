"""Modes of a linear model: eigenvalues and shapes, with gyroscopic forces and damping.

First-order form x' = A x in x = (y, v / sigma, e): y the rigid coordinates and the modes of the
bodies, v = y', e the dampers of Maxwell branches, with B y = B v = 0 for the constraints. Instead
of A, whose entries would drown slow motions in the rounding of fast ones,

    (A - sigma)^-1,   eigenvalues 1 / (lambda - sigma)

is applied by the small equations at the real frequency sigma, in which the modes of the bodies are
summed exactly. sigma lies far below the first elastic frequency.
"""

from copy import copy
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Index
from ..errors import ModelError
from ..start.inertia import inverse_root
from ..start.matrices import dense_of
from .blocks import diagonal_blocks
from .equations import Equations, Forcing
from .flexibility import ModalBody
from .subspace import MIN_BLOCK, RIGID_EIGENVALUE, Subspace, slowest

Complex = NDArray[np.complex128]
# sigma over a frequency of the model
SHIFT_RATIO = 0.03
MAX_FOLLOWING = 12
# relative, from an eigenvalue of a free body, where its modes have a pole
POLE_DISTANCE = 1e-13
# relative change that ends an iteration
EIGENVALUE_TOLERANCE = 1e-12
# of the size of an eigenvalue. Pairs that coincide have growths of the root of rounding.
MIN_GROWTH = 1e-6
# all modes are found at once up to here
MAX_DENSE_STATES = 1500
# up to here all modes take no longer than a few
QUICK_STATES = 240


class FirstOrder:
    """(A - sigma)^-1 on coordinates that the constraints leave free.

    basis (n_y, n_free): y = basis a. States a, b, e: y = basis a, v = sigma basis b.
    """

    def __init__(self, equations: Equations) -> None:
        self.equations = equations
        self.bodies: list[ModalBody] = equations.modal_bodies
        t = equations.tangent
        self.loading = diagonal_blocks([body.phi_loaded for body in self.bodies])
        self.phi = self.loading[equations.acting]
        self.stiffness = _joined([body.stiffness for body in self.bodies])
        self.damping = _joined([body.damping for body in self.bodies])
        # z = phi eta + bend z
        # Displacements of interfaces follow q of second order by the bend.
        Z = self.phi + t.bend @ self.phi
        self.embed = diagonal_blocks([np.eye(t.sizes.n_r), Z])
        self.basis, self.coordinates = self._basis()
        self.n_free = self.basis.shape[1]
        self.chains = _chains(self.bodies)
        self.n_e = sum(self._dampers)
        self.sigma: Any = SHIFT_RATIO * self._frequency()
        self.factors = equations.factorized(self.sigma)
        if not self.factors.conditioned:
            # An eigenvalue happened to be there: any other shift will do.
            self.sigma *= 1.37
            self.factors = equations.factorized(self.sigma)

    @property
    def n(self) -> int:
        """The number of states."""
        return int(2 * self.n_free + self.n_e)

    def _basis(self) -> tuple[Array, Array]:
        """The basis, orthonormal in the rigid inertia and that of the modes, and its inverse."""
        system, t = self.equations.pose.system, self.equations.tangent
        root = dense_of(inverse_root(system))
        scale = diagonal_blocks([root, np.eye(len(self.stiffness))])
        hard = system.couplings.compliant == 0
        B = t.gradients[hard] @ self.embed @ scale
        length = np.linalg.norm(B, axis=1)
        B /= np.where(length > 0.0, length, 1.0)[:, None]
        # The last columns of Q span what the rows of B leave free.
        Q, _ = np.linalg.qr(B.T, mode="complete")
        free: Array = Q[:, len(B) :]
        inverse = diagonal_blocks([np.linalg.inv(root), np.eye(len(self.stiffness))])
        return scale @ free, free.T @ inverse

    def _frequency(self) -> float:
        """A frequency of the model [rad/s]: the lowest of a free body, or those of springs."""
        if len(self.stiffness):
            return float(np.sqrt(self.stiffness.min()))
        t = self.equations.tangent
        compliant = np.flatnonzero(self.equations.pose.system.couplings.compliant)
        rows = t.sizes.rows.start + compliant
        springs = t.gradients[compliant].T @ t.K[rows]
        # 1e-300: a model without any stiffness has a frequency of zero, not of nan.
        K = t.K[t.sizes.rigid] + springs[t.sizes.rigid] + 1e-300
        reduced = self.coordinates @ _inverse_inertia(self) @ K @ self.basis
        largest = float(np.sqrt(np.abs(reduced).max(initial=0.0)))
        spin = self.equations.pose.speed
        return max(largest, spin) or 1.0

    def is_zero(self, value: complex) -> bool:
        """Whether an eigenvalue is that of a motion that nothing resists."""
        return bool(abs(value) < RIGID_EIGENVALUE * self.sigma)

    def at(self, sigma: complex) -> "FirstOrder":
        """The same with another sigma."""
        other = copy(self)
        other.sigma, other.factors = sigma, self.equations.factorized(sigma)
        return other

    @property
    def _dampers(self) -> tuple[int, int, int]:
        """Numbers of branches of laws, of integrals of motors, and of springs of chains."""
        equations = self.equations
        return len(equations.relaxation.row), len(equations.integrals.row), len(self.chains.mode)

    def solve(self, y: Any, v: Any, e: Any) -> "States":
        """(A - sigma)^-1 of a state: positions, rates, dampers, multipliers."""
        t, sigma = self.equations.tangent, self.sigma
        relaxation, integrals, chains = (
            self.equations.relaxation,
            self.equations.integrals,
            self.chains,
        )
        sizes, n_r = t.sizes, t.sizes.n_r
        e_law, e_motor, e_chain = np.split(e, np.cumsum(self._dampers)[:2])
        Y, V = self.embed @ y, self.embed @ v
        # From v = sigma y + given and M v' + C v + K y: everything known on the right.
        known = t.M @ (sigma * Y + V) + t.C @ Y
        b = np.zeros((len(known), y.shape[1]), dtype=known.dtype)
        b[sizes.rigid], b[sizes.rows] = -known[sizes.rigid], -known[sizes.rows]
        decay = 1.0 + sigma * relaxation.tau
        pull = (relaxation.kappa * relaxation.tau / decay)[:, None] * e_law
        np.add.at(b, sizes.rows.start + relaxation.row, -pull)
        b[sizes.rows.start + integrals.row] += (integrals.gain / sigma)[:, None] * e_motor
        pi = self.equations.spread(known[sizes.active])
        modal = -(sigma + self.damping)[:, None] * y[n_r:] - v[n_r:]
        slack = 1.0 + sigma * chains.tau
        np.add.at(modal, chains.mode, -(chains.kappa * chains.tau / slack)[:, None] * e_chain)
        d = self.step(sigma)[:, None]
        b[sizes.active] = self.phi @ (modal / d)
        found = self.factors.solve(b, pi)
        eta = (self.loading.T @ found.pi + modal) / d
        strain = np.vstack([found.xi, found.z])
        relaxed = relaxation.gradient @ strain - relaxation.tau[:, None] * e_law
        summed = (integrals.gradient @ strain - e_motor) / sigma
        chained = (eta[chains.mode] - chains.tau[:, None] * e_chain) / slack[:, None]
        q = np.vstack([found.xi, eta])
        e_new = np.vstack([relaxed / decay[:, None], summed, chained])
        return States(q, sigma * q + y, e_new, found.lam)

    def forced(self, forces: Forcing) -> Any:
        """The state (n, n_in) under unit inputs at the frequency sigma."""
        relaxation, integrals, sigma = (
            self.equations.relaxation,
            self.equations.integrals,
            self.sigma,
        )
        found = self.factors.forced(forces)
        eta = (self.loading.T @ found.pi) / self.step(sigma)[:, None]
        y, strain = np.vstack([found.xi, eta]), np.vstack([found.xi, found.z])
        e = np.vstack(
            [
                (relaxation.gradient @ strain) / (1.0 + sigma * relaxation.tau)[:, None],
                integrals.gradient @ strain / sigma,
                eta[self.chains.mode] / (1.0 + sigma * self.chains.tau)[:, None],
            ]
        )
        return self.joined(States(y, sigma * y, e, found.lam))

    def step(self, s: complex) -> Any:
        """s^2 + 2 zeta omega s + omega^2 c(s) of the modes of all bodies."""
        return _joined([body.step(s) for body in self.bodies])

    def split(self, x: Any) -> tuple[Any, Any, Any]:
        """Positions, rates and dampers of states (n, k)."""
        # Rates are stored over sigma: both halves of a state then have the size of positions.
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
class Chains:
    """The springs of the chains of all bodies: their modes, tau, and kappa = omega^2 a (n_x,)."""

    mode: Index
    tau: Array
    kappa: Array


def _chains(bodies: list[ModalBody]) -> Chains:
    modes, tau, kappa, first = [np.empty(0)], [np.empty(0)], [np.empty(0)], 0
    for body in bodies:
        modes.append(np.tile(first + np.arange(body.m), len(body.tau)))
        tau.append(np.repeat(body.tau, body.m))
        kappa.append((body.stiffness * body.amplitude).ravel())
        first += body.m
    return Chains(
        np.concatenate(modes).astype(np.int64), np.concatenate(tau), np.concatenate(kappa)
    )


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


def _joined(arrays: list[Any]) -> Any:
    return np.concatenate([np.empty(0), *arrays])


@dataclass(frozen=True, eq=False)
class LinearModes:
    """Modes of a linear model, in the order of their frequencies. See `linearize` for an example.

    Parameters
    ----------
    values : (n,) complex [rad/s]
        Eigenvalues, one of each complex pair, and real ones. Those of motions that nothing resists
        are 0, once for each.
    y : (n_y, n) complex
        Rigid coordinates and modes of the bodies.
    lam : (n_i, n) complex
        Multipliers.
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
    def unstable(self) -> NDArray[np.bool_]:
        """True of modes that grow (n,)."""
        growing: NDArray[np.bool_] = self.values.real > MIN_GROWTH * np.abs(self.values)
        return growing


def modes_of(form: FirstOrder, n: int | None) -> LinearModes:
    """The first n modes, or all; `ModelError` where all are too many.

    form: without chains of materials.
    """
    space = _subspace(form, n)
    values = space.values
    chosen = np.flatnonzero((values.imag >= 0.0) & space.found & ~space.free)
    chosen = chosen[np.lexsort((values[chosen].real, np.abs(values[chosen])))][:n]
    still = _motions_without_resistance(form, space)
    values, x = values[chosen], space.states(chosen)
    states = form.solve(*form.split(x * (values - form.sigma)))
    found = LinearModes(
        np.concatenate([np.zeros(still.shape[1]), values]),
        np.hstack([still, states.y]),
        np.hstack([np.zeros((len(states.lam), still.shape[1])), states.lam]),
    )
    if n is None or n >= len(found):
        return found
    return LinearModes(found.values[:n], found.y[:, :n], found.lam[:, :n])


def _subspace(form: FirstOrder, n: int | None) -> Subspace:
    """The subspace in which the first n modes are, or all."""
    if n is not None:
        # bodies that are alike have modes that coincide, in two planes each
        alike = max(MIN_BLOCK, 2 * len(form.bodies))
        most = form.n if form.n > MAX_DENSE_STATES else form.n // 2 if form.n > QUICK_STATES else 0
        found = slowest(form.apply, form.n, form.sigma, n, most, alike)
        if found is not None:
            return found
    if form.n > MAX_DENSE_STATES:
        raise ModelError(
            f"{form.n} states: expected at most {MAX_DENSE_STATES} to find all modes: request "
            "fewer modes"
        )
    return Subspace(form.sigma, None, form.matrix)


def _motions_without_resistance(form: FirstOrder, space: Subspace) -> Array:
    """Real motions y (n_y, k) that nothing resists.

    A free motion has two zero eigenvalues, for position and velocity, with one eigenvector between
    them, which no eigenvalue solver tells well; the invariant subspace of all of them is certain.
    """
    from scipy.linalg import schur

    def is_zero(real: float, imaginary: float) -> bool:
        return form.is_zero(form.sigma + 1.0 / complex(real, imaginary))

    if not space.free.any():
        return np.zeros((len(form.basis), 0))
    _, U, p = schur(space.matrix, sort=is_zero)
    directions, size, _ = np.linalg.svd(space.lifted(U[:, :p])[: form.n_free], full_matrices=False)
    still: Array = form.basis @ directions[:, size > 1e-3]
    return still


def frames_of(form: FirstOrder, y: Any) -> Any:
    """Elastic displacements of all dofs (n_u, k) of motions y."""
    n_r, phi = form.equations.sizes.n_r, diagonal_blocks([b.phi for b in form.bodies])
    return form.equations.bends @ phi @ y[n_r:]


def with_chains(equations: Equations, found: LinearModes) -> LinearModes:
    """Modes of bodies whose materials have chains, from those without.

    By inverse iteration at a complex shift that follows the eigenvalue, from each of them: so the
    many motions of the chains alone, which only decay, are left out.
    """
    form = FirstOrder(equations)
    values, y, lam = found.values.copy(), found.y.copy(), found.lam.copy()
    for k in np.flatnonzero(values != 0.0).tolist():
        values[k], states = _followed(form, complex(values[k]), y[:, k : k + 1])
        y[:, k], lam[:, k] = states.y[:, 0], states.lam[:, 0]
    order = np.lexsort((values.real, np.abs(values)))
    return LinearModes(values[order], y[:, order], lam[:, order])


def _followed(form: FirstOrder, s: complex, y: Complex) -> tuple[complex, "States"]:
    """The eigenvalue that inverse iteration leads to, and its motion."""
    n_r, chains = form.equations.sizes.n_r, form.chains
    e = np.zeros((form.n_e, 1), dtype=np.complex128)
    n_x = len(chains.mode)
    e[form.n_e - n_x :] = y[n_r + chains.mode] / (1.0 + s * chains.tau)[:, None]
    states = States(y, s * y, e, np.zeros((form.equations.sizes.n_i, 1)))
    for _ in range(MAX_FOLLOWING):
        s = _beside_poles(form, s)
        a = form.coordinates @ states.y
        moved = form.at(s).solve(states.y, states.v, states.e)
        factor = complex(np.vdot(a, form.coordinates @ moved.y) / np.vdot(a, a))
        if not np.isfinite(factor) or factor == 0.0:
            break
        s += 1.0 / factor
        parts = (moved.y, moved.v, moved.e, moved.lam)
        states = States(*(part / factor for part in parts))
        if abs(1.0 / factor) <= EIGENVALUE_TOLERANCE * abs(s):
            break
    return s, states


def _beside_poles(form: FirstOrder, s: complex) -> complex:
    """s, or just beside it where it is an eigenvalue of a body alone, whose response is infinite.

    So it is for the modes of bodies that nothing holds.
    """
    nearest = np.abs(form.step(s)).min(initial=np.inf)
    return s * (1.0 + POLE_DISTANCE) if nearest < POLE_DISTANCE * abs(s) ** 2 else s
