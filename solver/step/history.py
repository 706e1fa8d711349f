"""The convolution of interface loads with impulse responses, step by step, in three exact forms.

    recursive: the modes carry the history; a step costs the number of modes
    direct:    the sum over all past loads; a step costs its own number
    fft:       that sum over the present block of steps; `u_ahead` holds the effect of earlier ones
               (solver/history/dyadic.py)

All give u_{n+1} = history + weight G_0 p_{n+1}, with history complete before p_{n+1} is known.
`weight` is 1 for the consistent rule and 1/2 for eq. (55) of the paper, which convolves the mean of
p_n and p_{n+1}.
"""

from ..arrays import Array
from ..compiler.marks import compiled, entry
from ..compiler.memory import copy
from ..compiler.parts import largest_part
from .chains import chain_energy, hold_chains, stretch_chains
from .records.elastic import Elastic
from .records.scheme import Scheme
from .second_order import add_curvatures, hardening_energy
from .surface_motion import load_modes
from .system import State, System, Workspace
from .vectors import inner


@entry
def start_history(elastic: Elastic, scheme: Scheme, state: State, work: Workspace) -> None:
    """Start step n + 1: `history` (n_u,), the displacements by past loads alone."""
    _free_response(elastic, scheme, state, work)
    history = work.interfaces.history
    n = state.step[0] + 1
    for e in range(len(elastic.body)):
        if elastic.modes.range[e] < elastic.modes.range[e + 1]:
            # Modes carry the whole past; without them the kernel is convolved with all loads.
            _sum_modes(elastic, e, state.modes.eta, history)
        else:
            _convolve(elastic, e, n, state, history)
        if scheme.weight != 1.0:
            # eq. (55) convolves means of two steps, so that half of the last load acts now.
            _add_instantaneous(elastic, e, 1.0 - scheme.weight, state.interfaces.p, history)


@entry
def finish_history(system: System, state: State, work: Workspace) -> None:
    """End step n + 1: displacements at all dofs, and the loads p_{n+1} taken in."""
    elastic, scheme = system.elastic, system.scheme
    weight, p, p_n = scheme.weight, state.interfaces.p, work.interfaces.p_n
    modes, past = elastic.modes, state.past
    copy(work.interfaces.history, state.interfaces.u)
    work.modes.load[:] = 0.0
    for e in range(len(elastic.body)):
        _add_instantaneous(elastic, e, weight, p, state.interfaces.u)
        first = elastic.dof[e]
        begin, end = modes.range[e], modes.range[e + 1]
        for c in range(elastic.loaded_range[e], elastic.loaded_range[e + 1]):
            k = elastic.loaded[c]
            load = weight * p[k] + (1.0 - weight) * p_n[k]
            if begin == end:
                # Less the load of an equilibrium at the start, whose displacements are in u_rest.
                past.p[k, state.step[0] + 1 - past.first[0]] = load - past.p_rest[k]
            start = modes.phi_start[e] + (k - first) * (end - begin)
            phi, forces = modes.phi[start : start + end - begin], work.modes.load[begin:end]
            for i in range(len(forces)):
                forces[i] += phi[i] * load
    add_curvatures(elastic, state, work)
    load_modes(system, state, work)
    _forced_response(elastic, scheme, state, work)
    if len(modes.chains.body):
        state.energies.damping[0] += stretch_chains(elastic, state, work)
    if modes.damped:
        state.energies.damping[0] += scheme.h * _damping_power(elastic, state, work)


NEGLIGIBLE_AMPLITUDE = 1e-140
"""modal amplitude that counts as none; its square, 1e-280, is still a normal number"""
STEPS_BETWEEN_FLUSHES = 16
"""steps between searches for such amplitudes, which makes their cost negligible"""


@compiled
def _damping_power(elastic: Elastic, state: State, work: Workspace) -> float:
    """2 zeta omega eta'^2 of all modes, with the mean of their rates over the step.

    At rho_inf = 1 the scheme takes no other energy from them.
    """
    damping, rate, rate_n = elastic.modes.damping, state.modes.rate, work.modes.rate_n
    total = 0.0
    for i in range(len(rate)):
        mean = 0.5 * (rate[i] + rate_n[i])
        total += damping[i] * mean * mean
    return total


@compiled
def modal_energy(elastic: Elastic, state: State) -> float:
    """Kinetic and strain energy of all modes, 1/2 (eta'^2 + omega^2 eta^2), of chains, and W."""
    modes, total = state.modes, 0.0
    for i in range(len(modes.eta)):
        total += modes.rate[i] ** 2 + elastic.modes.stiffness[i] * modes.eta[i] ** 2
    total = 0.5 * total + chain_energy(elastic, state)
    for e in range(len(elastic.body)):
        total += hardening_energy(elastic, e, state.interfaces.u)
    return total


@compiled
def _add_instantaneous(elastic: Elastic, e: int, weight: float, p: Array, u: Array) -> None:
    """u += weight G_0 p on the dofs of body e."""
    first, last = elastic.dof[e], elastic.dof[e + 1]
    n_c = last - first
    mostly_loaded = 2 * (elastic.loaded_range[e + 1] - elastic.loaded_range[e]) > n_c
    for i in range(first, last):
        start = elastic.G_0_start[e] + (i - first) * n_c - first
        if mostly_loaded:  # p is zero elsewhere, and products of whole rows are quick
            u[i] += weight * inner(elastic.G_0[start + first : start + last], p[first:last])
            continue
        for c in range(elastic.loaded_range[e], elastic.loaded_range[e + 1]):
            k = elastic.loaded[c]
            u[i] += weight * elastic.G_0[start + k] * p[k]


@compiled
def _free_response(elastic: Elastic, scheme: Scheme, state: State, work: Workspace) -> None:
    """Advance all modes by one step without load."""
    h, beta, gamma, ratio = scheme.h, scheme.beta, scheme.gamma, scheme.inertia_ratio
    kept, lost = scheme.alpha_m / (1.0 - scheme.alpha_f), scheme.alpha_f / (1.0 - scheme.alpha_f)
    data, modes, a = elastic.modes, state.modes, work.modes.a
    copy(modes.rate, work.modes.rate_n)
    # one array written in each loop, and few read, lets the compiler use vector instructions
    for i in range(len(a)):
        eta = modes.eta[i] + h * modes.rate[i] + h * h * (0.5 - beta) * modes.a[i]
        rate = modes.rate[i] + h * (1.0 - gamma) * modes.a[i]
        carried = kept * modes.a[i] - lost * modes.acceleration[i]
        force = data.stiffness[i] * eta + data.damping[i] * rate + carried
        a[i] = -force / data.step_stiffness[i]
    if len(data.chains.body):
        copy(modes.eta, work.modes.eta_n)
        hold_chains(elastic, scheme, state, work)
    for i in range(len(a)):
        mean = (0.5 - beta) * modes.a[i] + beta * a[i]
        modes.eta[i] += h * modes.rate[i] + h * h * mean
    for i in range(len(a)):
        modes.rate[i] += h * ((1.0 - gamma) * modes.a[i] + gamma * a[i])
    for i in range(len(a)):
        before = kept * modes.a[i] - lost * modes.acceleration[i]
        modes.acceleration[i] = ratio * a[i] + before
    copy(a, modes.a)
    _forget_inertia(elastic, state)
    for w in range(len(data.quasi_static)):
        # They have no motion of their own, but the springs of a chain relax.
        if data.chains.hardening[data.quasi_static[w]] == 0.0:
            modes.eta[data.quasi_static[w]] = 0.0


@compiled
def _forced_response(elastic: Elastic, scheme: Scheme, state: State, work: Workspace) -> None:
    """Add to the free response of all modes that to the loads at the end of the step."""
    modes, change, ratio = state.modes, work.modes.load, scheme.inertia_ratio
    displacement, velocity = scheme.beta * scheme.h * scheme.h, scheme.gamma * scheme.h
    for i in range(len(change)):
        change[i] /= elastic.modes.step_stiffness[i]
    for i in range(len(change)):
        modes.eta[i] += displacement * change[i]
    for i in range(len(change)):
        modes.rate[i] += velocity * change[i]
    for i in range(len(change)):
        modes.acceleration[i] += ratio * change[i]
    for i in range(len(change)):
        modes.a[i] += change[i]
    _forget_inertia(elastic, state)


@compiled
def _forget_inertia(elastic: Elastic, state: State) -> None:
    """Quasi-static modes have displacements, load over stiffness, and no rates."""
    for w in range(len(elastic.modes.quasi_static)):
        i = elastic.modes.quasi_static[w]
        state.modes.rate[i], state.modes.acceleration[i], state.modes.a[i] = 0.0, 0.0, 0.0


@compiled
def flush_denormals(state: State) -> None:
    """Modes that time stepping has damped out come to rest: below some 1e-308, where they would go
    on to, arithmetic takes a hundred times as long.
    """
    if state.step[0] % STEPS_BETWEEN_FLUSHES == 0:
        modes = state.modes
        _flush(modes.eta)
        _flush(modes.rate)
        _flush(modes.acceleration)
        _flush(modes.a)
        _flush(modes.stretch)


@compiled
def _flush(values: Array) -> None:
    for i in range(len(values)):
        values[i] = values[i] if largest_part(values[i]) > NEGLIGIBLE_AMPLITUDE else 0.0


@compiled
def _sum_modes(elastic: Elastic, e: int, eta: Array, out: Array) -> None:
    """out = phi eta on the dofs of body e"""
    modes = elastic.modes
    first, last = elastic.dof[e], elastic.dof[e + 1]
    begin, end = modes.range[e], modes.range[e + 1]
    m = end - begin
    for c in range(last - first):
        start = modes.phi_start[e] + c * m
        out[first + c] = inner(modes.phi[start : start + m], eta[begin:end])


@compiled
def _convolve(elastic: Elastic, e: int, n: int, state: State, out: Array) -> None:
    """out = g_initial[n] p_0 + sum_{j=1..n-1} g[n-j] p_j + u_rest, on the dofs of body e."""
    past, kernels = state.past, elastic.kernels
    first, last = elastic.dof[e], elastic.dof[e + 1]
    n_c, lags, start = last - first, kernels.lags[e], kernels.g_start[e]
    n_0 = past.first[0]
    # A kernel that was cut off has no effect of older loads.
    since = max(past.since[e], n - lags + 1)
    for i in range(n_c):
        total = past.u_rest[first + i] + past.u_ahead[first + i, n - n_0]
        for c in range(elastic.loaded_range[e], elastic.loaded_range[e + 1]):
            k = elastic.loaded[c]
            # The load at t = 0 has a kernel of its own: the scheme starts from consistent
            # accelerations.
            if n < lags:
                initial = start + (n * n_c + i) * n_c + k - first
                total += kernels.g_initial[initial] * past.p_start[k]
            end = start + (i * n_c + k - first + 1) * lags
            g = kernels.g[end - 1 - n + since : end - 1]
            total += inner(g, past.p[k, since - n_0 : n - n_0])
        out[first + i] = total
