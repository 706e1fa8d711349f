"""The damping of an assembled model about its start: what that of its parts amounts to.

    A(s) v = 0,   A(s) = s^2 + s (C + D^T S' D) + K + diag(0, omega_j^2 (c_j(s) - 1)) + D^T r(s) D

in the unknowns of frequencies.py: C the damping of modes, S' that of dampers, c the Maxwell
elements of materials, r those of springs, k_i s tau_i / (1 + s tau_i), and the integrals of motors,
gain / s.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Index
from ..checkpoint.carried import Snapshot, carried
from ..laws.law import LAW_KINDS
from ..laws.maxwell import MaxwellLaw
from ..step.system import System
from .frequencies import (
    Vibrations,
    null_space,
    spring_slopes,
    unknowns_of,
    vibrations,
    without_surfaces,
)
from .initial import InitialState

Complex = NDArray[np.complex128]

MAX_DAMPED_MOTIONS = 6
# A run reports its damping up to here, where that takes a fraction of a second.
MAX_QUICK_UNKNOWNS = 600
MAX_POLE_ITERATIONS = 20
CONVERGED, ROUNDED = 1e-13, 1e-6
"""Changes, relative to s, that end the iteration: at once, and where they no longer shrink."""
# Undamped poles have real parts of rounding.
NEGLIGIBLE_RATIO = 1e-12


class DampedMotion(NamedTuple):
    """A vibration exp(s t): frequency Im s / 2 pi [Hz], damping ratio -Re s / |s|."""

    frequency: float
    ratio: float


def damping_in_words(motions: Sequence[DampedMotion]) -> str:
    """Frequencies and ratios; a ratio of rounding is 0."""
    return ", ".join(
        f"{m.frequency:.5g} Hz {100.0 * m.ratio if abs(m.ratio) > NEGLIGIBLE_RATIO else 0:.3g} %"
        for m in motions
    )


def damping_of(initial: InitialState) -> str:
    """The damping of a model in words; "" without damping, or where that would take long.

    The state stays as it is.
    """
    system, state, work = initial.lowered.system, initial.state, initial.work
    n = unknowns_of(system)
    if n is None or n > MAX_QUICK_UNKNOWNS or not _is_damped(system):
        return ""
    if initial.lowered.model.surface_contacts:
        return damping_of(without_surfaces(initial))
    live = carried(state=state, work=work)
    # Springs are evaluated at other deformations here; the run must start as if nobody had asked.
    before = Snapshot.of(0, live)
    found = vibrations(initial, MAX_QUICK_UNKNOWNS)
    motions = [] if found is None else damped_motions(initial, found)
    before.put_back(live)
    return damping_in_words(motions)


def damped_motions(initial: InitialState, found: Vibrations) -> list[DampedMotion]:
    """The first vibrations with their damping, in the order of the undamped ones; none where
    nothing damps.

    Those that are overdamped are left out. By inverse iteration on A(s). Source: K. Rothe, H. Voss,
    Numerische Mathematik 56 (1989); A. Ruhe, SIAM Journal on Numerical Analysis 10 (1973) 674-689.
    """
    if not _is_damped(initial.lowered.system):
        return []
    problem = _Problem(initial, found)
    poles = [problem.solve(j) for j in range(min(MAX_DAMPED_MOTIONS, len(problem.omega)))]
    motions = [
        DampedMotion(s.imag / (2.0 * np.pi), -s.real / abs(s))
        for s in poles
        if s is not None and s.imag > ROUNDED * abs(s)
    ]
    return motions if any(abs(motion.ratio) > NEGLIGIBLE_RATIO for motion in motions) else []


def _is_damped(system: System) -> bool:
    modes, laws = system.elastic.modes, system.couplings.laws
    motors = bool(laws.motors.damping.any() or laws.motors.integral.any())
    modal = bool(modes.damped or len(modes.chains.body))
    return modal or motors or bool(laws.damping.any() or len(laws.number))


def _relaxing(system: System) -> Array:
    """Row, stiffness and relaxation time (n, 3) of each Maxwell element of force laws."""
    laws, found = system.couplings.laws, [np.zeros((0, 3))]
    for m, i in enumerate(np.repeat(np.arange(len(laws.rest)), np.diff(laws.range)).tolist()):
        if LAW_KINDS[laws.number[m]] is MaxwellLaw:
            # Parameters of a Maxwell law: all times, then all stiffnesses.
            tau, kappa = np.split(laws.parameters[laws.first[m] : laws.first[m + 1]], 2)
            found.append(np.column_stack([np.full(len(tau), i), kappa, tau]))
    return np.concatenate(found)


def _without_rigid_joints(B: Array, shapes: Array, m: int, hard: Index) -> tuple[Array, Array]:
    """The rows (n_rows, n) and shapes (n, r) in motions y that joints of rigid bodies leave free.

    Their kinetic energy stays y^T y / 2. Rows of these joints are then zeros.
    """
    n_y = B.shape[1] - m
    rigid = hard[~B[hard, n_y:].any(axis=1)]
    if not len(rigid):
        return B, shapes
    free = null_space(B[rigid, :n_y])
    rest = np.hstack([B[:, :n_y] @ free, B[:, n_y:]])
    rest[rigid] = 0.0
    return rest, np.vstack([free.T @ shapes[:n_y], shapes[n_y:]])


class _Problem:
    """A(s) and its derivative, as diagonal matrices and a few rows.

        A(s) z = D(s) z + B^T f,     f = Z(s) B z of laws,     B z = 0 of constraints

    D: of y and eta alone; f: forces of rows. So systems with A(s) are solved for f alone.
    """

    def __init__(self, initial: InitialState, found: Vibrations) -> None:
        system = initial.lowered.system
        modes = system.elastic.modes
        self.omega = found.omega
        hard = np.flatnonzero(system.couplings.compliant == 0)
        B, self._shapes = _without_rigid_joints(found.B, found.shapes, found.m, hard)
        self._rows = np.flatnonzero(B.any(axis=1))
        self._B = B[self._rows]
        self._hard = np.isin(self._rows, hard)
        self._rates = np.zeros(B.shape[1])
        self._rates[B.shape[1] - found.m :] = modes.damping
        self._stiffness, self._chains, self._range = modes.stiffness, modes.chains, modes.range
        self._step, own = system.scheme.h, np.ix_(self._rows, self._rows)
        self._S = spring_slopes(system, initial.state, initial.work)[own]
        self._dampers = spring_slopes(system, initial.state, initial.work, rates=True)[own]
        row, self._kappa, self._tau = _relaxing(system).T
        place = np.zeros(len(B), dtype=np.int64)
        place[self._rows] = np.arange(len(self._rows))
        self._relaxing = place[row.astype(np.int64)]
        motors = system.couplings.laws.motors
        self._motors, self._integral = place[motors.row], motors.integral

    def solve(self, j: int) -> complex | None:
        """s of the damped vibration that is nearest to undamped vibration j; None where none is."""
        # The undamped vibration is the start: damping moves its pole by about its ratio.
        s, shape = 1j * complex(self.omega[j]), self._shapes[:, j]
        v, previous = shape.astype(np.complex128), np.inf
        for _ in range(MAX_POLE_ITERATIONS):
            x = self._solution(s, v)
            if x is None:
                return s
            # Newton's method changes s by shape . v / shape . x, and v is scaled so that shape . v
            # = 1.
            along = complex(shape @ x)
            change, v = 1.0 / along, x / along
            s -= change
            # Quadratic convergence ends at rounding, where changes stay about equal.
            settled = ROUNDED * abs(s) >= previous <= abs(change)
            if abs(change) <= CONVERGED * abs(s) or settled:
                return s
            previous = abs(change)
        return None

    def _solution(self, s: complex, v: Complex) -> Complex | None:
        """A(s)^-1 A'(s) v; None where A(s) is singular, as it is at a solution."""
        D, D_slope = self._diagonals(s)
        Z, Z_slope = self._laws(s)
        if not D.all():
            return None
        right = D_slope * v + self._B.T @ (Z_slope @ (self._B @ v))
        weighed = self._B / D
        # In rows of constraints the equation is B x = 0, in those of laws f = Z B x: one matrix for
        # both.
        acting = Z + np.diag(self._hard)
        W = acting @ (weighed @ self._B.T) + np.diag(~self._hard)
        try:
            forces = np.linalg.solve(W, acting @ (weighed @ right))
        except np.linalg.LinAlgError:
            return None
        x: Complex = (right - self._B.T @ forces) / D
        return x

    def _diagonals(self, s: complex) -> tuple[Complex, Complex]:
        """D(s) and its derivative (n,)."""
        c, slope = self._materials(s)
        rates = self._rates.astype(np.complex128)
        D, derivative = s * s + s * rates, 2.0 * s + rates
        elastic = slice(len(D) - len(c), None)
        D[elastic] += self._stiffness * c
        derivative[elastic] += self._stiffness * slope
        return D, derivative

    def _laws(self, s: complex) -> tuple[Complex, Complex]:
        """Z(s) and its derivative: springs, dampers, those that relax, integrals of motors."""
        Z: Complex = self._S + s * self._dampers
        slope = self._dampers.astype(np.complex128)
        slack, i, m = 1.0 + s * self._tau, self._relaxing, self._motors
        np.add.at(Z, (i, i), self._kappa * s * self._tau / slack)
        np.add.at(slope, (i, i), self._kappa * self._tau / slack**2)
        np.add.at(Z, (m, m), self._integral / s)
        np.add.at(slope, (m, m), -self._integral / s**2)
        return Z, slope

    def _materials(self, s: complex) -> tuple[Complex, Complex]:
        """c(s) and its derivative (m,), of every mode."""
        c = np.ones(len(self._stiffness), dtype=np.complex128)
        slope = np.zeros_like(c)
        chains = self._chains
        for i, e in enumerate(chains.body.tolist()):
            own = slice(self._range[e], self._range[e + 1])
            m = own.stop - own.start
            tau = self._step / chains.lost[chains.element[i] : chains.element[i + 1]]
            first = chains.spring[i]
            # Stored by element, then by mode, as the time loop reads them.
            a = chains.amplitude[first : first + len(tau) * m].reshape(len(tau), m).T
            x = 1.0 + s * tau
            c[own] += a @ (s * tau / x)
            slope[own] += a @ (tau / x**2)
        return c, slope
