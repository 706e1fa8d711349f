"""Axial forces in flexible bodies over their critical loads (history/axial.py).

Each is a sum of weights times the loads on a body, and a tension by its spin:

    N / P = w . p + spread (omega^2 - (e . omega)^2)

Bending follows slowly, so that blows count by their impulse: forces are averaged with a weight that
falls by e in the time 1 / omega_1 of the first elastic frequency of the free body.
"""

from ..compiler.marks import compiled
from .bodies import spin_of
from .records.elastic import Elastic
from .system import State
from .vectors import dot


@compiled
def start_axial_forces(elastic: Elastic, state: State) -> None:
    """Forces at the start have always acted."""
    for i in range(len(elastic.axial.body)):
        state.extremes.axial_mean[i] = axial_force(elastic, i, state)


@compiled
def follow_axial_forces(elastic: Elastic, state: State) -> None:
    """Take the forces at the end of a step."""
    mean, largest = state.extremes.axial_mean, state.extremes.axial
    for i in range(len(elastic.axial.body)):
        change = axial_force(elastic, i, state) - mean[i]
        mean[i] += elastic.axial.share[i] * change
        largest[i] = max(largest[i], abs(mean[i]))


@compiled
def axial_force(elastic: Elastic, i: int, state: State) -> float:
    """Axial force i over the critical load, tension positive."""
    axial, p = elastic.axial, state.interfaces.p
    e = axial.body[i]
    omega = spin_of(state, elastic.body[e])
    along = dot(omega, (axial.line[i, 0], axial.line[i, 1], axial.line[i, 2]))
    total = axial.spread[i] * (dot(omega, omega) - along * along)
    start = axial.start[i] - elastic.dof[e]
    for c in range(elastic.loaded_range[e], elastic.loaded_range[e + 1]):
        k = elastic.loaded[c]
        total += axial.weight[start + k] * p[k]
    return float(total)
