"""The law of contacts and stops: a force beyond limits, with the restitution that is asked for.

At a penetration d and its rate d',

    F = max(0, N(d) (1 + g d')),    N = stiffness d^exponent, or by a table
    g = a / v0                      v0: speed of approach at the end of the last open step

A body of any mass rebounds with e times its speed, for every N that rises, where

    a (1 + e) = ln((1 + a) / (1 - e a))

for m v dv / (1 + g v) = -N dd in both directions. Source: docs/theory.md, Contact.
"""

import math
from collections.abc import Sequence

import numpy as np

from ..arrays import Array
from ..compiler.marks import compiled
from ..schema.entry import entry
from ..schema.values import NO_ITEMS, Limits, Numbers
from .law import Evaluation, ForceLaw, law_number

LOWER, UPPER, STIFFNESS, EXPONENT, FACTOR, SLOW, DAMPING, PATCH, TABLE = range(9)
"""parameters; from TABLE on the penetrations, forces and energies of a table"""
APPROACH_SPEED = 0
"""place in the memory: speed of approach"""
MAX_PATCH_CORRECTIONS = 60
"""iterations of Newton's method for the force on a patch, which approaches from one side"""
PATCH_PRECISION = 1e-14
"""correction of the indentation, over the indentation, that counts as none"""
FACTOR_PRECISION = 1e-15
"""width of the interval that encloses the factor of a restitution, over the factor"""
SERIES_LIMIT, SERIES_TERMS = 0.05, 14
"""argument below which (x - ln(1 + x)) / x^2 is summed as a series, and its terms: 0.05^14 is below
rounding"""


def restitution_factor(e: float) -> float:
    """The factor a of a coefficient of restitution e, 0 < e <= 1."""
    if e == 1.0:
        return 0.0
    last = (1.0 - 1e-15) / e

    def missed(a: float) -> float:
        return _excess(a) - e**2 * _excess(-e * a)

    if missed(last) > 0.0:  # e < 0.03: a = 1 / e to rounding
        return last
    lower, upper = 0.2 * (1.0 - e), last
    # Bisection, since scipy's root finders take 0.3 s to load.
    while upper - lower > FACTOR_PRECISION * upper:
        middle = 0.5 * (lower + upper)
        lower, upper = (middle, upper) if missed(middle) > 0.0 else (lower, middle)
    return 0.5 * (lower + upper)


def _excess(x: float) -> float:
    """(x - ln(1 + x)) / x^2"""
    if abs(x) > SERIES_LIMIT:
        return (x - math.log1p(x)) / x**2
    return sum((-x) ** k / (k + 2) for k in range(SERIES_TERMS))


@law_number
@entry(eq=True)
class ContactLaw(ForceLaw):
    """Force or moment of a coordinate beyond its limits [m, rad], of which one may be infinite.

    stiffness [N/m^exponent] or table of points (penetration and force, from 0 on; straight beyond
    the last); restitution: 0 < e <= 1; slow [m/s]: slower impacts are damped as this one; damping
    [s/m]: g itself, in place of a restitution; patch [m/N]: compliance that the body has already at
    a patch over which its motion is averaged, taken off.
    """

    limits: Limits
    stiffness: float = 0.0
    exponent: float = 1.0
    restitution: float = 1.0
    slow: float = 0.01
    damping: float = 0.0
    patch: float = 0.0
    penetration: Numbers = NO_ITEMS
    force: Numbers = NO_ITEMS

    def parameters(self) -> Sequence[float]:
        d, f = np.array(self.penetration), np.array(self.force)
        energy = np.concatenate([[0.0], np.cumsum(0.5 * (f[1:] + f[:-1]) * np.diff(d))])
        factor = restitution_factor(self.restitution)
        numbers = (self.stiffness, self.exponent, factor, self.slow, self.damping, self.patch)
        table = [*d, *f, *energy] if len(d) else []
        return [*self.limits, *numbers, *table]

    def memories(self) -> Sequence[float]:
        return [0.0]

    @staticmethod
    def evaluate(parameters: Array, memory: Array, h: float, c: float, rate: float) -> Evaluation:
        d, side = penetration(parameters, c)
        if d <= 0.0:
            return 0.0, 0.0, 0.0, 0.0
        N, slope, energy = _elastic(parameters, d)
        g = _damping(parameters, memory)
        share = 1.0 + g * side * rate
        if share <= 0.0:  # the damping would pull: bodies do not stick together
            return 0.0, 0.0, 0.0, energy
        return side * N * share, slope * share, g * N, energy

    @staticmethod
    def remember(parameters: Array, memory: Array, h: float, c: float, rate: float) -> None:
        d, _ = penetration(parameters, c)
        if d <= 0.0:
            approaches = rate > 0.0 if parameters[UPPER] < math.inf else rate < 0.0
            # Between two limits either direction leads to one.
            both = parameters[LOWER] > -math.inf and parameters[UPPER] < math.inf
            memory[APPROACH_SPEED] = abs(rate) if approaches or both else 0.0


@compiled
def penetration(parameters: Array, c: float) -> tuple[float, float]:
    """How far c is beyond the nearer limit, and the direction of that, 1 or -1."""
    below, above = parameters[LOWER] - c, c - parameters[UPPER]
    return (below, -1.0) if below > above else (above, 1.0)


@compiled
def _damping(parameters: Array, memory: Array) -> float:
    """g"""
    if parameters[FACTOR] > 0.0:
        return float(parameters[FACTOR] / max(memory[APPROACH_SPEED], parameters[SLOW]))
    return float(parameters[DAMPING])


@compiled
def _elastic(parameters: Array, d: float) -> tuple[float, float, float]:
    """N, its slope and the energy at d > 0."""
    if len(parameters) > TABLE:
        return _tabulated(parameters, d)
    K, n = parameters[STIFFNESS], parameters[EXPONENT]
    # The body deforms at its patch already: the law must not count that compliance twice.
    if parameters[PATCH] > 0.0:
        return _less_patch(K, n, parameters[PATCH], d)
    N = K * d**n
    return N, n * N / d, N * d / (n + 1.0)


@compiled
def _tabulated(parameters: Array, d: float) -> tuple[float, float, float]:
    n, k = (len(parameters) - TABLE) // 3, 0
    while k + 2 < n and d > parameters[TABLE + k + 1]:
        k += 1
    start, width = parameters[TABLE + k], parameters[TABLE + k + 1] - parameters[TABLE + k]
    first = parameters[TABLE + n + k]
    slope = (parameters[TABLE + n + k + 1] - first) / width
    N = first + slope * (d - start)
    return N, slope, parameters[TABLE + 2 * n + k] + 0.5 * (first + N) * (d - start)


@compiled
def _less_patch(K: float, n: float, C: float, d: float) -> tuple[float, float, float]:
    """N of d = x - C K x^n, with the indentation x = (N / K)^(1/n), up to where half of the slope
    of the contact is that of the patch; straight from there on.
    """
    if n > 1.0:
        limit = (1.0 / (2.0 * C * K * n)) ** (1.0 / (n - 1.0))
    else:
        limit = math.inf if 2.0 * C * K < 1.0 else 0.0
    last = limit - C * K * limit**n if limit < math.inf else math.inf
    within = min(d, last)
    x = within
    for _ in range(MAX_PATCH_CORRECTIONS):
        change = (x - C * K * x**n - within) / (1.0 - C * K * n * x ** (n - 1.0))
        x -= change
        if abs(change) <= PATCH_PRECISION * x:
            break
    # x is the indentation of a half-space, of which the patch has taken a part.
    N = K * x**n
    compliance = 1.0 / (K * n * x ** (n - 1.0)) - C
    energy = N * x / (n + 1.0) - 0.5 * C * N * N
    beyond = d - within
    slope = 1.0 / compliance
    return N + slope * beyond, slope, energy + (N + 0.5 * slope * beyond) * beyond
