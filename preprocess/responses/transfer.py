"""Transfer functions: what kernels that are sampled from modes add up to, frequency by frequency."""

import numpy as np
from numpy.typing import NDArray

from ...superelement.kernel import spread
from ...superelement.modes import Modes
from ...superelement.scheme import GeneralizedAlpha

Complex = NDArray[np.complex128]


def transfer(modes: Modes, h: float, scheme: GeneralizedAlpha, delay: Complex) -> Complex:
    """G = sum_k g[k] d^k = phi diag(1 / (sigma + 2 zeta omega chi + omega^2)) phi^T, the
    z-transform with d = 1/z.

    delay (n,): |d| < 1, and 0 gives g[0] -> (n, n_c, n_c) [m/N ...]. sigma and chi:
    `GeneralizedAlpha.symbols`. Source: docs/theory.md, Impulse responses.
    """
    receptance = 1.0 / dynamic_stiffness(modes, h, scheme, delay)
    return spread(modes.phi, receptance.real) + 1j * spread(modes.phi, receptance.imag)


def dynamic_stiffness(modes: Modes, h: float, scheme: GeneralizedAlpha, delay: Complex) -> Complex:
    """sigma + 2 zeta omega chi + omega^2 of every mode: delay (n,) -> (n, m) [1/s^2]"""
    sigma, chi = scheme.symbols(h, delay)
    return sigma[:, None] + chi[:, None] * (2.0 * modes.zeta * modes.omega) + modes.omega**2
