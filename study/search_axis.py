"""A parameter within a search: where it begins, its bounds, and how it is counted."""

from dataclasses import dataclass
from math import exp, log

import numpy as np

from ..inputs import dotted
from .errors import StudyError
from .one_model import StudyParameter

JACOBIAN_STEP = 1e-4
"""of the scale of a parameter, for central differences: smooth runs are right to 1e-8 there"""
LEAST_DISTANCE = 1e-9
"""of a start from its bounds, over their distance"""
BOUND_ROUNDING = 1e-12
"""of a bound, or of the scale of a parameter"""
SHIFT_NAME = "shift"
"""the name of the parameter that moves a run over time"""


@dataclass(frozen=True)
class SearchAxis:
    """A parameter: start, scale of its differences, bounds; by its logarithm within the search."""

    name: str
    start: float
    scale: float
    low: float
    high: float
    logarithmic: bool

    @classmethod
    def of(cls, name: str, parameter: StudyParameter) -> "SearchAxis":
        start, bounds = parameter.value, parameter.bounds
        low, high = bounds or (-np.inf, np.inf)
        if not low <= start <= high:
            raise StudyError(
                f"parameters.{dotted([name])}: expected a start between {low:.6g} and {high:.6g}, "
                f"found {start:.6g}"
            )
        scale = abs(start) or (high - low if bounds else 0.0)
        if not scale > 0.0:
            raise StudyError(
                f"parameters.{dotted([name])}: begins at 0: expected bounds, {{uniform = [..]}}"
            )
        return cls(name, start, scale, low, high, parameter.logarithmic)

    @property
    def begin(self) -> float:
        """The start, strictly within the bounds, as the search wants it."""
        if not np.isfinite(self.high - self.low):
            return self.start
        margin = LEAST_DISTANCE * (self.high - self.low)
        return min(max(self.start, self.low + margin), self.high - margin)

    def at_bound(self, side: int) -> float:
        """The lower bound, -1, or the upper one, 1."""
        return self.low if side < 0 else self.high

    def ends(self, value: float, width: float = JACOBIAN_STEP) -> tuple[float, float]:
        """Between which the difference about a value is taken; width: over its scale."""
        step = width * (abs(value) if self.logarithmic else self.scale)
        # One-sided at a bound: beyond it the model may not exist.
        return min(value + step, self.high), max(value - step, self.low)

    def within(self, value: float) -> float:
        """A value that the rounding of the search has not moved off a bound."""
        for end in (self.low, self.high):
            if abs(value - end) <= BOUND_ROUNDING * max(abs(end), self.scale) < np.inf:
                return end
        return min(max(value, self.low), self.high)

    def inner(self, value: float) -> float:
        return log(value) if self.logarithmic else value / self.scale

    def outer(self, inner: float) -> float:
        return exp(inner) if self.logarithmic else inner * self.scale

    def slope(self, value: float) -> float:
        """d value / d inner"""
        return value if self.logarithmic else self.scale
