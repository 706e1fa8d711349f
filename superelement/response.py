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
    """Step the modes in time by generalized-alpha.

        eta'' + 2 zeta omega eta' + omega^2 (eta + sum_k a_k q_k) = f

    The modes start without velocity.

    Parameters
    ----------
    modes : Modes
    h : float or (n,) [s]
        The time step, of all steps or of each of them.
    scheme : GeneralizedAlpha
    loads : iterable of (m,) or float
        f at the end of each step, or one number for all modes; as many steps are made.
    eta, acceleration : (m,) or float
        At the start.

    Yields
    ------
    (m,)
        Modal coordinates after 0, 1, 2, ... steps. Source: docs/theory.md, Impulse responses, Two
        step sizes.

    Examples
    --------
    A constant load on a damped mode, which comes to rest at f / omega^2:

    >>> import numpy as np
    >>> from duhamel.superelement import GeneralizedAlpha, Modes
    >>> modes = Modes(omega=np.array([100.0]), zeta=np.array([0.5]), phi=np.array([[1.0]]))
    >>> *_, last = respond(modes, 1e-3, GeneralizedAlpha(), [2e4] * 1000)
    >>> last.round(9).tolist()
    [2.0]
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
    """Step the modes in time, and yield what stresses follow as well.

    As `respond`, whose parameters it has; each step yields eta (m,) and eta + sum_k a_k q_k (m,),
    which is eta itself without a chain: stresses are the relaxed stiffness times the latter.

    Examples
    --------
    >>> import numpy as np
    >>> from duhamel.superelement import GeneralizedAlpha, Modes
    >>> modes = Modes(omega=np.array([100.0]), zeta=np.array([0.5]), phi=np.array([[1.0]]))
    >>> for eta, stress in stressed(modes, 1e-3, GeneralizedAlpha(), [0.0], eta=1.0):
    ...     assert eta is stress
    """
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
        # Maxwell springs act like added stiffness on the change of eta, and like a load by their
        # past.
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
