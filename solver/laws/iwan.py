"""Bolted joints: micro-slip that grows to macro-slip, by Iwan's law as Segalman has it."""

from collections.abc import Sequence
from typing import Annotated

import numpy as np

from ..arrays import Array
from ..compiler.marks import compiled
from ..schema.values import NotNegative, Positive, number
from .law import Evaluation, ForceLaw, force_law

SMALLEST_SLIP = 1e-4
"""deformation at which the first element slips, over that of macro-slip"""

# Nearer to -1 nearly all elements slip at once, and the ranges of floats end.
Chi = Annotated[float, number("a number from -0.99 to 10", float, lambda chi: -0.99 <= chi <= 10.0)]
Elements = Annotated[int, number("a number from 2 to 1000", int, lambda n: 2 <= n <= 1000)]


@force_law("slip_force")
class IwanLaw(ForceLaw):
    """A bolted joint or lap joint: many springs in parallel, each behind a slider of dry friction.

        f = integral of rho(phi) e(phi),    |e| <= phi,    e' = c' while it does not slip
        rho = R phi^chi for phi < phi_max, and S delta(phi - phi_max)

    Segalman's four parameters determine R, S and phi_max: the joint begins with `stiffness` and
    slips as a whole at `slip_force`. Unloading and reloading obey Masing's rule. A cycle of the
    amplitude u < phi_max dissipates 4 R u^(chi + 3) / ((chi + 2) (chi + 3)). The distribution is
    divided into elements; amplitudes below 1e-4 phi_max dissipate nothing. The elements store
    their elastic energy. Permanent is c - f / stiffness, the mean position of the sliders weighted
    by stiffness: where the force would vanish if none slipped back.

    Parameters
    ----------
    slip_force : float [N, N m]
        The largest force, of macro-slip.
    stiffness : float [N/m, N m/rad]
        That of small deformations.
    chi : float
        The loss per cycle grows with the amplitude to the power chi + 3: -0.99 or more; measured
        joints have -0.8 to 0.
    beta : float
        S over the integral of R phi^chi: 0 (macro-slip begins smoothly) or more (with a corner).
    elements : int
        The error is of second order in their number.

    Examples
    --------
    >>> law = IwanLaw(slip_force=4e3, stiffness=1.5e7, chi=-0.3, beta=0.6)
    >>> round(law.macro_slip, 6)
    0.000422

    References
    ----------
    W. D. Iwan, J. Appl. Mech. 33 (1966); D. J. Segalman, J. Appl. Mech. 72 (2005), 752-760.
    """

    slip_force: Positive
    stiffness: Positive
    chi: Chi = -0.5
    beta: NotNegative = 0.0
    elements: Elements = 60

    @property
    def macro_slip(self) -> float:
        """phi_max [m, rad], the deformation of the virgin joint at which all of it slips."""
        chi, beta = self.chi, self.beta
        mean = (beta + (chi + 1.0) / (chi + 2.0)) / (1.0 + beta)
        return self.slip_force / (self.stiffness * mean)

    def parameters(self) -> Sequence[float]:
        """Deformations at which the elements slip, then their stiffnesses."""
        # Two moments of the distribution are those of each strip, so that initial stiffness and
        # slip force are exact with any number of elements.
        last, n = self.macro_slip, self.chi + 1.0
        edges = np.append(0.0, last * np.geomspace(SMALLEST_SLIP, 1.0, self.elements))
        # In shares of phi_max, since its powers overflow for large chi.
        share = np.diff((edges / last) ** n)
        stiffness = self.stiffness / (1.0 + self.beta) * share
        slips = last * n / (n + 1.0) * np.diff((edges / last) ** (n + 1.0)) / share
        corner = self.stiffness * self.beta / (1.0 + self.beta)
        return [*slips, last, *stiffness, corner]

    def memories(self) -> Sequence[float]:
        """Where the slider of each element is."""
        return [0.0] * (self.elements + 1)

    @staticmethod
    def evaluate(parameters: Array, memory: Array, h: float, c: float, rate: float) -> Evaluation:
        n = len(memory)
        force, slope, energy = 0.0, 0.0, 0.0
        for m in range(n):
            k, e = parameters[n + m], elongation(parameters[m], c - memory[m])
            force += k * e
            # A slider that moves carries its limit, whatever the deformation.
            energy += 0.5 * k * e * e
            if abs(e) < parameters[m]:
                slope += k
        return force, slope, 0.0, energy

    @staticmethod
    def remember(parameters: Array, memory: Array, h: float, c: float, rate: float) -> None:
        for m in range(len(memory)):
            e = elongation(parameters[m], c - memory[m])
            # A slider that sticks stays to the bit.
            if abs(e) >= parameters[m]:
                memory[m] = c - e

    @staticmethod
    def permanent(parameters: Array, memory: Array, c: float) -> float:
        n = len(memory)
        moved, stiffness = 0.0, 0.0
        for m in range(n):
            moved += parameters[n + m] * memory[m]
            stiffness += parameters[n + m]
        return moved / stiffness


@compiled
def elongation(limit: float, e: float) -> float:
    """The elongation of an element whose slider yields at a limit."""
    return min(max(e, -limit), limit)
