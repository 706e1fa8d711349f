"""The convolution of interface loads with impulse responses, one step at a time, in three exact
forms.

    recursive: the modes carry the history; a step costs the number of modes
    direct:    the sum over all past loads; a step costs its own number
    fft:       that sum over the present block of steps; `ahead` holds what earlier ones do (lookahead.py)

Both give u_{n+1} = history + weight G_0 p_{n+1}, with history complete before p_{n+1} is known.
`weight` is 1 for the consistent rule and 1/2 for eq. (55) of the paper, which convolves the mean of
p_n and p_{n+1}.
"""

from ..arrays import Array
from .jit import compiled
from .system import Elastic, Scheme, State
from .vectors import copy, inner


@compiled
def recall(elastic: Elastic, scheme: Scheme, state: State, history: Array, modal: Array) -> None:
    """Start step n + 1: `history` (n_u,), the displacements that past loads alone would give."""
    _coast(elastic, scheme, state, modal)
    n = state.step[0] + 1
    for e in range(len(elastic.body)):
        first, last = elastic.dof[e], elastic.dof[e + 1]
        if elastic.mode_range[e] < elastic.mode_range[e + 1]:
            _sum_modes(elastic, e, state.eta, history)
        else:
            _convolve(elastic, e, n, state, history)
        if scheme.weight != 1.0:
            for i in range(first, last):
                for c in range(elastic.active_range[e], elastic.active_range[e + 1]):
                    k = elastic.active[c]
                    history[i] += (
                        (1.0 - scheme.weight)
                        * instantaneous(elastic, e, i - first, k - first)
                        * state.p[k]
                    )


@compiled
def remember(elastic: Elastic, scheme: Scheme, state: State, p_n: Array, modal: Array) -> None:
    """End step n + 1: take in the loads p_{n+1} = state.p, given p_n before; `modal`: room for
    (n_modes,).
    """
    weight = scheme.weight
    modal[:] = 0.0
    for e in range(len(elastic.body)):
        first = elastic.dof[e]
        begin, end = elastic.mode_range[e], elastic.mode_range[e + 1]
        for c in range(elastic.active_range[e], elastic.active_range[e + 1]):
            k = elastic.active[c]
            load = weight * state.p[k] + (1.0 - weight) * p_n[k]
            if begin == end:
                state.p_history[k, state.step[0] + 1 - state.window[0]] = load - state.p_rest[k]
            start = elastic.phi_start[e] + (k - first) * (end - begin)
            phi, forces = elastic.phi[start : start + end - begin], modal[begin:end]
            for i in range(len(forces)):
                forces[i] += phi[i] * load
    _push(elastic, scheme, state, modal)


@compiled
def instantaneous(elastic: Elastic, e: int, i: int, j: int) -> float:
    """Entry (i, j) of G_0 of flexible body e."""
    n_c = elastic.dof[e + 1] - elastic.dof[e]
    return float(elastic.G_0[elastic.G_0_start[e] + i * n_c + j])


@compiled
def respond(elastic: Elastic, scheme: Scheme, history: Array, p: Array, u: Array) -> None:
    """u = history + weight G_0 p at all interface dofs."""
    for e in range(len(elastic.body)):
        first = elastic.dof[e]
        for i in range(first, elastic.dof[e + 1]):
            u[i] = history[i]
            for c in range(elastic.active_range[e], elastic.active_range[e + 1]):
                k = elastic.active[c]
                u[i] += scheme.weight * instantaneous(elastic, e, i - first, k - first) * p[k]


@compiled
def modal_energy(elastic: Elastic, state: State) -> float:
    """Kinetic and strain energy of all modes, 1/2 (eta'^2 + omega^2 eta^2)."""
    total = 0.0
    for i in range(len(elastic.stiffness)):
        total += state.eta_rate[i] ** 2 + elastic.stiffness[i] * state.eta[i] ** 2
    return 0.5 * total


@compiled
def _coast(elastic: Elastic, scheme: Scheme, state: State, change: Array) -> None:
    """Advance all modes by one step without load; `change`: room for their new a."""
    h, alpha_m, alpha_f, beta, gamma = (
        scheme.h,
        scheme.alpha_m,
        scheme.alpha_f,
        scheme.beta,
        scheme.gamma,
    )
    kept, lost = alpha_m / (1.0 - alpha_f), alpha_f / (1.0 - alpha_f)
    ratio = (1.0 - alpha_m) / (1.0 - alpha_f)
    # one array written in each loop, and few read, lets the compiler use vector instructions
    for i in range(len(change)):
        a = state.eta_a[i]
        eta = state.eta[i] + h * state.eta_rate[i] + h * h * (0.5 - beta) * a
        rate = state.eta_rate[i] + h * (1.0 - gamma) * a
        carried = kept * a - lost * state.eta_acceleration[i]
        change[i] = (
            -(elastic.stiffness[i] * eta + elastic.damping[i] * rate + carried) / elastic.pivot[i]
        )
    for i in range(len(change)):
        state.eta[i] += h * state.eta_rate[i] + h * h * (
            (0.5 - beta) * state.eta_a[i] + beta * change[i]
        )
    for i in range(len(change)):
        state.eta_rate[i] += h * ((1.0 - gamma) * state.eta_a[i] + gamma * change[i])
    for i in range(len(change)):
        state.eta_acceleration[i] = (
            ratio * change[i] + kept * state.eta_a[i] - lost * state.eta_acceleration[i]
        )
    copy(change, state.eta_a)


@compiled
def _push(elastic: Elastic, scheme: Scheme, state: State, change: Array) -> None:
    """Add the effect of modal loads `change`, acting at the end of the step, to the modes that have
    coasted.
    """
    h = scheme.h
    ratio = (1.0 - scheme.alpha_m) / (1.0 - scheme.alpha_f)
    displacement, velocity = scheme.beta * h * h, scheme.gamma * h
    for i in range(len(change)):
        change[i] /= elastic.pivot[i]
    for i in range(len(change)):
        state.eta[i] += displacement * change[i]
    for i in range(len(change)):
        state.eta_rate[i] += velocity * change[i]
    for i in range(len(change)):
        state.eta_acceleration[i] += ratio * change[i]
    for i in range(len(change)):
        state.eta_a[i] += change[i]


@compiled
def _sum_modes(elastic: Elastic, e: int, eta: Array, out: Array) -> None:
    """out = phi eta on the dofs of body e"""
    first, last = elastic.dof[e], elastic.dof[e + 1]
    begin, end = elastic.mode_range[e], elastic.mode_range[e + 1]
    m = end - begin
    for c in range(last - first):
        start = elastic.phi_start[e] + c * m
        phi, own = elastic.phi[start : start + m], eta[begin:end]
        out[first + c] = inner(phi, own)


@compiled
def _convolve(elastic: Elastic, e: int, n: int, state: State, out: Array) -> None:
    """out = g_initial[n] p_0 + sum_{j=1..n-1} g[n-j] p_j + what loads at rest do, on the dofs of
    body e
    """
    first, last = elastic.dof[e], elastic.dof[e + 1]
    n_c, lags, start = last - first, elastic.lags[e], elastic.g_start[e]
    n_0 = state.window[0]
    since = max(state.since[e], n - lags + 1)
    for i in range(n_c):
        total = state.history_rest[first + i] + state.ahead[first + i, n - n_0]
        for c in range(elastic.active_range[e], elastic.active_range[e + 1]):
            k = elastic.active[c]
            if n < lags:
                total += (
                    elastic.g_initial[start + (n * n_c + i) * n_c + k - first] * state.p_start[k]
                )
            end = start + (i * n_c + k - first + 1) * lags
            total += inner(
                elastic.g[end - 1 - n + since : end - 1], state.p_history[k, since - n_0 : n - n_0]
            )
        out[first + i] = total
