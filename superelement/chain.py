"""Maxwell elements beside the stiffness of a body: a material that loses energy."""

from dataclasses import dataclass

import numpy as np

from ..files.arrays import Array
from ..files.arrays import Complex as Complex
from .validation import SuperelementError, checked

# Beyond this ratio of glassy to relaxed stiffness nothing is left of the relaxed body.
MAX_AMPLITUDE_SUM = 1e6
LARGEST_LOSS = 1.0
"""factor that a chain is made for"""


@dataclass(frozen=True, eq=False)
class Chain:
    """Maxwell elements in parallel with the stiffness of every mode.

        omega^2 becomes omega^2 (1 + sum_k a_k i w tau_k / (1 + i w tau_k))
        eta'' + ... + omega^2 (eta + sum_k a_k q_k) = phi . p,    q_k' + q_k / tau_k = eta'

    omega is then that of the relaxed body, which static loads see; q_k are the stretches of the
    springs of the chain. Source: docs/theory.md, Material damping.

    Parameters
    ----------
    tau : (K,) [s]
        Relaxation times, ascending.
    amplitude : (K,) or (K, m)
        The a_k of all modes, or of each mode.
    loss_factor : float
        What the amplitudes were fitted to in `band`; 0 where modes have different loss factors.
    band : (2,) [Hz]
        Where the loss factor holds within the relative `ripple`.
    reference : float [Hz]
        The frequency at which the stiffness is that of the body file; 0 for the static one.
    ripple : float
        The largest relative deviation from `loss_factor` in the band.

    Raises
    ------
    SuperelementError
        For times that do not increase, and amplitudes that are negative or too large.

    Examples
    --------
    A standard linear solid, whose stiffness rises by 50 % with frequency:

    >>> import numpy as np
    >>> chain = Chain(tau=np.array([1e-3]), amplitude=np.array([0.5]))
    >>> chain.factor(np.array([0.0, 1e9]), m=1).real.round(6).ravel().tolist()
    [1.0, 1.5]
    """

    tau: Array
    amplitude: Array
    loss_factor: float = 0.0
    band: tuple[float, float] = (0.0, 0.0)
    reference: float = 0.0
    ripple: float = 0.0

    def __post_init__(self) -> None:
        tau = checked("chain: tau", self.tau, ("k",))
        # One amplitude for all modes, or one for each of them.
        shape = (len(tau), "m")[: max(1, np.ndim(self.amplitude))]
        a = checked("chain: amplitude", self.amplitude, shape)
        if not len(tau) or tau[0] <= 0.0 or (np.diff(tau) <= 0.0).any():
            raise SuperelementError(
                f"chain: tau: expected positive times that increase, found {tau.tolist()}"
            )
        if a.min(initial=0.0) < 0.0 or a.sum(axis=0).max(initial=0.0) > MAX_AMPLITUDE_SUM:
            raise SuperelementError(
                f"chain: amplitude: expected numbers >= 0 that add up to {MAX_AMPLITUDE_SUM:g} at "
                "most, "
                f"found {a.min():.6g} to {a.max():.6g}"
            )
        object.__setattr__(self, "tau", tau)
        object.__setattr__(self, "amplitude", a)

    @property
    def given_moduli(self) -> str:
        """By how much static moduli are lower than given ones, in words; "" for moduli at rest."""
        if self.reference == 0.0:
            return ""
        m = self.amplitude.shape[1] if self.amplitude.ndim == 2 else 1
        stiffer = self.factor(np.array([2.0 * np.pi * self.reference]), m).real
        least, most = (f"{100.0 * (1.0 - 1.0 / c):.2g}" for c in (stiffer.min(), stiffer.max()))
        lower = least if least == most else f"{least} to {most}"
        return f"moduli given at {self.reference:.3g} Hz; the static moduli are {lower} % lower"

    def amplitudes(self, m: int) -> Array:
        """a (K, m) of m modes."""
        a = self.amplitude[:, None] if self.amplitude.ndim == 1 else self.amplitude
        return np.broadcast_to(a, (len(self.tau), m))

    def factor(self, omega: Array | Complex, m: int) -> Complex:
        """1 + sum_k a_k i w tau_k / (1 + i w tau_k) (n, m) at w = omega (n,) [rad/s].

        With s = i w, any complex one.
        """
        x = 1j * np.multiply.outer(omega, self.tau)
        c: Complex = 1.0 + (x / (1.0 + x)) @ self.amplitudes(m)
        return c

    def at(self, omega: Array) -> Complex:
        """The stiffness factor (m,) of each mode at its own frequency, omega (m,) [rad/s]."""
        x = 1j * np.multiply.outer(self.tau, omega)
        c: Complex = 1.0 + (self.amplitudes(len(omega)) * (x / (1.0 + x))).sum(axis=0)
        return c

    def stepped(self, h: float, delay: Complex, m: int) -> Complex:
        """The stiffness factor (n, m) under time stepping by h [s], at delays d (n,).

        1 + sum_k a_k g_k (1 - d) / (1 - e_k d)
        """
        kept, gain = self.step(h)
        d = delay[:, None]
        c: Complex = 1.0 + (gain * (1.0 - d) / (1.0 - kept * d)) @ self.amplitudes(m)
        return c

    def step(self, h: float) -> tuple[Array, Array]:
        """e, g (K,) of a step: q+ = e q + g (eta+ - eta), the trapezoidal rule.

            e = (1 - x) / (1 + x),    g = 1 / (1 + x),    x = h / (2 tau)

        At rho_inf = 1 the spring then stores exactly what the dashpot does not take, h (q+ + q)^2 /
        (4 tau) in a step; at any other no step creates energy.
        """
        x = h / (2.0 * self.tau)
        return (1.0 - x) / (1.0 + x), 1.0 / (1.0 + x)


class Springs:
    """The springs of a chain on m modes, from one step to the next; q (K, m) are their stretches.

    Without a chain there are none, and all that they give is zero.
    """

    def __init__(self, chain: Chain | None, m: int) -> None:
        self._chain = chain
        self._a = np.zeros((0, m)) if chain is None else chain.amplitudes(m)
        self.q = np.zeros(self._a.shape)
        self._kept = self._gain = np.zeros(0)
        self.hardening: Array | float = 0.0

    def set_step(self, h: float) -> None:
        """Go on by steps of h, in which eta counts (1 + `hardening`) times."""
        if self._chain is not None:
            self._kept, self._gain = self._chain.step(h)
            self.hardening = self._gain @ self._a

    def carried(self, eta: Array) -> Array | float:
        """What the springs add beside the hardening to eta, which they pull back by: (m,)."""
        if self._chain is None:
            return 0.0
        old: Array = (self._a * (self._kept[:, None] * self.q)).sum(axis=0)
        return old - self.hardening * eta

    def follow(self, change: Array) -> None:
        """Stretch by the change of eta in the step."""
        if self._chain is not None:
            self.q = self._kept[:, None] * self.q + self._gain[:, None] * change

    def stress(self, eta: Array) -> Array:
        """eta + sum_k a_k q_k (m,): by which the relaxed stiffness gives forces and stresses."""
        return eta if self._chain is None else eta + (self._a * self.q).sum(axis=0)
