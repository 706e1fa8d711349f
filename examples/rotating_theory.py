"""What theory says of beams that rotate, for the examples: by Ritz, without superelements.

Bending of a beam of Euler and Bernoulli that turns at spin [rad/s] about an axis `hub` before its
root, out of the plane of rotation (flap) and in it (lag):

    (EI w'')'' - spin^2 (T w')' + m w_tt  [- spin^2 m w: lag] = 0,    T = m int_x^L (hub + s) ds

Source: A. D. Wright et al., Vibration modes of centrifugally stiffened beams, Journal of Applied
Mechanics 49 (1982) 197-202.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import Legendre, Polynomial
from numpy.typing import NDArray
from scipy.linalg import eigh

Array = NDArray[np.float64]

SHAPES = 12
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(2 * SHAPES)
XI, WEIGHTS = 0.5 * (POINTS + 1.0), 0.5 * WEIGHTS


@dataclass(frozen=True)
class RotatingBeam:
    """length [m], EI [N m^2], mass per length [kg/m], hub [m]; hinged at its root, or clamped."""

    length: float
    EI: float
    mass: float
    hub: float = 0.0
    hinged: bool = False

    @cached_property
    def _shapes(self) -> list[Polynomial]:
        """Of x / length, which the root holds."""
        held = Polynomial([0.0, 1.0]) ** (1 if self.hinged else 2)
        return [
            held * Legendre.basis(k, domain=[0.0, 1.0]).convert(kind=Polynomial)
            for k in range(SHAPES)
        ]

    def _integral(self, order: int, coefficient: Array | float) -> Array:
        N = np.array([shape.deriv(order)(XI) for shape in self._shapes]) / self.length**order
        return (N * (WEIGHTS * self.length * coefficient)) @ N.T

    @cached_property
    def M(self) -> Array:
        """Mass (n, n) [kg]."""
        return self._integral(0, self.mass)

    @cached_property
    def K(self) -> Array:
        """Stiffness of bending (n, n) [N/m]."""
        return self._integral(2, self.EI)

    @cached_property
    def S(self) -> Array:
        """Stiffness by tension, over spin^2 (n, n) [kg]."""
        L = self.length
        return self._integral(
            1, self.mass * (self.hub * L * (1.0 - XI) + 0.5 * L**2 * (1.0 - XI**2))
        )

    @cached_property
    def tip(self) -> Array:
        """Of the shapes (n,) [1]."""
        return np.array([shape(1.0) for shape in self._shapes])

    def coning(self, spin: float, load: float) -> float:
        """The slope at the root [rad] that stays under a load per length [N/m] across the plane."""
        lift = np.array([shape(XI) for shape in self._shapes]) @ (load * self.length * WEIGHTS)
        slopes = np.array([shape.deriv()(0.0) for shape in self._shapes]) / self.length
        return float(slopes @ np.linalg.solve(self.K + spin**2 * self.S, lift))

    def flap(self, spin: float) -> Array:
        """Frequencies (n,) [rad/s], lowest first."""
        return np.sqrt(eigh(self.K + spin**2 * self.S, self.M, eigvals_only=True))

    def lag(self, spin: float) -> Array:
        """Frequencies (n,) [rad/s], lowest first."""
        return np.sqrt(self.flap(spin) ** 2 - spin**2)


def peak_frequency(signal: Array, step: float, near: float) -> float:
    """The frequency [rad/s] of the strongest peak of a free vibration (n,) within a quarter
    of `near`.
    """
    window = np.hanning(len(signal)) * (signal - signal.mean())
    time = step * np.arange(len(signal))
    spacing = 2.0 * np.pi / time[-1]
    low, high = near - max(0.25 * near, spacing), near + max(0.25 * near, spacing)
    for _ in range(4):
        tried = np.linspace(low, high, 41)
        best = tried[np.abs(np.exp(-1j * np.outer(tried, time)) @ window).argmax()]
        low, high = best - (high - low) / 10.0, best + (high - low) / 10.0
    return float(best)
