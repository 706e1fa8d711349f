"""The generalized-alpha time integrator that kernels and solver share."""

from dataclasses import dataclass


@dataclass(frozen=True)
class GeneralizedAlpha:
    """Generalized-alpha in the Arnold-Brüls form, eqs (64)-(65) and (76) of the paper.

    Equilibrium holds at t_{n+1}; the pseudo-acceleration a is tied to the acceleration by

        (1 - alpha_m) a_{n+1} + alpha_m a_n = (1 - alpha_f) v_dot_{n+1} + alpha_f v_dot_n

    and displacement and velocity follow from Newmark's formulas in a.
    `rho_inf` is the spectral radius at infinite frequency: 1 conserves, 0 annihilates.
    """

    rho_inf: float = 0.9

    def __post_init__(self) -> None:
        if not 0.0 <= self.rho_inf <= 1.0:
            raise ValueError(f"rho_inf must lie in [0, 1], got {self.rho_inf}")

    @property
    def alpha_m(self) -> float:
        return (2.0 * self.rho_inf - 1.0) / (self.rho_inf + 1.0)

    @property
    def alpha_f(self) -> float:
        return self.rho_inf / (self.rho_inf + 1.0)

    @property
    def gamma(self) -> float:
        return 0.5 - self.alpha_m + self.alpha_f

    @property
    def beta(self) -> float:
        return 0.25 * (1.0 - self.alpha_m + self.alpha_f) ** 2

    def beta_prime(self, h: float) -> float:
        """d v_dot / d q of one step, eq. (76) [1/s^2]."""
        return (1.0 - self.alpha_m) / (self.beta * h * h * (1.0 - self.alpha_f))

    def gamma_prime(self, h: float) -> float:
        """d v / d q of one step, eq. (76) [1/s]."""
        return self.gamma / (self.beta * h)
