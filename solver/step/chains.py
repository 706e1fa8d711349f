"""Maxwell elements beside the stiffness of modes, which take energy as a material does.

    eta'' + 2 zeta omega eta' + omega^2 (eta + sum_k a_k q_k) = f,    q_k' + q_k / tau_k = eta'

by the trapezoidal rule, q+ = kept q + gain (eta+ - eta): in a step a spring loses exactly
omega^2 a (h / tau) ((q + q+) / 2)^2. Source: docs/theory.md, Material damping.
"""

from ..arrays import Array
from ..compiler.marks import compiled
from .records.elastic import Elastic
from .records.scheme import Scheme
from .system import State, Workspace


@compiled
def hold_chains(elastic: Elastic, scheme: Scheme, state: State, work: Workspace) -> None:
    """Let the springs hold back the free response `work.modes.a` of a step from `state`."""
    h, beta, data, modes = scheme.h, scheme.beta, elastic.modes, state.modes
    chains = data.chains
    for c in range(len(chains.body)):
        e = chains.body[c]
        begin, m = data.range[e], data.range[e + 1] - data.range[e]
        stress = work.modes.load[begin : begin + m]
        for i in range(m):
            # The part of the step that does not depend on the new acceleration; the rest is in
            # step_stiffness.
            move = h * modes.rate[begin + i] + h * h * (0.5 - beta) * modes.a[begin + i]
            stress[i] = chains.hardening[begin + i] * move
        for k in range(chains.element[c], chains.element[c + 1]):
            first = chains.spring[c] + (k - chains.element[c]) * m
            _add_product(
                chains.kept[k],
                chains.amplitude[first : first + m],
                modes.stretch[first : first + m],
                stress,
            )
        for i in range(m):
            force = data.stiffness[begin + i] * stress[i]
            work.modes.a[begin + i] -= force / data.step_stiffness[begin + i]


@compiled
def _add_product(factor: float, x: Array, y: Array, out: Array) -> None:
    for i in range(len(out)):
        out[i] += factor * x[i] * y[i]


@compiled
def stretch_chains(elastic: Elastic, state: State, work: Workspace) -> float:
    """Stretch the springs as the modes have moved in the step: the energy that they lose."""
    data, modes, total = elastic.modes, state.modes, 0.0
    chains = data.chains
    for c in range(len(chains.body)):
        e = chains.body[c]
        begin, m = data.range[e], data.range[e + 1] - data.range[e]
        moved = work.modes.eta_change[begin : begin + m]
        for i in range(m):
            moved[i] = modes.eta[begin + i] - work.modes.eta_n[begin + i]
        for k in range(chains.element[c], chains.element[c + 1]):
            first = chains.spring[c] + (k - chains.element[c]) * m
            amplitude = chains.amplitude[first : first + m]
            stretch = modes.stretch[first : first + m]
            stiffness = data.stiffness[begin : begin + m]
            kept, gain, lost = chains.kept[k], chains.gain[k], 0.0
            for i in range(m):
                after = kept * stretch[i] + gain * moved[i]
                # The mean of the trapezoidal rule makes the loss exact, so that the energy balance
                # closes.
                mean = 0.5 * (stretch[i] + after)
                lost += stiffness[i] * amplitude[i] * mean * mean
                stretch[i] = after
            total += chains.lost[k] * lost
    return total


@compiled
def chain_energy(elastic: Elastic, state: State) -> float:
    """Strain energy of the springs, omega^2 a q^2 / 2."""
    data, total = elastic.modes, 0.0
    chains = data.chains
    for c in range(len(chains.body)):
        e = chains.body[c]
        begin, m = data.range[e], data.range[e + 1] - data.range[e]
        for k in range(chains.element[c], chains.element[c + 1]):
            first = chains.spring[c] + (k - chains.element[c]) * m
            for i in range(m):
                stretch = state.modes.stretch[first + i]
                stiffness = data.stiffness[begin + i] * chains.amplitude[first + i]
                total += 0.5 * stiffness * stretch * stretch
    return total
