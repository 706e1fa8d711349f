"""The first resonance of a part, below which it moves as a rigid one.

Of lightly damped parts it is the first peak of the responses. Heavy damping makes that lower than
the responses of further modes; then it is where responses turn out of phase, and its frequency and
damping are those with which lines below fit best, in least squares of each response:

    H = A + B h(f; f_1, zeta) + C / f^2,      h = -f^2 / (f_1^2 - f^2 + 2 i zeta f_1 f)

C: of cords. Source of the elimination of A, B and C: G. Golub, V. Pereyra, SIAM J. Numer. Anal. 10
(1973) 413-432.
"""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import median_filter
from scipy.optimize import minimize

from ...files.arrays import Array, Complex

PART_OF_RESONANCE = 0.75
"""up to which lines are those of a rigid part and of little else"""
FIRST_PEAK = 4.0
"""root mean square of the responses over the least of lower lines, from which on there is a peak"""
FIRST_LINES = 5
"""lines of which the level is the median"""
OUT_OF_PHASE = 0.4
"""imaginary part of responses over their size: a mode has it at 0.75 to 1 of its resonance, for
damping ratios up to 0.5"""
DAMPED_BELOW = 0.8
"""line that is out of phase over that of the peak: nearer to it they are of one lightly damped
mode"""
BEYOND_CORDS = 1.5
"""of the highest resonance on cords, from which on a part is free of them"""
LEAST_OF_FIT = 5
"""lines, for three numbers of each response and two of all"""
START_OF_FIT, BOUNDS_OF_FIT = (1.2, 0.2), ((0.8, 2.0), (0.0, 1.5))
"""of f_1 over the line that is out of phase, and of zeta"""


@dataclass(frozen=True)
class FirstResonance:
    """f [Hz] and zeta of a mode, 0 where that is light; end [Hz] of the lines below it."""

    f: float
    zeta: float
    end: float

    def real_part(self, f: Array) -> Array:
        """-Re h (k,) at frequencies [Hz]."""
        return -_mode(f, self.f, self.zeta).real


def first_resonance(f: Array, H: Complex) -> FirstResonance | None:
    """That of accelerances (k, n_o, n_i) at f (k,) [Hz], None where there is none."""
    peak, turn = _peak(H), _turn(H)
    if turn is not None and (peak is None or f[turn] < DAMPED_BELOW * f[peak]):
        return _damped(f, H, float(f[turn]))
    if peak is None:
        return None
    return FirstResonance(float(f[peak]), 0.0, PART_OF_RESONANCE * float(f[peak]))


def _peak(H: Complex) -> int | None:
    """The line of the first peak."""
    level = np.sqrt(np.mean(np.abs(H) ** 2, axis=(1, 2)))
    # Over the least level so far: stiff cords raise the first lines, too.
    steady = median_filter(level, FIRST_LINES, mode="nearest")
    peaks = np.flatnonzero(level > FIRST_PEAK * np.minimum.accumulate(steady))
    if not len(peaks):
        return None
    # The peak itself: where the level has risen it still rises.
    first = int(peaks[0])
    while first + 1 < len(level) and level[first + 1] > level[first]:
        first += 1
    return first


def _turn(H: Complex) -> int | None:
    """The first line that is out of phase."""
    # Noise has no part in products of neighboring lines, low ones of sensors have much of it.
    imaginary = np.einsum("kab,kab->k", H.imag[1:], H.imag[:-1])
    whole = np.einsum("kab,kab->k", H[1:], H[:-1].conj()).real
    excess = median_filter(imaginary - OUT_OF_PHASE**2 * np.abs(whole), FIRST_LINES, mode="nearest")
    turned = np.flatnonzero(excess > 0.0)
    return int(turned[0]) if len(turned) else None


def _damped(f: Array, H: Complex, turn: float) -> FirstResonance:
    """The resonance of lines below one that is out of phase."""
    end = PART_OF_RESONANCE * turn
    lines = f < end
    if lines.sum() < LEAST_OF_FIT:
        return FirstResonance(turn, 0.0, end)
    values = H[lines].reshape(int(lines.sum()), -1)
    whole = np.vstack([values.real, values.imag])
    # All that the residual needs of many responses.
    gram = whole @ whole.T

    def residual(parameters: Array) -> float:
        h = _mode(f[lines], turn * parameters[0], parameters[1])
        functions = np.column_stack([np.ones_like(h), h, (f[0] / f[lines]) ** 2])
        Q, _ = np.linalg.qr(np.vstack([functions.real, functions.imag]))
        return float(np.trace(gram) - np.einsum("ka,kl,la->", Q, gram, Q))

    found = minimize(residual, START_OF_FIT, method="Nelder-Mead", bounds=BOUNDS_OF_FIT).x
    return FirstResonance(turn * float(found[0]), float(found[1]), end)


def _mode(f: Array, f_1: float, zeta: float) -> Complex:
    return np.asarray(-(f**2) / (f_1**2 - f**2 + 2j * zeta * f_1 * f))
