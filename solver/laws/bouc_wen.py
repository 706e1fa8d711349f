"""Hysteresis of Bouc and Wen, independent of the rate: wire ropes, steel, dry friction."""

import math
from collections.abc import Sequence
from typing import Annotated

import numpy as np

from ..arrays import Array
from ..compiler.marks import compiled
from ..schema.values import AtLeastOne, Fraction, Positive, number
from .law import Evaluation, ForceLaw, force_law

STEPS_PER_YIELD = 16.0
"""steps of Runge and Kutta in which n times the yield deformation is taken"""
SATURATION_LIMIT = 30.0
"""-log(1 - w) from which its derivative is n; (1 - w^n) / (1 - w) is lost in rounding at 37"""
MAX_UNLOADING_CORRECTIONS = 30
"""iterations of Newton's method for the end of an unloading, which converges quadratically"""
N_GAUSS_POINTS = 16
_nodes, _weights = np.polynomial.legendre.leggauss(N_GAUSS_POINTS)
GAUSS_POINTS: tuple[float, ...] = tuple((0.5 + 0.5 * _nodes).tolist())
GAUSS_WEIGHTS: tuple[float, ...] = tuple((0.5 * _weights).tolist())
"""points and weights of Gauss on (0, 1)"""

Beta = Annotated[
    float,
    number("a number from 0.5 (less creates energy) to 100", float, lambda b: 0.5 <= b <= 100),
]


@force_law("yield_deformation")
class BoucWenLaw(ForceLaw):
    """Hysteresis of Bouc and Wen: a spring that yields, without a corner.

        f = post_yield k c + (1 - post_yield) k D z
        D z' = c' (1 - |z|^n (gamma + beta sgn(c' z)))

    The virgin state has z = 0, and |z| < 1. Stored: post_yield k c^2 / 2 + (1 - post_yield) k D^2
    z^2 / 2. The rest of the work, (1 - post_yield) k D |c'| |z|^(n+1) (beta + gamma sgn(c' z)) over
    time, is dissipated, and never negative as |gamma| <= beta.

    Parameters
    ----------
    yield_deformation : float [m, rad]
        D.
    stiffness : float [N/m, N m/rad]
        k, that of small deformations.
    post_yield : float
        The part of k that is left when all has yielded, 0 to 1.
    exponent : float
        n: 1 (round) or more (towards a corner).
    beta : float
        0.5 where unloading is elastic, more for slimmer loops. gamma is 1 - beta; A of the
        literature is 1, for other values are those of other k and D.

    Examples
    --------
    >>> from duhamel.solver import Spring
    >>> law = BoucWenLaw(1e-3, stiffness=2e5, post_yield=0.1)
    >>> Spring("isolator", "point", ["ground", "box"], law=law).law.exponent
    1.0

    References
    ----------
    Y. K. Wen, J. Eng. Mech. Div. ASCE 102 (1976); F. Ma et al., J. Appl. Mech. 71 (2004) (redundant
    parameters); S. Erlicher, N. Point, C. R. Mecanique 332 (2004) (energy).
    """

    yield_deformation: Positive
    stiffness: Positive
    post_yield: Fraction = 0.0
    exponent: AtLeastOne = 1.0
    beta: Beta = 0.5

    def parameters(self) -> Sequence[float]:
        """With beta - gamma as the last."""
        shape = [self.exponent, 2.0 * self.beta - 1.0]
        return [self.yield_deformation, self.stiffness, self.post_yield, *shape]

    def memories(self) -> Sequence[float]:
        """c / D and z."""
        return [0.0, 0.0]

    @staticmethod
    def evaluate(parameters: Array, memory: Array, h: float, c: float, rate: float) -> Evaluation:
        D, k, post = parameters[0], parameters[1], parameters[2]
        z, slope = hysteresis(parameters[3], parameters[4], memory[1], c / D - memory[0])
        elastic, yielding = post * k, (1.0 - post) * k
        force = elastic * c + yielding * D * z
        energy = 0.5 * (elastic * c * c + yielding * D * D * z * z)
        return force, elastic + yielding * slope, 0.0, energy

    @staticmethod
    def remember(parameters: Array, memory: Array, h: float, c: float, rate: float) -> None:
        end = c / parameters[0]
        memory[1], _ = hysteresis(parameters[3], parameters[4], memory[1], end - memory[0])
        memory[0] = end


@compiled
def hysteresis(n: float, kappa: float, z: float, change: float) -> tuple[float, float]:
    """z after a change of c / D in one direction, and its derivative by the change.

    With w = z in this direction: w' = 1 + kappa |w|^n while w < 0, 1 - w^n from there on, where
    kappa = beta - gamma. Without a change the slope is that at z = 0, between those of both
    directions.
    """
    if change == 0.0:
        return z, 1.0
    sign = 1.0 if change > 0.0 else -1.0
    w, left = sign * z, abs(change)
    if w < 0.0:
        w, left = _unload(n, kappa, w, left)
        if w < 0.0:
            return sign * w, 1.0 + kappa * (-w) ** n
    w = _load(n, w, left)
    return sign * w, 1.0 - w**n


@compiled
def _unload(n: float, kappa: float, w: float, change: float) -> tuple[float, float]:
    """w < 0 after a change, up to 0, and what is left of the change."""
    start = -w
    whole = _unloading(n, kappa, 0.0, start)
    if change >= whole:
        return 0.0, change - whole
    if kappa == 0.0:
        return w + change, 0.0
    u = 0.0
    for _ in range(MAX_UNLOADING_CORRECTIONS):  # from below, where Newton's method never overshoots
        step = (_unloading(n, kappa, u, start) - change) * (1.0 + kappa * u**n)
        u += step
        if abs(step) <= 1e-16 * start:
            break
    return -u, 0.0


@compiled
def _unloading(n: float, kappa: float, end: float, start: float) -> float:
    """The change that takes |w| from start to end: integral of 1 / (1 + kappa u^n)."""
    if kappa == 0.0:
        return start - end
    # The integral is elementary only here, and for the exponent that most users take.
    if n == 1.0:
        return math.log((1.0 + kappa * start) / (1.0 + kappa * end)) / kappa
    total = 0.0
    for j in range(N_GAUSS_POINTS):
        u = end + (start - end) * GAUSS_POINTS[j]
        total += GAUSS_WEIGHTS[j] / (1.0 + kappa * u**n)
    return total * (start - end)


@compiled
def _load(n: float, w: float, change: float) -> float:
    """w >= 0 after a change: in t = -log(1 - w), whose derivative is between 1 and n."""
    if w >= 1.0:
        return w
    # In t the approach to w = 1 is nearly a straight line, which steps follow without overshooting.
    t = -math.log(1.0 - w)
    while n != 1.0 and change > 0.0 and t < SATURATION_LIMIT:
        step = min(change, 1.0 / (STEPS_PER_YIELD * n))
        k1 = _steepness(n, t)
        k2 = _steepness(n, t + 0.5 * step * k1)
        k3 = _steepness(n, t + 0.5 * step * k2)
        k4 = _steepness(n, t + step * k3)
        t += step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        change -= step
    return 1.0 - math.exp(-(t + n * change))


@compiled
def _steepness(n: float, t: float) -> float:
    """(1 - w^n) / (1 - w) at w = 1 - exp(-t): 1 at the start, n in the end."""
    apart = math.exp(-t)
    return float((1.0 - (1.0 - apart) ** n) / apart)
