"""Axial forces in flexible bodies over their critical loads (history/axial.py).

Each is a sum of weights times the loads on a body: N / P = w . p. Bending follows slowly, so that
blows count by their impulse: forces are averaged with a weight that falls by e in the time
1 / omega_1 of the first elastic frequency of the free body.
"""

from ..compiler.marks import compiled
from .system import Elastic, State


@compiled
def start_axial_forces(elastic: Elastic, state: State) -> None:
    """Forces at the start have always acted."""
    for i in range(len(elastic.axial.body)):
        state.extremes.axial_mean[i] = _axial_force(elastic, i, state)


@compiled
def follow_axial_forces(elastic: Elastic, state: State) -> None:
    """Take the forces at the end of a step."""
    mean, largest = state.extremes.axial_mean, state.extremes.axial
    for i in range(len(elastic.axial.body)):
        change = _axial_force(elastic, i, state) - mean[i]
        mean[i] += elastic.axial.share[i] * change
        largest[i] = max(largest[i], abs(mean[i]))


@compiled
def _axial_force(elastic: Elastic, i: int, state: State) -> float:
    axial, p, total = elastic.axial, state.interfaces.p, 0.0
    e = axial.body[i]
    start = axial.start[i] - elastic.dof[e]
    for c in range(elastic.loaded_range[e], elastic.loaded_range[e + 1]):
        k = elastic.loaded[c]
        total += axial.weight[start + k] * p[k]
    return total
