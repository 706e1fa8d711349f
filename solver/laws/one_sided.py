"""Springs that act on one side of a gap: bump stops, cables, straps."""

from collections.abc import Sequence
from typing import Literal

from ..arrays import Array
from ..schema.values import AtLeastOne, Positive
from .law import Evaluation, ForceLaw, force_law


@force_law("gap")
class OneSidedLaw(ForceLaw):
    """stiffness d^exponent beyond a gap, where d = -c - gap in compression, c - gap in extension.

    gap: the deformation [m, rad] at which it begins to act, below zero for one that is preloaded;
    stiffness [N/m^exponent, N m/rad^exponent]; exponent: 1 or more; side: the deformation that it
    resists, "compression" (c < 0: a bump stop) or "extension" (c > 0: a cable, a strap).
    """

    gap: float
    stiffness: Positive
    exponent: AtLeastOne = 1.0
    side: Literal["compression", "extension"] = "compression"

    def parameters(self) -> Sequence[float]:
        sign = 1.0 if self.side == "extension" else -1.0
        return [self.gap, self.stiffness, self.exponent, sign]

    @staticmethod
    def evaluate(parameters: Array, memory: Array, h: float, c: float, rate: float) -> Evaluation:
        n, sign = parameters[2], parameters[3]
        d = sign * c - parameters[0]
        if d <= 0.0:
            return 0.0, 0.0, 0.0, 0.0
        slope = parameters[1] * d ** (n - 1.0)
        return sign * slope * d, n * slope, 0.0, slope * d * d / (n + 1.0)
