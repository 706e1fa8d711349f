"""Whether responses are of the quantity that they are said to be.

Below the first resonance accelerances of a free part are real and even, those taken for what they
are not go as a power of s:

    H = A (2 pi i f)^n,      n = 0 where they are what they are said to be
"""

from pathlib import Path

import numpy as np

from ..errors import MeasurementError
from .frequency_data import OVER_TIME, POWERS_OF_S, FrequencyData

COMPARED_RANGE = 2.0
"""of the highest line compared over the lowest"""
LEAST_COMPARED = 5
"""lines"""
SLOPE_ERROR, CURVATURE = 0.25, 0.05
"""of n, and of what is left of the logarithm of the level: resonances nearby have more"""
LEAST_TURNED = 0.8
"""imaginary part, squared, of odd powers; of even ones at most the rest"""


def require_quantity(path: Path, data: FrequencyData) -> None:
    """`MeasurementError` where the lowest lines are plainly those of another quantity."""
    moving = data.lines(np.flatnonzero((data.f > 0.0) & data.H.any(axis=(1, 2))))
    lowest = moving.lines(np.flatnonzero(moving.f <= COMPARED_RANGE * moving.f[:1]))
    if len(lowest.f) < LEAST_COMPARED:
        return
    level = np.log(np.linalg.norm(lowest.H, axis=(1, 2)))
    fit = np.polynomial.Polynomial.fit(np.log(lowest.f), level, 1)
    slope = float(fit.convert().coef[1])
    n = round(slope)
    left = float(np.std(level - fit(np.log(lowest.f))))
    # Noise has no part in products of neighboring lines.
    turned = float(np.sum(lowest.H.imag[1:] * lowest.H.imag[:-1]))
    whole = abs(float(np.sum(lowest.H[1:] * lowest.H[:-1].conj()).real))
    agrees = turned > LEAST_TURNED * whole if n % 2 else turned < (1.0 - LEAST_TURNED) * whole
    if abs(slope - n) > SLOPE_ERROR or left > CURVATURE or not agrees:
        return
    seen = {power: kind for kind, power in POWERS_OF_S.items() if kind != OVER_TIME}
    kind = seen.get(POWERS_OF_S[data.quantity] - n)
    if n and kind:
        raise MeasurementError(
            f"{path}: measured.quantity: expected {kind}, as which responses go from "
            f"{lowest.f[0]:g} to {lowest.f[-1]:g} Hz, found {data.quantity}"
        )
