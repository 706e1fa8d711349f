"""Time stepping of modes, one scalar equation each, for kernels and recovered fields."""

from collections.abc import Iterable, Iterator

import numpy as np

from .modes import Modes
from .scheme import GeneralizedAlpha
from .validation import Array


def respond(
    modes: Modes,
    h: float,
    scheme: GeneralizedAlpha,
    loads: Iterable[Array | float],
    eta: Array | float = 0.0,
    acceleration: Array | float = 0.0,
) -> Iterator[Array]:
    """Modal coordinates (m,) after 0, 1, 2, ... steps of generalized-alpha.

        eta'' + 2 zeta omega eta' + omega^2 eta = q

    loads: q (m,), or one number for all modes, at the end of each step; there are as many steps.
    The start is without velocity, at `eta` and with `acceleration` (m,). Source: docs/theory.md,
    Impulse responses.
    """
    stiffness, damping = modes.omega**2, 2.0 * modes.zeta * modes.omega
    alpha_m, alpha_f, beta, gamma = scheme.alpha_m, scheme.alpha_f, scheme.beta, scheme.gamma
    inertia = scheme.inertia_ratio
    step_stiffness = inertia + gamma * h * damping + beta * h * h * stiffness

    rest = np.zeros_like(modes.omega)
    eta, rate, acceleration = rest + eta, rest, rest + acceleration
    a = acceleration
    yield eta
    for load in loads:
        eta = eta + h * rate + h * h * (0.5 - beta) * a
        rate = rate + h * (1 - gamma) * a
        carried = (alpha_m * a - alpha_f * acceleration) / (1 - alpha_f)
        a = (load - stiffness * eta - damping * rate - carried) / step_stiffness
        acceleration = inertia * a + carried
        eta = eta + beta * h * h * a
        rate = rate + gamma * h * a
        yield eta
