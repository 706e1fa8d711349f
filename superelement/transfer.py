"""Transfer functions: z-transforms of kernels, in closed form from modes, and summed over lags."""

import numpy as np

from ..files.arrays import Complex as Complex
from .kernel import Kernel, spread
from .modes import Modes
from .scheme import GeneralizedAlpha


def transfer(modes: Modes, h: float, scheme: GeneralizedAlpha, delay: Complex) -> Complex:
    """G = sum_k g[k] d^k (n, n_c, n_c) [m/N ...]: the z-transform of the kernel, with d = 1/z.

    G = phi diag(1 / (sigma + 2 zeta omega chi + omega^2 c)) phi^T,  c: of a chain, else 1

    delay (n,): |d| < 1, and 0 gives g[0] -> (n, n_c, n_c) [m/N ...]. sigma and chi:
    `GeneralizedAlpha.symbols`. Source: docs/theory.md, Impulse responses.
    """
    return receptance(modes, dynamic_stiffness(modes, h, scheme, delay))


def receptance(modes: Modes, stiffness: Complex) -> Complex:
    """phi diag(1 / D) phi^T (n, n_c, n_c) for the dynamic stiffness D (n, m) of every mode."""
    inverse = 1.0 / stiffness
    return spread(modes.phi, inverse.real) + 1j * spread(modes.phi, inverse.imag)


def dynamic_stiffness(modes: Modes, h: float, scheme: GeneralizedAlpha, delay: Complex) -> Complex:
    """sigma + 2 zeta omega chi + omega^2 c of every mode: delay (n,) -> (n, m) [1/s^2]"""
    sigma, chi = scheme.symbols(h, delay)
    c = 1.0 if modes.chain is None else modes.chain.stepped(h, delay, len(modes.omega))
    return sigma[:, None] + chi[:, None] * (2.0 * modes.zeta * modes.omega) + modes.omega**2 * c


def laplace_stiffness(modes: Modes, s: Complex) -> Complex:
    """s^2 + 2 zeta omega s + omega^2 c(s) of every mode, without time steps: s (n,) -> (n, m)
    [1/s^2].
    """
    c = 1.0 if modes.chain is None else modes.chain.factor(s / 1j, len(modes.omega))
    return s[:, None] ** 2 + s[:, None] * (2.0 * modes.zeta * modes.omega) + modes.omega**2 * c


def summed(kernel: Kernel, delay: Complex) -> Complex:
    """The transfer function (n, n_c, n_c) of the lags that a kernel has, sum_k g[k] d^k.

    The sum ends with the last lag, so |d|^steps must be rounding. delay (n,): d.
    """
    powers = delay[:, None] ** np.arange(len(kernel.g))
    G: Complex = np.tensordot(powers, kernel.g, 1)
    return G
