"""Measured responses of a free part, the coordinates behind them, and modes that explain them.

    H(s) = R_o (U M^-1 U^T + sum_i h(s; omega_i, zeta_i) psi_i psi_i^T + Q(s)) R_i^T
    Q(s) = sum_r h(s; omega_r, zeta_r) L_r L_r^T,      h = s^2 / (s^2 + 2 zeta omega s + omega^2)

Accelerances (k, n_o, n_i) at s = 2 pi i f + sigma, sigma the rate of an exponential window. One
shape serves sensors and hits, so all of it is reciprocal; sums of squares with zeta >= 0 are
passive. Source: docs/theory.md, Frequency response tests.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...files.arrays import Array, Complex

REST_DAMPING = 0.02
"""damping ratio of the modes that stand for all beyond the band"""


@dataclass(frozen=True, eq=False)
class Measurement:
    """Responses of a free part whose rigid-body properties are known.

    s (k,) [1/s]; H (k, n_o, n_i) [1/kg]; outputs (n_o, q) and inputs (n_i, q): sensors and hits as
    motions and loads of the coordinates; rigid (q, 6): rigid motions of these about the center of
    mass; M (6, 6): mass and inertia about it.
    """

    s: Complex
    H: Complex
    outputs: Array
    inputs: Array
    rigid: Array
    M: Array

    @cached_property
    def weights(self) -> Array:
        """1 over the root mean square of a line (k,): peaks and antiresonances count alike."""
        return np.asarray(1.0 / np.sqrt(np.mean(np.abs(self.H) ** 2, axis=(1, 2))))

    @cached_property
    def elastic(self) -> Complex:
        """H without the rigid motion, which is given and the same at all frequencies."""
        rigid = self.outputs @ self.rigid @ np.linalg.solve(self.M, (self.inputs @ self.rigid).T)
        return np.asarray(self.H - rigid)

    @property
    def highest(self) -> float:
        """The highest circular frequency [rad/s]."""
        return float(self.s.imag.max())


@dataclass(frozen=True, eq=False)
class ModalFit:
    """Modes of a part and what stands for those beyond the band.

    omega (m,), zeta (m,), shapes (q, m) [1/sqrt(kg)]; rest: shapes (q, n_r) at each of rest_omega.
    misfit: the weighted difference of the responses over the weighted responses.
    """

    omega: Array
    zeta: Array
    shapes: Array
    rest_omega: Array
    rest: tuple[Array, ...]
    misfit: float = np.inf

    @property
    def frequencies(self) -> Array:
        """(m,) [Hz]"""
        return self.omega / (2.0 * np.pi)

    def responses(self, measured: Measurement) -> Complex:
        """The elastic responses at the frequencies of a measurement."""
        h = np.hstack(
            [
                resonances(measured.s, self.omega, self.zeta),
                resonances(measured.s, self.rest_omega, REST_DAMPING),
            ]
        )
        groups = (*self.shapes.T[:, :, None], *self.rest)
        residues = np.array(
            [(measured.outputs @ L @ (measured.inputs @ L).T).ravel() for L in groups]
        )
        total = np.empty(measured.H.shape, dtype=complex)
        # Residues are real: two real products take half the time of a complex one.
        total.real = (h.real @ residues).reshape(total.shape)
        total.imag = (h.imag @ residues).reshape(total.shape)
        return total

    def misfits(self, measured: Measurement) -> Array:
        """Weighted errors (k, n_o, n_i), whose root of squares over those of H is the misfit."""
        error = np.abs(measured.elastic - self.responses(measured))
        return np.asarray(error * measured.weights[:, None, None])


def resonances(s: Complex, omega: Array, zeta: Array | float) -> Complex:
    """h (k, m) of modes."""
    square = s[:, None] ** 2
    return np.asarray(square / (square + 2.0 * zeta * omega * s[:, None] + omega**2))


def relative_size(errors: Array | Complex, measured: Measurement) -> float:
    """Of weighted errors (k, ...): their size over that of the weighted responses."""
    # By the choice of weights each line has the square of n_o n_i.
    return float(np.linalg.norm(errors) / np.sqrt(measured.H.size))
