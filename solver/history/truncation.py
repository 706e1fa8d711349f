"""Truncated kernels: impulse responses of damped bodies, faded out before they are cut off."""

import numpy as np

from ...superelement.kernel import Kernel
from ...superelement.modes import Modes
from ...superelement.poles import motions
from ...superelement.validation import Array, SuperelementError

FADE_SHARE = 0.25
"""the part of a truncated kernel over which it fades out"""


def truncate(kernel: Kernel, lags: int, compliance: Array) -> Kernel:
    """The first `lags` lags of a kernel, faded out, with the static compliance kept.

        g'[k] = w_k g[k] + s_k (C - sum_j w_j g[j])
        w_k = 1 for k <= k_1, then (1 + cos(pi (k - k_1) / (lags - k_1))) / 2

    with k_1 at three quarters of the lags; s, a Hann window of sum 1, makes the sum of all g' the
    compliance C (n_c, n_c), so that slow loads meet the stiffness of the body. g_initial fades
    likewise. Raises `SuperelementError` unless 8 <= lags <= n_k. Source: D. J. Rixen, N. Haghighat,
    IMAC XXX (2012); docs/theory.md, History.
    """
    if not 8 <= lags <= len(kernel.g):
        raise SuperelementError(f"kernel: expected 8 to {len(kernel.g)} lags to keep, found {lags}")
    k = np.arange(lags)
    k_1 = int((1.0 - FADE_SHARE) * lags)
    window = np.where(k <= k_1, 1.0, 0.5 + 0.5 * np.cos(np.pi * (k - k_1) / (lags - k_1)))
    window = window[:, None, None]
    hann = 1.0 - np.cos(2.0 * np.pi * k / (lags - 1))
    g = window * kernel.g[:lags]
    g += (hann / hann.sum())[:, None, None] * (compliance - g.sum(axis=0))
    return Kernel(
        kernel.h, kernel.scheme, g, window * kernel.g_initial[:lags], kernel.error, kernel.band
    )


def truncation_error(
    kernel: Kernel, truncated: Kernel, modes: Modes | None, compliance: Array
) -> float:
    """Bound of the error of displacements, relative to static ones under the largest load.

        max_ij  sum_k |g_ij[k] - g'_ij[k]| / sqrt(C_ii C_jj)

    Lags that `kernel` does not have count by the decay of the modes, sum_m |phi_im phi_jm|
    exp(-zeta omega t) / (zeta omega^2), or, without modes, by that of the kernel's last two
    quarters. Infinite for what does not decay.
    """
    lags = len(truncated.g)
    difference = np.abs(kernel.g[:lags] - truncated.g).sum(axis=0) + np.abs(kernel.g[lags:]).sum(
        axis=0
    )
    if modes is None:
        difference += _extrapolated(kernel)
    else:
        decay = _decay(modes, kernel.length)
        difference += (np.abs(modes.phi) * decay) @ np.abs(modes.phi).T
    # load patterns that do not deform the body have neither compliance nor kernel
    scale = np.sqrt(np.maximum(np.diag(compliance), np.finfo(float).tiny))
    return float((difference / np.outer(scale, scale)).max())


def _decay(modes: Modes, t: float) -> Array:
    """Bound (m,) of the integral of the impulse response of every mode beyond t [s].

    exp(-zeta omega t) / (zeta omega^2), and with a chain sum |r| exp(Re s t) / |Re s| over all
    motions r exp(s t).
    """
    with np.errstate(divide="ignore"):
        if modes.chain is None:
            return np.exp(-modes.zeta * modes.omega * t) / (modes.zeta * modes.omega**2)
        s, residues = motions(modes)
        rates = np.abs(s.real)
        bound: Array = (np.abs(residues) * np.exp(-rates * t) / rates).sum(axis=1)
    return bound


def _extrapolated(kernel: Kernel) -> Array:
    """Sum of |g| beyond the end of a kernel, if it decays as from its third quarter to its last."""
    quarter = len(kernel.g) // 4
    third, last = (
        np.abs(kernel.g[start:][:quarter]).sum(axis=0) for start in (2 * quarter, 3 * quarter)
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(
            last == 0.0, 0.0, np.where(last < third, last * last / (third - last), np.inf)
        )
