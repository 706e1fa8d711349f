"""Force laws of rows: a linear one of all rows of a coupling, and any number of each row alone."""

from ..compiler.marks import compiled
from ..laws import evaluate_law, permanent_of_law, remember_law
from .measure import SUM_ROUNDING
from .motors import motor_law, settle_motors
from .records.laws import Laws
from .rows import measures_length
from .spin_tables import table_force
from .system import State, System, Workspace


@compiled
def set_law_residual(
    laws: Laws, i: int, first: int, last: int, state: State, work: Workspace
) -> None:
    """phi of a force law, and the sum of the magnitudes of its terms."""
    out, lam = work.couplings, state.couplings.lam[i]
    total, magnitude = lam, abs(lam)
    for j in range(first, last):
        elastic = laws.stiffness[i, j - first] * (out.coordinate[j] - laws.rest[j])
        viscous = laws.damping[i, j - first] * out.rate[j]
        total += elastic + viscous
        magnitude += abs(elastic) + abs(viscous)
    force, _, _, _ = law_of_row(laws, i, state, work)
    by_spin, scale = table_force(laws, i, first, work)
    out.phi[i] = total + force + by_spin
    out.scale[i] = magnitude + abs(force) + scale
    m = laws.motor[i]
    if m >= 0:
        out.scale[i] += work.motors.scale[m]


@compiled
def law_of_row(
    laws: Laws, i: int, state: State, work: Workspace
) -> tuple[float, float, float, float]:
    """Force, slopes by coordinate and rate, and energy of the laws of row i alone."""
    # A motor row has no other law, and its force depends on signals and a stepped integral.
    if laws.motor[i] >= 0:
        return motor_law(laws.motors, laws.motor[i], state, work)
    force, slope, rate_slope, energy = 0.0, 0.0, 0.0, 0.0
    if laws.range[i] == laws.range[i + 1]:
        return force, slope, rate_slope, energy
    out = work.couplings
    c = out.coordinate[i] - laws.rest[i]
    for m in range(laws.range[i], laws.range[i + 1]):
        parameters = laws.parameters[laws.first[m] : laws.first[m + 1]]
        memory = state.couplings.memory[laws.memory[m] : laws.memory[m + 1]]
        f, by_c, by_rate, stored = evaluate_law(
            laws.number[m], parameters, memory, out.elapsed[0], c, out.rate[i]
        )
        force += f
        slope += by_c
        rate_slope += by_rate
        energy += stored
    return force, slope, rate_slope, energy


@compiled
def remember_laws(laws: Laws, state: State, work: Workspace) -> None:
    """Bring the memories of all laws, and the integrals of motors, to the end of a step, from where
    no time has elapsed.
    """
    out = work.couplings
    # Laws without memory, which are most, cost nothing here.
    rows = len(laws.rest) if len(state.couplings.memory) > 0 else 0
    for i in range(rows):
        c = out.coordinate[i] - laws.rest[i]
        for m in range(laws.range[i], laws.range[i + 1]):
            parameters = laws.parameters[laws.first[m] : laws.first[m + 1]]
            memory = state.couplings.memory[laws.memory[m] : laws.memory[m + 1]]
            remember_law(laws.number[m], parameters, memory, out.elapsed[0], c, out.rate[i])
    settle_motors(state, work)
    # From now on laws are evaluated at the time of their memory, as in records.
    out.elapsed[0] = 0.0


@compiled
def permanent_of_row(laws: Laws, i: int, c: float, state: State) -> float:
    """The permanent deformation of the laws of row i, at its coordinate c."""
    total = 0.0
    for m in range(laws.range[i], laws.range[i + 1]):
        # What is permanent is remembered; most laws have no memory.
        if laws.memory[m + 1] > laws.memory[m]:
            parameters = laws.parameters[laws.first[m] : laws.first[m + 1]]
            memory = state.couplings.memory[laws.memory[m] : laws.memory[m + 1]]
            total += permanent_of_law(laws.number[m], parameters, memory, c - laws.rest[i])
    return total


@compiled
def law_rounding(
    system: System, i: int, first: int, reach: float, state: State, work: Workspace
) -> float:
    """Change of the force law of row i by the rounding of positions; its rows begin at `first`."""
    couplings, gamma_prime = system.couplings, system.scheme.gamma_prime
    laws = couplings.laws
    kind = couplings.rows.kind
    _, slope, rate_slope, _ = law_of_row(laws, i, state, work)
    steep = abs(slope) + gamma_prime * abs(rate_slope)
    turned = max(1.0, abs(work.couplings.coordinate[i])) if laws.motor[i] >= 0 else 1.0
    total = steep * (reach if measures_length(kind[i]) else turned)
    # No coupling has more than six coordinates with a joint stiffness matrix.
    for j in range(first, min(first + 6, len(kind))):
        steep = abs(laws.stiffness[i, j - first]) + gamma_prime * abs(laws.damping[i, j - first])
        total += steep * (reach if measures_length(kind[j]) else 1.0)
    return SUM_ROUNDING * total
