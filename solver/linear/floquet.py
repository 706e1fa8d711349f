"""Floquet multipliers: the stability of rotors that are not alike all round, on any bearings.

In axes that turn with the rotor x' = A(psi) x has the period of a turn, T = 2 pi / Omega. Over it
every motion is multiplied by the matrix Phi, and grows where an eigenvalue of it is beyond 1. A
step is exp(h A) with A at its middle, of second order in the change of A. With M = (A - sigma)^-1,
of which A itself would drown slow motions, exp(h A) = (N(-k)^-1 N(k))^(h / k) with

    N(k) = (1 + k sigma/2 + k^2 sigma^2/12) M^2 + (k/2 + k^2 sigma/6) M + k^2/12

Two numbers of steps remove the error of second order. Both have the same parts k, so that they
agree for a constant A, whatever its modes: extrapolation of motions that differ in their phase
alone would make them grow. M is a trigonometric sum between some angles. Source: docs/theory.md,
Rotors.
"""

from dataclasses import dataclass

import numpy as np

from ...files.blas import one_blas_thread
from ..arrays import Array
from ..errors import ModelError, about
from ..model.model import Model
from .blocks import diagonal_blocks
from .equations import Equations, equations_of
from .modes import MAX_DENSE_STATES, Complex, FirstOrder
from .pose import pose_of
from .rotors import prepared_rotor
from .steady import turned

# A turn in so many angles: of unequal bearings (twice a turn) eight orders remain.
SAMPLED_ANGLES = 32
# of the coarse steps of a turn, to which there are twice as many fine ones
MIN_STEPS, MAX_STEPS = 256, 2**14
# of omega h of the fastest mode: at pi the jumps of A between steps are in resonance with it
MAX_PHASE_OF_STEP = 0.5
# per turn in logarithms, beyond which jumps cannot make a mode grow
LASTING_DECAY = 10.0
PARTS_OF_FINE_STEP = 4
# relative, of the last order of the sum over angles
NEGLIGIBLE_ORDER = 1e-7
# relative, of the basis that the constraints leave, by a turn
SAME_BASIS = 1e-8


@dataclass(frozen=True, eq=False)
class Floquet:
    """Multipliers of a rotor over a turn; see `floquet` for an example.

    Parameters
    ----------
    spin : float [rad/s]
    multipliers : (n,) complex
        From the largest on.
    """

    spin: float
    multipliers: Complex

    @property
    def growth(self) -> Array:
        """Rates (n,) [1/s] at which motions grow, log |multiplier| Omega / (2 pi)."""
        size = np.maximum(np.abs(self.multipliers), 1e-300)
        rates: Array = np.log(size) * self.spin / (2.0 * np.pi)
        return rates


def floquet(model: Model, spin: float) -> Floquet:
    """The Floquet multipliers of a rotor on bearings, which need not be alike all round its axis.

    Motions that nothing resists, as the turning itself, have multipliers of 1.

    Parameters
    ----------
    model : Model
    spin : float [rad/s]
        Above zero, about the axis of the steady rotation, or that of the first bearing.

    Returns
    -------
    Floquet

    Raises
    ------
    ModelError
        For a rotor without a steady rotation at all angles, such as one whose center is off the
        axis, shafts whose speeds are no multiples of the spin, a spin beyond the table of a
        bearing, and undamped modes that are thousands of times faster than the spin.

    Examples
    --------
    A disk that is stiffer to tilt about one of its axes grows at some speeds, and here does not:

    >>> from duhamel.solver import Bearing, Frame, Model, RigidBody
    >>> disk = RigidBody(10.0, [0.1, 0.13, 0.2], {"a": [0.0, 0.0, -0.2], "b": [0.0, 0.0, 0.2]})
    >>> ends = {"a": Frame((0.0, 0.0, -0.2)), "b": Frame((0.0, 0.0, 0.2))}
    >>> films = [Bearing(k, [f"ground.{k}", f"disk.{k}"], [0.0, 0.0, 1.0], [1e5, 2e5], 50.0)
    ...          for k in ends]
    >>> found = floquet(Model({"disk": disk}, bearings=films, ground_frames=ends), 300.0)
    >>> bool((found.growth < 1e-6).all())
    True
    """
    with about(model.path), one_blas_thread():
        model, rotation = prepared_rotor(model, spin)
        for name, ratio in rotation.speed_ratios.items():
            if ratio != round(ratio):
                raise ModelError(
                    f"rotor: body {name!r} turns {ratio:g} times as fast as the rotor: expected "
                    "whole numbers, with which a turn brings everything back"
                )
        orders = _orders(equations_of(pose_of(model, rotation)))
        n = _number_of_steps(orders, spin)
        coarse = _over_a_turn(orders, spin, n, 2 * PARTS_OF_FINE_STEP)
        fine = _over_a_turn(orders, spin, 2 * n, PARTS_OF_FINE_STEP)
        multipliers = np.linalg.eigvals((4.0 * fine - coarse) / 3.0).astype(np.complex128)
    return Floquet(spin, multipliers[np.argsort(-np.abs(multipliers))])


@dataclass(frozen=True, eq=False)
class _Orders:
    """M(psi) = sum_k values[k] exp(i k psi), k = 0 ... n; and sigma."""

    values: Complex
    sigma: float

    def at(self, psi: float) -> Array:
        phases = np.exp(1j * np.arange(len(self.values)) * psi)
        phases[1:] *= 2.0
        matrix: Array = np.tensordot(phases, self.values, 1).real
        return matrix


def _orders(equations: Equations) -> _Orders:
    """(A - sigma)^-1 over the angle of the rotor."""
    if equations.is_chained:
        raise ModelError("a material has a chain of Maxwell elements, which turns do not support")
    first = FirstOrder(equations)
    if first.n > MAX_DENSE_STATES:
        raise ModelError(f"{first.n} states: expected at most {MAX_DENSE_STATES} for turns")
    samples = []
    for angle in (2.0 * np.pi / SAMPLED_ANGLES * np.arange(SAMPLED_ANGLES)).tolist():
        with turned(equations, angle) as other:
            if other is None:
                raise ModelError(
                    f"rotor at {equations.pose.speed:.6g} rad/s: forces change with its angle: "
                    "expected a rotor that is balanced about its axis"
                )
            samples.append(_in_basis(FirstOrder(other).at(first.sigma), first))
    values = np.fft.rfft(np.array(samples), axis=0) / SAMPLED_ANGLES
    last = float(np.abs(values[-1]).max())
    if last > NEGLIGIBLE_ORDER * float(np.abs(values[0]).max()):
        raise ModelError(
            f"rotor at {equations.pose.speed:.6g} rad/s: its equations change too fast with its "
            "angle: expected bearings that are less unequal"
        )
    return _Orders(values[:-1], first.sigma)


def _in_basis(form: FirstOrder, first: FirstOrder) -> Array:
    """(A - sigma)^-1 in the basis of another form, of the same free motions."""
    change = first.coordinates @ form.basis
    if np.abs(change.T @ change - np.eye(form.n_free)).max(initial=0.0) > SAME_BASIS:
        raise ModelError("rotor: a joint frees other motions as the angle goes on")
    whole = np.asarray(diagonal_blocks([change, change, np.eye(form.n_e)]))
    matrix: Array = whole @ form.matrix @ whole.T
    return matrix


def _number_of_steps(orders: _Orders, spin: float) -> int:
    """Coarse steps of a turn that resolve all modes that last for one; ModelError for too many."""
    turn = 2.0 * np.pi / spin
    inverse = np.linalg.eigvals(orders.at(0.0))
    # What constraints leave no motion has no eigenvalue but at infinity.
    values = orders.sigma + 1.0 / inverse[np.abs(inverse) > 0.0]
    lasting = np.abs(values[-values.real * turn < LASTING_DECAY].imag)
    fastest = float(lasting.max(initial=0.0))
    n = int(np.ceil(fastest * turn / MAX_PHASE_OF_STEP))
    if n > MAX_STEPS:
        least = 2.0 * np.pi * fastest / (MAX_PHASE_OF_STEP * MAX_STEPS)
        raise ModelError(
            f"rotor at {spin:.6g} rad/s: a mode at {fastest:.6g} rad/s is hardly damped and needs "
            f"{n} steps in a turn: expected at most {MAX_STEPS}, as from {least:.6g} rad/s on, or "
            "damping"
        )
    return max(n, MIN_STEPS)


def _over_a_turn(orders: _Orders, spin: float, n: int, parts: int) -> Array:
    """What a turn in n steps of some parts makes of all states (n_x, n_x)."""
    part, s = 2.0 * np.pi / (spin * n * parts), orders.sigma
    x: Array = np.eye(orders.values.shape[1])
    for k in range(n):
        M = orders.at(2.0 * np.pi * (k + 0.5) / n)
        square = M @ M
        ahead, behind = (
            (1.0 + t * s / 2.0 + (t * s) ** 2 / 12.0) * square
            + (t / 2.0 + t * t * s / 6.0) * M
            + t * t / 12.0 * np.eye(len(M))
            for t in (part, -part)
        )
        step = np.linalg.solve(behind, ahead)
        x = np.asarray(np.linalg.matrix_power(step, parts) @ x, dtype=np.float64)
    return x
