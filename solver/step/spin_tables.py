"""Tables of bearings: stiffness and damping that change with the spin of a shaft.

With the offsets dK, dC of a table at the spin Omega, the rate of row s, and the rows j of the same
coupling, the residual of row i gets

    sum_j (dK_ij(Omega) (c_j - rest_j) + dC_ij(Omega) dc_j/dt)

which is linear between the speeds of the table, and no number far beyond them: a step cannot end
there. Source: docs/theory.md, Rotors.
"""

import math

from ..compiler.marks import compiled
from .records.laws import Laws, SpinTables
from .system import Workspace

# of the range of a table, beyond its ends, in which the last coefficients hold
MARGIN_OF_TABLE = 0.01


@compiled
def beyond_table(tables: SpinTables, t: int, spin: float) -> float:
    """How far [rad/s] a spin is beyond the margins of table t, positive where it is."""
    low, high = tables.speed[tables.first[t]], tables.speed[tables.first[t + 1] - 1]
    return float(max(low - spin, spin - high) - MARGIN_OF_TABLE * (high - low))


@compiled
def _place(tables: SpinTables, t: int, spin: float) -> tuple[int, float]:
    """The interval of table t that has a spin, by its first speed, and the share passed of it."""
    k, last = tables.first[t], tables.first[t + 1] - 1
    while k < last - 1 and spin > tables.speed[k + 1]:
        k += 1
    share = (spin - tables.speed[k]) / (tables.speed[k + 1] - tables.speed[k])
    return k, min(max(share, 0.0), 1.0)


@compiled
def added_coefficients(tables: SpinTables, t: int, j: int, spin: float) -> tuple[float, float]:
    """Stiffness and damping that table t adds against row j (0, 1) of its coupling."""
    if not beyond_table(tables, t, spin) <= 0.0:
        return math.nan, math.nan
    k, share = _place(tables, t, spin)
    stiffness = (1.0 - share) * tables.stiffness[k, j] + share * tables.stiffness[k + 1, j]
    damping = (1.0 - share) * tables.damping[k, j] + share * tables.damping[k + 1, j]
    return stiffness, damping


@compiled
def added_slopes(tables: SpinTables, t: int, j: int, spin: float) -> tuple[float, float]:
    """Derivatives of the added stiffness and damping by the spin."""
    k, share = _place(tables, t, spin)
    if share <= 0.0 or share >= 1.0:
        return 0.0, 0.0
    width = tables.speed[k + 1] - tables.speed[k]
    stiffness = (tables.stiffness[k + 1, j] - tables.stiffness[k, j]) / width
    return stiffness, (tables.damping[k + 1, j] - tables.damping[k, j]) / width


@compiled
def table_force(laws: Laws, i: int, first: int, work: Workspace) -> tuple[float, float]:
    """What the table of row i adds to its force, and the sum of the magnitudes of its terms."""
    t, out = laws.tables.of[i], work.couplings
    total, magnitude = 0.0, 0.0
    if t < 0:
        return total, magnitude
    for j in range(2):
        spin = out.rate[laws.tables.spin[t]]
        stiffness, damping = added_coefficients(laws.tables, t, j, spin)
        elastic = stiffness * (out.coordinate[first + j] - laws.rest[first + j])
        viscous = damping * out.rate[first + j]
        total += elastic + viscous
        magnitude += abs(elastic) + abs(viscous)
    return total, magnitude


@compiled
def table_slope_by_spin(laws: Laws, i: int, first: int, work: Workspace) -> float:
    """Derivative of what the table of row i adds to its force by the spin."""
    t, out, total = laws.tables.of[i], work.couplings, 0.0
    for j in range(2):
        by_stiffness, by_damping = added_slopes(laws.tables, t, j, out.rate[laws.tables.spin[t]])
        total += by_stiffness * (out.coordinate[first + j] - laws.rest[first + j])
        total += by_damping * out.rate[first + j]
    return total


@compiled
def elastic_table_force(laws: Laws, i: int, first: int, work: Workspace) -> float:
    """The part of `table_force` by stiffness."""
    t, out, total = laws.tables.of[i], work.couplings, 0.0
    if t < 0:
        return total
    for j in range(2):
        stiffness, _ = added_coefficients(laws.tables, t, j, out.rate[laws.tables.spin[t]])
        total += stiffness * (out.coordinate[first + j] - laws.rest[first + j])
    return total
