"""Hertz's law of two curved surfaces that touch at a point, with an elliptic patch.

With k1 <= k2, the sums of the curvatures of both surfaces in the two principal directions, and a
patch of semi-axes a >= b, e^2 = 1 - (b/a)^2, K and E the complete elliptic integrals of e^2,

    k2 / k1 = (E / (1 - e^2) - K) / (K - E)
    a = sqrt(2 (K - E) d / (k1 e^2 K))
    F = 2 pi / 3 E* sqrt(2 (K - E) / (k1 e^2)) K^(-3/2) d^(3/2)

at a penetration d; of a sphere of radius r on a plane k1 = k2 = 1/r, a^2 = r d and
F = 4/3 E* sqrt(r) d^(3/2). Source: K. L. Johnson, Contact Mechanics, 1985, section 4.2.
"""

import math
from typing import NamedTuple

MIN_AXES_SQUARE = 1e-24
"""(b/a)^2 of the longest patch, of curvatures whose ratio is about 1e-22"""


class Patch(NamedTuple):
    """Of the law F = stiffness E* d^1.5.

    stiffness [m^0.5]; long, short: the semi-axes over sqrt(d) [m^0.5], across the smaller and the
    larger of the curvatures.
    """

    stiffness: float
    long: float
    short: float

    def force_at(self, pressure: float, stiffness: float) -> float:
        """The force [N] at which the largest pressure, 3 F / (2 pi a b), has a value [Pa].

        stiffness [N/m^1.5]: F / d^1.5.
        """
        root = 2.0 * math.pi * self.long * self.short * pressure / (3.0 * stiffness)
        return stiffness * root**3


def patch_of(k1: float, k2: float) -> Patch:
    """The patch of two sums of curvatures [1/m], both positive, in any order."""
    from scipy.special import ellipkm1, elliprd  # slow to load, and few models need it

    least, most = min(k1, k2), max(k1, k2)
    square = _square_of_axes(most / least)
    K = float(ellipkm1(square))
    # (K - E) / e^2, which cancels for a round patch, by Carlson's integral
    D = float(elliprd(0.0, square, 1.0)) / 3.0
    long = math.sqrt(2.0 * D / (least * K))
    stiffness = 2.0 * math.pi / 3.0 * math.sqrt(2.0 * D / least) / K**1.5
    return Patch(stiffness, long, long * math.sqrt(square))


def _square_of_axes(ratio: float) -> float:
    """(b/a)^2 of a ratio k2 / k1 >= 1."""
    from scipy.optimize import brentq
    from scipy.special import elliprd

    def excess(logarithm: float) -> float:
        square = math.exp(logarithm)
        return float(elliprd(0.0, 1.0, square) / elliprd(0.0, square, 1.0)) - ratio

    if excess(0.0) >= 0.0:  # round, but for rounding
        return 1.0
    if excess(math.log(MIN_AXES_SQUARE)) <= 0.0:
        return MIN_AXES_SQUARE
    return math.exp(float(brentq(excess, math.log(MIN_AXES_SQUARE), 0.0, xtol=1e-14, rtol=1e-14)))
