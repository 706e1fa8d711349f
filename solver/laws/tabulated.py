"""A force law given by points."""

from collections.abc import Sequence
from itertools import pairwise

from ..arrays import Array
from ..schema.values import Numbers
from .law import Evaluation, ForceLaw, force_law


@force_law("deformation")
class TabulatedLaw(ForceLaw):
    """Force [N] or moment [N m] over deformation [m, rad].

    Linear between the points, and beyond the last ones.
    """

    deformation: Numbers
    force: Numbers

    def validate(self) -> None:
        if len(self.deformation) != len(self.force) or len(self.force) < 2:
            points = f"{list(self.deformation)} and {list(self.force)}"
            raise self.error(f"a law needs two or more points, got {points}")
        if any(b <= a for a, b in pairwise(self.deformation)):
            values = f"{list(self.deformation)}"
            raise self.error(f"deformation: expected increasing values, got {values}")

    def parameters(self) -> Sequence[float]:
        return [*self.deformation, *self.force]

    @staticmethod
    def evaluate(parameters: Array, c: float, rate: float) -> Evaluation:
        """The energy counts from the first point."""
        n = len(parameters) // 2
        energy, k = 0.0, 0
        while k + 2 < n and c > parameters[k + 1]:
            width = parameters[k + 1] - parameters[k]
            energy += 0.5 * (parameters[n + k] + parameters[n + k + 1]) * width
            k += 1
        start, force = parameters[k], parameters[n + k]
        slope = (parameters[n + k + 1] - force) / (parameters[k + 1] - start)
        value = force + slope * (c - start)
        return value, slope, 0.0, energy + 0.5 * (force + value) * (c - start)
