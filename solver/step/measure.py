"""Relative residuals, with the rounding of their terms."""

import math

from ..compiler.marks import compiled

SUM_ROUNDING = 64 * 2.2e-16  # 64 units of the last place
"""rounding of a sum of some ten terms, over the largest of them"""
SMALLEST_SCALE = 1e-300
"""scale below which a double has lost digits, and division by it may overflow"""


@compiled
def relative(residual: float, scale: float, floor: float, tolerance: float) -> float:
    """|residual| / scale, 0 up to the floor that rounding sets, infinite for what is no number."""
    if not abs(residual) < math.inf:  # written so that it holds for NaN as well
        return math.inf
    if abs(residual) <= floor:
        return 0.0
    return tolerance * abs(residual) / max(tolerance * scale, floor, SMALLEST_SCALE)
