"""Springs that act on one side of a gap: bump stops, cables, straps."""

from collections.abc import Sequence
from typing import Literal

from ..arrays import Array
from ..schema.values import AtLeastOne, Positive
from .law import Evaluation, ForceLaw, force_law


@force_law("gap")
class OneSidedLaw(ForceLaw):
    """A force on one side of a gap: stiffness d^exponent where the gap is closed by d > 0.

    The deformation c closes it by d = -c - gap in compression, and by d = c - gap in extension.

    Parameters
    ----------
    gap : float [m, rad]
        Where the law begins to act; below zero for one that is preloaded.
    stiffness : float [N/m^exponent, N m/rad^exponent]
    exponent : float
        1 or more.
    side : {"compression", "extension"}
        The deformation that it resists: c < 0, as a bump stop, or c > 0, as a cable or a strap.

    Examples
    --------
    A strap that is slack up to 0.1 m:

    >>> OneSidedLaw(0.1, stiffness=2e4, side="extension").exponent
    1.0
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
