"""Elastic displacements of interfaces: their steps, compatibility, tangent and energy.

    r_u = history + w G_0 p - u = 0 at the active dofs;   w: 1, or 1/2 in eq. (55)

In Newton's matrix the rows of u are those of the forces p that load it, times -w G_0, and I.
Source: docs/theory.md, Impulse responses and The time step.
"""

from ..compiler.marks import compiled
from ..compiler.memory import copy
from .measure import SUM_ROUNDING, relative
from .newmark import (
    end_pseudo_acceleration,
    free_pseudo_acceleration,
    predicted_change,
    predicted_rate,
)
from .records.elastic import Elastic
from .records.matrix import Pattern
from .records.scheme import Scheme
from .second_order import hardening_energy
from .system import State, System, Workspace
from .vectors import inner


@compiled
def predict_interfaces(scheme: Scheme, state: State, work: Workspace) -> None:
    """Displacements and rates at the end of the step with the accelerations of its start."""
    motion, predicted = state.interfaces, work.interfaces
    copy(motion.u, predicted.u_n)
    copy(motion.p, predicted.p_n)
    copy(motion.rate, predicted.rate_n)
    for k in range(len(motion.u)):
        a_n = motion.a[k]
        a = free_pseudo_acceleration(scheme, motion.acceleration[k], a_n)
        change = predicted_change(scheme, motion.rate[k], a_n, a)
        predicted.u_predicted[k] = motion.u[k] + change
        predicted.rate_predicted[k] = predicted_rate(scheme, motion.rate[k], a_n, a)
        motion.a[k] = a
        # With the acceleration of the start, as of bodies: nearer to a smooth motion than without.
        motion.u[k] = predicted.u_predicted[k] + motion.acceleration[k] / scheme.beta_prime


@compiled
def set_rates(elastic: Elastic, scheme: Scheme, state: State, work: Workspace) -> None:
    """Rates and accelerations of active dofs by Newmark's formulas, as those of the bodies."""
    for i in range(len(elastic.active)):
        _set_rate(elastic.active[i], scheme, state, work)


@compiled
def _set_rate(k: int, scheme: Scheme, state: State, work: Workspace) -> None:
    """Rate and acceleration of dof k from its distance to the prediction."""
    motion, predicted = state.interfaces, work.interfaces
    change = motion.u[k] - predicted.u_predicted[k]
    motion.rate[k] = predicted.rate_predicted[k] + scheme.gamma_prime * change
    motion.acceleration[k] = scheme.beta_prime * change


@compiled
def finish_interfaces(scheme: Scheme, state: State, work: Workspace) -> None:
    """Rates and accelerations of all dofs that belong to their displacements."""
    motion = state.interfaces
    # Those of dofs that are not active have not been needed so far.
    for k in range(len(motion.u)):
        _set_rate(k, scheme, state, work)
        motion.a[k] = end_pseudo_acceleration(scheme, motion.a[k], motion.acceleration[k])


@compiled
def set_compatibility(elastic: Elastic, state: State, work: Workspace) -> None:
    """residual = history + w G_0 p - u at the active dofs."""
    u, p = state.interfaces.u, work.interfaces.p_active
    for i in range(len(p)):
        p[i] = state.interfaces.p[elastic.active[i]]
    if len(work.surfaces.near):
        for i in range(len(p)):
            p[i] += work.surfaces.interface_load[i]
    for e in range(len(elastic.body)):
        begin, end = elastic.active_range[e], elastic.active_range[e + 1]
        entry = elastic.G_active_start[e]
        for i in range(begin, end):
            k = elastic.active[i]
            by_loads = inner(elastic.G_active[entry : entry + end - begin], p[begin:end])
            work.interfaces.residual[i] = work.interfaces.history[k] + by_loads - u[k]
            entry += end - begin


@compiled
def weigh_forces(system: System, work: Workspace) -> None:
    """[K, B^T / h^2] times -h^2 in the rows of rigid coordinates, -w G_0 in those of active dofs.

    I on u besides.
    """
    elastic, pattern = system.elastic, system.pattern
    S, forces = work.matrix.S, work.matrix.force_rows
    h2 = system.scheme.h * system.scheme.h
    for m in range(len(pattern.force_block)):
        b, start = pattern.force_block[m, 0], pattern.force_block[m, 1]
        stride, width = pattern.force_block[m, 2], pattern.force_block[m, 3]
        for i in range(6):
            for j in range(width):
                S[start + i * stride + j] *= -h2
        e = elastic.of_body[b]
        if e < 0:
            continue
        n = elastic.active_range[e + 1] - elastic.active_range[e]
        for i in range(n):
            target = start + (6 + i) * stride
            for j in range(width):
                # A copy, since the product with G_0 overwrites the rows that it reads.
                forces[i * width + j] = S[target + j]
                S[target + j] = 0.0
        for i in range(n):
            target = start + (6 + i) * stride
            for k in range(n):
                G = elastic.G_active[elastic.G_active_start[e] + i * n + k]
                if G != 0.0:  # directions that do not interact are frequent
                    for j in range(width):
                        S[target + j] -= G * forces[k * width + j]
    for b in range(len(pattern.body)):
        start, stride = pattern.body_block[b, 0], pattern.body_block[b, 1]
        for i in range(6, pattern.size[pattern.body[b]]):
            S[start + i * (stride + 1)] += 1.0


@compiled
def set_interface_rhs(elastic: Elastic, pattern: Pattern, work: Workspace) -> None:
    for e in range(len(elastic.body)):
        begin = elastic.active_range[e]
        first = pattern.first[pattern.body[elastic.body[e]]] + 6 - begin
        for i in range(begin, elastic.active_range[e + 1]):
            work.matrix.rhs[first + i] = work.interfaces.residual[i]


@compiled
def move_interfaces(elastic: Elastic, pattern: Pattern, state: State, work: Workspace) -> None:
    """Apply the corrections of the displacements."""
    for e in range(len(elastic.body)):
        begin = elastic.active_range[e]
        first = pattern.first[pattern.body[elastic.body[e]]] + 6 - begin
        for i in range(begin, elastic.active_range[e + 1]):
            state.interfaces.u[elastic.active[i]] += work.matrix.rhs[first + i]


@compiled
def relative_interface_residual(
    system: System, motion: float, reach: float, work: Workspace
) -> float:
    """The largest residual over the largest motion of the step."""
    residual, tolerance = work.interfaces.residual, system.newton.tolerance
    length, worst = system.elastic.length, 0.0
    for i in range(len(residual)):
        found = length[i] * residual[i]
        worst = max(worst, relative(found, motion, SUM_ROUNDING * reach, tolerance))
    return worst


@compiled
def add_elastic_work(elastic: Elastic, state: State, work: Workspace) -> None:
    """The work of the loads, p . dy, with their mean over the step; y: u less 1/2 A(q, q)."""
    u, p = state.interfaces.u, state.interfaces.p
    u_n, p_n = work.interfaces.u_n, work.interfaces.p_n
    for e in range(len(elastic.body)):
        total = 0.0
        for i in range(elastic.loaded_range[e], elastic.loaded_range[e + 1]):
            k = elastic.loaded[i]
            total += 0.5 * (p[k] + p_n[k]) * (u[k] - u_n[k] - work.second.bend[k])
        if elastic.modes.range[e] < elastic.modes.range[e + 1]:
            state.energies.modal[0] += total
            state.energies.modal[0] += hardening_energy(elastic, e, state.interfaces.u)
            state.energies.modal[0] -= hardening_energy(elastic, e, work.interfaces.u_n)
        else:
            state.energies.convolved[0] += total
