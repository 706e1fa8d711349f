"""How far modes are from real shapes: the part of their residues that is out of phase.

    H = R_o U M^-1 U^T R_i^T + sum_i (s^2 A_i + s omega_i B_i) / den_i(s) + rest,
    den = s^2 + 2 zeta omega s + omega^2

in least squares of each response. A mode with a real shape has no B; damping that is not modal,
such as a dashpot at one place, turns shapes in the complex plane.
"""

from typing import NamedTuple

import numpy as np

from ...files.arrays import Array
from .responses import REST_DAMPING, Measurement, ModalFit, resonances

LARGEST_COLLINEARITY = 30.0
"""variance of B over that of a mode alone: above it modes overlap so much that errors of places
look like shapes out of phase"""
ABOVE_NOISE = 2.0
"""|B|^2 over what noise alone makes of it, below which it counts as none"""


class OutOfPhase(NamedTuple):
    """Of each mode: |B| / |A|, without what noise makes of it, and that.

    0 of modes that overlap too much to tell.
    """

    shares: Array
    noise: Array


def out_of_phase(measured: Measurement, fit: ModalFit) -> OutOfPhase:
    """The parts of the modes (m,) that are out of phase, the norms over all responses."""
    s, m = measured.s, len(fit.omega)
    in_phase = resonances(s, fit.omega, fit.zeta)
    functions = np.hstack([
        in_phase, in_phase * fit.omega / s[:, None], resonances(s, fit.rest_omega, REST_DAMPING)
    ])  # fmt: skip
    columns = functions * measured.weights[:, None]
    values = (measured.elastic * measured.weights[:, None, None]).reshape(len(s), -1)
    A, b = np.vstack([columns.real, columns.imag]), np.vstack([values.real, values.imag])
    found = np.linalg.lstsq(A, b, rcond=None)[0]
    # Of all responses together, by the error of each that is left.
    left = ((b - A @ found) ** 2).mean(axis=0).sum()
    gram = A.T @ A
    inverse = np.diag(np.linalg.pinv(gram))[m : 2 * m]
    variance = left * inverse
    told = inverse * np.diag(gram)[m : 2 * m] < LARGEST_COLLINEARITY
    squares = (found**2).sum(axis=1)
    real = np.maximum(squares[:m], 1e-300)
    above = told & (squares[m : 2 * m] > ABOVE_NOISE * variance)
    own = np.where(above, squares[m : 2 * m] - variance, 0.0)
    return OutOfPhase(np.sqrt(own / real), np.sqrt(variance / real))
