"""Axial forces in flexible bodies over their critical loads (history/axial.py).

Each is a sum of weights times the loads on a body, and a tension by its spin:

    N / P = w . p + factor sum_k (e . X_k)(e . f_k) + spread (omega^2 - (e . omega)^2)

with the forces f of contacts on nodes of surfaces.

Bending follows slowly, so that blows count by their impulse: forces are averaged with a weight that
falls by e in the time 1 / omega_1 of the first elastic frequency of the free body.
"""

from ..compiler.marks import compiled
from .bodies import spin_of
from .system import State, System
from .vectors import Vector, dot, row


@compiled
def start_axial_forces(system: System, state: State) -> None:
    """Forces at the start have always acted."""
    for i in range(len(system.elastic.axial.body)):
        state.extremes.axial_mean[i] = axial_force(system, i, state)


@compiled
def follow_axial_forces(system: System, state: State) -> None:
    """Take the forces at the end of a step."""
    mean, largest, axial = state.extremes.axial_mean, state.extremes.axial, system.elastic.axial
    for i in range(len(axial.body)):
        change = axial_force(system, i, state) - mean[i]
        mean[i] += axial.share[i] * change
        largest[i] = max(largest[i], abs(mean[i]))


@compiled
def axial_force(system: System, i: int, state: State) -> float:
    """Axial force i over the critical load, tension positive."""
    elastic, p = system.elastic, state.interfaces.p
    axial, line = elastic.axial, row(elastic.axial.line, i)
    e = axial.body[i]
    omega = spin_of(state, elastic.body[e])
    along = dot(omega, line)
    total = axial.spread[i] * (dot(omega, omega) - along * along)
    start = axial.start[i] - elastic.dof[e]
    for c in range(elastic.loaded_range[e], elastic.loaded_range[e + 1]):
        k = elastic.loaded[c]
        total += axial.weight[start + k] * p[k]
    return float(total + axial.factor[i] * _dipole_of_contacts(system, e, line, state))


@compiled
def _dipole_of_contacts(system: System, e: int, line: Vector, state: State) -> float:
    """sum_k (e . X_k)(e . f_k) along a line of the nodes of surfaces of body e."""
    bodies, total = system.surfaces.bodies, 0.0
    for s in range(len(bodies.flexible)):
        if bodies.flexible[s] != e:
            continue
        for k in range(bodies.node[s], bodies.node[s + 1]):
            along = dot(line, row(system.surfaces.patches.X, k))
            total += along * dot(line, row(state.surfaces.load, k))
    return total
