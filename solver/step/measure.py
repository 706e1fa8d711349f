"""Relative residuals, with the rounding of their terms."""

import math

from ..compiler.marks import compiled

ROUNDING = 64 * 2.2e-16
"""relative, of a sum of many terms"""
SMALLEST = 1e-300
"""a scale so small has no digits left"""


@compiled
def relative(residual: float, scale: float, floor: float, tolerance: float) -> float:
    """|residual| / scale, 0 up to the floor that rounding sets, infinite for what is no number."""
    if not abs(residual) < math.inf:
        return math.inf
    if abs(residual) <= floor:
        return 0.0
    return tolerance * abs(residual) / max(tolerance * scale, floor, SMALLEST)
