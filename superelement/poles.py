"""The motions that the impulse responses of modes are made of."""

import numpy as np

from ..files.arrays import Complex
from .chain import Chain
from .modes import Modes


def motions(modes: Modes) -> tuple[Complex, Complex]:
    """s (m, K + 2) [1/s] and r: the response of a mode to a unit impulse is sum r exp(s t).

        s^2 + 2 zeta omega s + omega^2 c(s) = 0,    r = 1 / d(s^2 + 2 zeta omega s + omega^2 c)/ds

    by the eigenvalues of eta, eta' / omega and the K springs of a chain.
    """
    omega, zeta, chain = modes.omega, modes.zeta, modes.chain
    m, n = len(omega), 0 if chain is None else len(chain.tau)
    A = np.zeros((m, n + 2, n + 2))
    # The state eta, eta' / omega has entries of one size, which keeps eigenvalues accurate.
    A[:, 0, 1], A[:, 1, 0], A[:, 1, 1] = omega, -omega, -2.0 * zeta * omega
    if chain is not None:
        A[:, 1, 2:] = -omega[:, None] * chain.amplitudes(m).T
        A[:, 2:, 1] = omega[:, None]
        A[:, range(2, n + 2), range(2, n + 2)] = -1.0 / chain.tau
    s: Complex = np.linalg.eigvals(A).astype(np.complex128)
    slope = 2.0 * s + (2.0 * zeta * omega)[:, None]
    if chain is not None:
        slope = slope + omega[:, None] ** 2 * _slope(chain, s)
    return s, 1.0 / slope


def _slope(chain: Chain, s: Complex) -> Complex:
    """dc/ds (m, k) at s (m, k): sum_k a_k tau_k / (1 + s tau_k)^2"""
    a, x = chain.amplitudes(len(s)), 1.0 + np.multiply.outer(chain.tau, s)
    slope: Complex = (a[:, :, None] * chain.tau[:, None, None] / x**2).sum(axis=0)
    return slope
