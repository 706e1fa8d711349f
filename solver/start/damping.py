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

from ..arrays import Array
from ..checkpoint.carried import Snapshot, carried
from ..laws.law import LAWS
from ..laws.maxwell import MaxwellLaw
from ..step.system import System
from .frequencies import Vibrations, spring_slopes, unknowns_of, vibrations
from .initial import InitialState

Complex = NDArray[np.complex128]

SHOWN = 6
KEPT = 300
"""Vibrations, the lowest, in which those that are damped are looked for."""
QUICK = 600
"""Unknowns up to which a run tells of its damping."""
ITERATIONS = 20
CONVERGED = 1e-13
NOTHING = 1e-12
"""A ratio that is rounding."""


class DampedMotion(NamedTuple):
    """A vibration exp(s t): frequency Im s / 2 pi [Hz], damping ratio -Re s / |s|."""

    frequency: float
    ratio: float


def damping_in_words(motions: Sequence[DampedMotion]) -> str:
    return ", ".join(f"{m.frequency:.5g} Hz {100.0 * m.ratio:.3g} %" for m in motions)


def damping_of(initial: InitialState) -> str:
    """Of a run, in words, as long as it takes no time; "" where nothing damps. The state stays."""
    system, state, work = initial.lowered.system, initial.state, initial.work
    n = unknowns_of(system)
    if n is None or n > QUICK or not _is_damped(system):
        return ""
    live = carried(state=state, work=work)
    before = Snapshot.of(0, live)
    found = vibrations(initial, QUICK)
    motions = [] if found is None else damped_motions(initial, found)
    before.put_back(live)
    return damping_in_words(motions)


def damped_motions(initial: InitialState, found: Vibrations) -> list[DampedMotion]:
    """The first vibrations with their damping, in the order of the undamped ones; none where
    nothing damps.

    Those that are overdamped are left out. By inverse iteration on A(s), in the lowest `KEPT`
    undamped ones. Source: K. Rothe, H. Voss, Numerische Mathematik 56 (1989); A. Ruhe, SIAM Journal
    on Numerical Analysis 10 (1973) 674-689.
    """
    if not _is_damped(initial.lowered.system):
        return []
    problem = _Problem(initial, found)
    poles = [problem.solve(j) for j in range(min(SHOWN, len(problem.omega)))]
    motions = [
        DampedMotion(s.imag / (2.0 * np.pi), -s.real / abs(s))
        for s in poles
        if s is not None and s.imag > 0.0
    ]
    return motions if any(abs(motion.ratio) > NOTHING for motion in motions) else []


def _is_damped(system: System) -> bool:
    modes, laws = system.elastic.modes, system.couplings.laws
    motors = bool(laws.motors.damping.any() or laws.motors.integral.any())
    modal = bool(modes.damped or len(modes.chains.body))
    return modal or motors or bool(laws.damping.any() or len(laws.number))


def _relaxing(system: System) -> Array:
    """Row, stiffness and relaxation time (n, 3) of each Maxwell element of force laws."""
    laws, found = system.couplings.laws, [np.zeros((0, 3))]
    for m, i in enumerate(np.repeat(np.arange(len(laws.rest)), np.diff(laws.range)).tolist()):
        if LAWS[laws.number[m]] is MaxwellLaw:
            tau, kappa = np.split(laws.parameters[laws.first[m] : laws.first[m + 1]], 2)
            found.append(np.column_stack([np.full(len(tau), i), kappa, tau]))
    return np.concatenate(found)


class _Problem:
    """A(s) and its derivative, in the coordinates of the lowest undamped vibrations."""

    def __init__(self, initial: InitialState, found: Vibrations) -> None:
        system = initial.lowered.system
        self.omega = found.omega[:KEPT]
        shapes = found.shapes[:, :KEPT]
        self._eta = shapes[len(shapes) - found.m :]
        self._stiffness = system.elastic.modes.stiffness
        self._chains = system.elastic.modes.chains
        self._range = system.elastic.modes.range
        self._step = system.scheme.h
        moved = found.B @ shapes
        dampers = spring_slopes(system, initial.state, initial.work, rates=True)
        self._C = (self._eta.T * system.elastic.modes.damping) @ self._eta
        self._C += moved.T @ dampers @ moved
        row, self._kappa, self._tau = _relaxing(system).T
        self._relaxing = moved[row.astype(np.int64)]
        motors = system.couplings.laws.motors
        self._integral = (moved[motors.row].T * motors.integral) @ moved[motors.row]

    def solve(self, j: int) -> complex | None:
        """s of the damped vibration that is nearest to undamped vibration j; None where none is."""
        s, v = 1j * complex(self.omega[j]), np.zeros(len(self.omega), dtype=np.complex128)
        v[j] = 1.0
        for _ in range(ITERATIONS):
            A, slope = self._matrices(s)
            try:
                x = np.linalg.solve(A, slope @ v)
            except np.linalg.LinAlgError:
                return s
            change = 1.0 / complex(x[j])
            s, v = s - change, x / x[j]
            if abs(change) <= CONVERGED * abs(s):
                return s
        return None

    def _matrices(self, s: complex) -> tuple[Complex, Complex]:
        c, slope = self._materials(s)
        diagonal = np.eye(len(self.omega))
        A = s * s * diagonal + s * self._C + np.diag(self.omega**2)
        A = A + (self._eta.T * (self._stiffness * (c - 1.0))) @ self._eta
        derivative = 2.0 * s * diagonal + self._C
        r, r_slope = self._branches(s)
        A, derivative = A + r, derivative + r_slope
        return A, derivative + (self._eta.T * (self._stiffness * slope)) @ self._eta

    def _branches(self, s: complex) -> tuple[Complex, Complex]:
        """D^T r(s) D of springs that relax and of the integrals of motors, and its derivative."""
        slack, gradient = 1.0 + s * self._tau, self._relaxing
        r = (gradient.T * (self._kappa * s * self._tau / slack)) @ gradient
        slope = (gradient.T * (self._kappa * self._tau / slack**2)) @ gradient
        return r + self._integral / s, slope - self._integral / s**2

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
            a = chains.amplitude[first : first + len(tau) * m].reshape(len(tau), m).T
            x = 1.0 + s * tau
            c[own] += a @ (s * tau / x)
            slope[own] += a @ (tau / x**2)
        return c, slope
