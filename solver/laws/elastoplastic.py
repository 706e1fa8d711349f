"""Springs and hinges that yield at a sharp limit and keep a permanent deformation."""

from collections.abc import Sequence
from typing import Annotated

from ..arrays import Array
from ..compiler.marks import compiled
from ..schema.values import Fraction, Positive, number
from .law import Evaluation, ForceLaw, force_law

PLASTIC, ACCUMULATED = range(2)
"""places in the memory: plastic deformation, and the sum of the magnitudes of its changes"""

BelowOne = Annotated[
    float, number("a number from 0 to less than 1", float, lambda ratio: 0.0 <= ratio < 1.0)
]


@force_law("yield_force")
class ElastoplasticLaw(ForceLaw):
    """A spring or hinge that yields: bilinear, with kinematic and isotropic hardening.

        f = k (c - p),    |f - (1 - s) H p| <= yield_force + s H a,    a' = |p'|

    p is the plastic deformation and H = k post_yield / (1 - post_yield), so that a virgin spring
    has the stiffness k up to `yield_force` and post_yield k beyond it. Stored: k (c - p)^2 / 2 +
    (1 - s) H p^2 / 2. The rest of the work, (yield_force + s H a) |p'| over time, is dissipated.

    Parameters
    ----------
    yield_force : float [N, N m]
        The force, or moment, at which plastic deformation begins.
    stiffness : float [N/m, N m/rad]
        k, below the yield force.
    post_yield : float
        The stiffness while it yields, over k: 0 (ideally plastic) to less than 1.
    isotropic : float
        s, the share of isotropic hardening: 0 (the elastic range moves) to 1 (it grows).

    Examples
    --------
    A plastic hinge of 40 N m:

    >>> from duhamel.solver import Spring
    >>> law = ElastoplasticLaw(40.0, stiffness=8e3, post_yield=0.05)
    >>> Spring("hinge", "torsion", ["post", "beam"], [0, 1, 0], law=law).law.isotropic
    0.0

    References
    ----------
    Simo, Hughes: Computational Inelasticity (1998), 1.2 and box 1.5.
    """

    yield_force: Positive
    stiffness: Positive
    post_yield: BelowOne = 0.0
    isotropic: Fraction = 0.0

    def parameters(self) -> Sequence[float]:
        """Yield force, k, and the moduli of kinematic and isotropic hardening."""
        modulus = self.stiffness * self.post_yield / (1.0 - self.post_yield)
        kinematic, isotropic = (1.0 - self.isotropic) * modulus, self.isotropic * modulus
        return [self.yield_force, self.stiffness, kinematic, isotropic]

    def memories(self) -> Sequence[float]:
        return [0.0, 0.0]

    @staticmethod
    def evaluate(parameters: Array, memory: Array, h: float, c: float, rate: float) -> Evaluation:
        k, kinematic, isotropic = parameters[1], parameters[2], parameters[3]
        change = plastic_change(parameters, memory, c)
        p = memory[PLASTIC] + change
        elastic = c - p
        slope = k
        # The tangent of the return mapping, with which Newton's method keeps its order.
        if change != 0.0:
            slope = k * (kinematic + isotropic) / (k + kinematic + isotropic)
        return k * elastic, slope, 0.0, 0.5 * (k * elastic * elastic + kinematic * p * p)

    @staticmethod
    def remember(parameters: Array, memory: Array, h: float, c: float, rate: float) -> None:
        change = plastic_change(parameters, memory, c)
        # Reversals within a step are not seen: the path is taken as one way.
        memory[PLASTIC] += change
        memory[ACCUMULATED] += abs(change)

    @staticmethod
    def permanent(parameters: Array, memory: Array, c: float) -> float:
        return float(memory[PLASTIC])


@compiled
def plastic_change(parameters: Array, memory: Array, c: float) -> float:
    """What the plastic deformation changes by up to the deformation c, in one direction.

    The return mapping, which is exact for linear hardening in steps of any length.
    """
    k, kinematic, isotropic = parameters[1], parameters[2], parameters[3]
    over = k * (c - memory[PLASTIC]) - kinematic * memory[PLASTIC]
    # With the plastic deformation of the last step: elastic until the contrary is shown.
    excess = abs(over) - (parameters[0] + isotropic * memory[ACCUMULATED])
    if excess <= 0.0:
        return 0.0
    change = excess / (k + kinematic + isotropic)
    return float(change if over > 0.0 else -change)
