"""Axial forces in flexible bodies over their critical loads (history/axial.py).

Each is a sum of weights times the loads on a body: N / P = w . p.
"""

from ..compiler.marks import compiled
from .system import Elastic, State


@compiled
def follow_axial_forces(elastic: Elastic, state: State) -> None:
    axial, p, largest = elastic.axial, state.interfaces.p, state.extremes.axial
    for i in range(len(axial.body)):
        e, total = axial.body[i], 0.0
        start = axial.start[i] - elastic.dof[e]
        for c in range(elastic.loaded_range[e], elastic.loaded_range[e + 1]):
            k = elastic.loaded[c]
            total += axial.weight[start + k] * p[k]
        largest[i] = max(largest[i], abs(total))
