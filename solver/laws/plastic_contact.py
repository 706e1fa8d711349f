"""The law of contacts and stops that yield: restitution falls with speed, and a dent remains.

Up to the yield force the law is the elastic one, N = K d^n. Beyond it the force rises in a straight
line, with post_yield times the slope at yield. From the deepest penetration D, where the force is
F, it unloads and loads again elastically, on the curve of a surface that is flatter by its dent,

    N = F ((d - p) / (D - p))^n,    D - p = F / (K D^(n - 1)),

which begins with the elastic slope at D, n K D^(n - 1). Of a ball on a plane, n = 3/2 and
post_yield = 1, this is Thornton's law: the contact pressure ends at the yield pressure, and the
patch, of the radius sqrt(R D), unloads as that of a ball of the radius R D / (D - p).

Source: C. Thornton, J. Appl. Mech. 64 (1997), 383-386; docs/theory.md, Contact.
"""

from collections.abc import Sequence

from ..arrays import Array
from ..compiler.marks import compiled
from ..schema.entry import entry
from ..schema.values import Limits
from .contact import penetration
from .law import Evaluation, ForceLaw, law_number

STIFFNESS, EXPONENT, YIELD_FORCE, POST_YIELD, NEW_SPOT = range(2, 7)
"""parameters, behind the limits"""


@law_number
@entry(eq=True)
class PlasticContactLaw(ForceLaw):
    """Force or moment of a coordinate beyond its limits [m, rad], where it deforms for good.

    stiffness [N/m^exponent]; yield_force [N]; post_yield: the slope beyond it over that at yield;
    new_spot: whether each impact meets a surface without a dent.
    """

    limits: Limits
    stiffness: float
    exponent: float
    yield_force: float
    post_yield: float = 1.0
    new_spot: bool = False

    def parameters(self) -> Sequence[float]:
        numbers = (self.stiffness, self.exponent, self.yield_force, self.post_yield)
        return [*self.limits, *numbers, float(self.new_spot)]

    def memories(self) -> Sequence[float]:
        """The deepest penetration beyond the lower and the upper limit."""
        return [0.0, 0.0]

    @staticmethod
    def evaluate(parameters: Array, memory: Array, h: float, c: float, rate: float) -> Evaluation:
        d, side = penetration(parameters, c)
        if d <= 0.0:
            return 0.0, 0.0, 0.0, 0.0
        n, deepest = parameters[EXPONENT], max(memory[_limit(side)], d)
        # A penetration beyond all earlier ones makes its own dent within the step.
        F, slope = loading(parameters, deepest)
        recovered = _recovery(parameters, deepest, F)
        left = d - (deepest - recovered)
        if left <= 0.0:
            return 0.0, 0.0, 0.0, 0.0
        N = F * (left / recovered) ** n
        # On the way in the dent grows with the penetration.
        if d < deepest:
            slope = n * N / left
        return side * N, slope, 0.0, N * left / (n + 1.0)

    @staticmethod
    def remember(parameters: Array, memory: Array, h: float, c: float, rate: float) -> None:
        d, side = penetration(parameters, c)
        # A body that left its dent meets the surface elsewhere, but not before it is clear of it.
        if d <= 0.0 and parameters[NEW_SPOT] > 0.0:
            memory[0] = 0.0
            memory[1] = 0.0
        elif d > memory[_limit(side)]:
            memory[_limit(side)] = d

    @staticmethod
    def permanent(parameters: Array, memory: Array, c: float) -> float:
        """The depth of the dent at the limit that is nearer to c."""
        _, side = penetration(parameters, c)
        deepest = memory[_limit(side)]
        # Without a dent nothing unloads, and powers of zero mean nothing.
        if deepest <= 0.0:
            return 0.0
        F, _ = loading(parameters, deepest)
        return float(max(deepest - _recovery(parameters, deepest, F), 0.0))


@compiled
def _limit(side: float) -> int:
    """The place in the memory of the limit on a side."""
    return 1 if side < 0.0 else 0


@compiled
def loading(parameters: Array, d: float) -> tuple[float, float]:
    """Force and slope at a penetration d > 0 that is the deepest so far."""
    K, n, limit = parameters[STIFFNESS], parameters[EXPONENT], parameters[YIELD_FORCE]
    N = K * d**n
    # Elastic as without a yield force, until it is reached.
    if limit >= N:
        return N, n * N / d
    at_yield = (limit / K) ** (1.0 / n)
    slope = parameters[POST_YIELD] * n * limit / at_yield
    return limit + slope * (d - at_yield), slope


@compiled
def _recovery(parameters: Array, deepest: float, F: float) -> float:
    """How far the force F at the deepest penetration unloads until it vanishes."""
    K, n = parameters[STIFFNESS], parameters[EXPONENT]
    # Below the yield force this is the whole penetration, to the bit.
    if K * deepest**n <= parameters[YIELD_FORCE]:
        return deepest
    return float(F / (K * deepest ** (n - 1.0)))
