"""Time stepping of modes, one scalar equation each, for kernels and recovered fields."""

from collections.abc import Iterable, Iterator
from itertools import repeat

import numpy as np

from ..files.arrays import Array
from .chain import Springs
from .modes import Modes
from .scheme import GeneralizedAlpha


def respond(
    modes: Modes,
    h: float | Array,
    scheme: GeneralizedAlpha,
    loads: Iterable[Array | float],
    eta: Array | float = 0.0,
    acceleration: Array | float = 0.0,
) -> Iterator[Array]:
    """Modal coordinates (m,) after 0, 1, 2, ... steps of generalized-alpha.

        eta'' + 2 zeta omega eta' + omega^2 (eta + sum_k a_k q_k) = f

    loads: f (m,), or one number for all modes, at the end of each step; there are as many steps.
    The start is without velocity, at `eta` and with `acceleration` (m,). h: of all steps, or of
    each of them (n,). Source: docs/theory.md, Impulse responses, Two step sizes.
    """
    return (eta for eta, _ in stressed(modes, h, scheme, loads, eta, acceleration))


def stressed(
    modes: Modes,
    h: float | Array,
    scheme: GeneralizedAlpha,
    loads: Iterable[Array | float],
    eta: Array | float = 0.0,
    acceleration: Array | float = 0.0,
) -> Iterator[tuple[Array, Array]]:
    """The same, with what stresses follow: eta + sum_k a_k q_k (m,) of a chain, else eta itself."""
    stiffness, damping = modes.omega**2, 2.0 * modes.zeta * modes.omega
    alpha_m, alpha_f, beta, gamma = scheme.alpha_m, scheme.alpha_f, scheme.beta, scheme.gamma
    inertia, springs = scheme.inertia_ratio, Springs(modes.chain, len(modes.omega))
    rest = np.zeros_like(modes.omega)
    eta, rate, acceleration = rest + eta, rest, rest + acceleration
    a, last = acceleration, 0.0
    yield eta, eta
    steps: Iterable[float] = h.tolist() if isinstance(h, np.ndarray) else repeat(h)
    for load, step in zip(loads, steps, strict=False):
        if step != last:
            springs.set_step(step)
            stepped = (1.0 + springs.hardening) * stiffness
            step_stiffness = inertia + gamma * step * damping + beta * step * step * stepped
            a = acceleration * inertia / step_stiffness if last else a
            last = step
        before, pull = eta, stiffness * springs.carried(eta)
        eta = eta + step * rate + step * step * (0.5 - beta) * a
        rate = rate + step * (1 - gamma) * a
        carried = (alpha_m * a - alpha_f * acceleration) / (1 - alpha_f)
        a = (load - stepped * eta - pull - damping * rate - carried) / step_stiffness
        acceleration = inertia * a + carried
        eta = eta + beta * step * step * a
        rate = rate + gamma * step * a
        springs.follow(eta - before)
        yield eta, springs.stress(eta)
