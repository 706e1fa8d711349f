"""Maxwell elements that make a constant loss factor."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ..files.arrays import Array

MAX_LOSS_RIPPLE = 0.02  # deviation of the loss factor within the band, relative to it
MAX_ELEMENTS = 30  # no band needs them whose materials are known
PER_DECADE = 60  # frequencies of the fit
BAND_OVERHANGS = np.linspace(-1.0, 2.0, 31)
"""By which the first and the last relaxation time may lie beyond the ends of the band, as powers of
e.
"""


@dataclass(frozen=True, eq=False)
class Fit:
    """Relaxation times tau (K,) [s], amplitudes (K,) and the largest relative error of the loss."""

    tau: Array
    amplitude: Array
    ripple: float


@lru_cache(maxsize=64)
def fit(loss_factor: float, band: tuple[float, float]) -> Fit | None:
    """The fewest elements of a loss factor constant over a band [Hz] to `MAX_LOSS_RIPPLE`, or None.

        c(w) = 1 + sum_k a_k X_k,   X_k = i w tau_k / (1 + i w tau_k)
        Im c = loss_factor Re c:    sum_k a_k (Im X_k - loss_factor Re X_k) = loss_factor,  a_k >= 0

    at frequencies that are equally spaced by their logarithm, by least squares; times are spaced so
    as well. Source: C. L. Lawson, R. J. Hanson, Solving Least Squares Problems (1974), ch. 23.
    """
    for n in range(1, MAX_ELEMENTS + 1):
        fits = [fitted(loss_factor, band, _times(band, n, overhang)) for overhang in BAND_OVERHANGS]
        best = min(fits, key=lambda found: found.ripple)
        if best.ripple <= MAX_LOSS_RIPPLE:
            return best
    return None


def fitted(loss_factor: float, band: tuple[float, float], tau: Array) -> Fit:
    """The amplitudes of elements of given relaxation times."""
    # Runs read superelements, and need no scipy for that.
    from scipy.optimize import nnls

    decades = np.log10(band[1] / band[0])
    # Dense enough that no ripple of the loss hides between two frequencies.
    omega = 2.0 * np.pi * np.geomspace(*band, int(PER_DECADE * (1.0 + decades)))
    x = 1j * np.multiply.outer(omega, tau)
    X = x / (1.0 + x)
    amplitude, _ = nnls(X.imag - loss_factor * X.real, np.full(len(omega), loss_factor))
    c = 1.0 + X @ amplitude
    ripple = np.abs(c.imag / (loss_factor * c.real) - 1.0).max()
    return Fit(tau, amplitude, float(ripple))


def stiffening(tau: Array, amplitude: Array, reference: float) -> float:
    """Re c at a frequency [Hz]: the modulus there over that of the relaxed material."""
    x = 2j * np.pi * reference * tau
    return float((1.0 + (x / (1.0 + x)) @ amplitude).real)


def _times(band: tuple[float, float], n: int, overhang: float) -> Array:
    """n times from the upper end of a band to the lower one, and so far beyond both."""
    low, high = (1.0 / (2.0 * np.pi * frequency) for frequency in band[::-1])
    first, last = low * np.exp(-overhang), high * np.exp(overhang)
    # One element sits in the middle; times must differ, or the fit is singular.
    if n == 1 or first >= last:
        first, last = np.sqrt(low * high) * np.array([1.0, 1.0 + 1e-3 * n])
    return np.asarray(np.geomspace(first, last, n))
