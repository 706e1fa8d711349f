"""The generalized-alpha time integrator that kernels and solver share."""

from dataclasses import dataclass

from ..files.arrays import Complex


@dataclass(frozen=True)
class GeneralizedAlpha:
    """The generalized-alpha method of time integration, in the form of Arnold and Brüls.

    Equations (64)-(65) and (76) of the paper.

    Equilibrium holds at t_{n+1}; the pseudo-acceleration a is tied to the acceleration by

        (1 - alpha_m) a_{n+1} + alpha_m a_n = (1 - alpha_f) v_dot_{n+1} + alpha_f v_dot_n

    and displacement and velocity follow from Newmark's formulas in a.

    Parameters
    ----------
    rho_inf : float
        Spectral radius at infinite frequency: 1 conserves energy, 0 annihilates what the step
        cannot resolve.

    Raises
    ------
    ValueError
        For `rho_inf` outside [0, 1].

    Examples
    --------
    Without dissipation it is the trapezoidal rule:

    >>> scheme = GeneralizedAlpha(rho_inf=1.0)
    >>> scheme.gamma, scheme.beta
    (0.5, 0.25)
    """

    rho_inf: float = 0.9

    def __post_init__(self) -> None:
        if not 0.0 <= self.rho_inf <= 1.0:
            raise ValueError(f"rho_inf must lie in [0, 1], got {self.rho_inf}")

    @property
    def alpha_m(self) -> float:
        """The share of the previous pseudo-acceleration."""
        return (2.0 * self.rho_inf - 1.0) / (self.rho_inf + 1.0)

    @property
    def alpha_f(self) -> float:
        """The share of the previous acceleration."""
        return self.rho_inf / (self.rho_inf + 1.0)

    @property
    def gamma(self) -> float:
        """Newmark's gamma, for second order."""
        return 0.5 - self.alpha_m + self.alpha_f

    @property
    def beta(self) -> float:
        """Newmark's beta, for the largest dissipation of high frequencies."""
        return 0.25 * (1.0 - self.alpha_m + self.alpha_f) ** 2

    @property
    def inertia_ratio(self) -> float:
        """(1 - alpha_m) / (1 - alpha_f): from the pseudo-acceleration to the acceleration."""
        return (1.0 - self.alpha_m) / (1.0 - self.alpha_f)

    def beta_prime(self, h: float) -> float:
        """d v_dot / d q of one step, eq. (76) [1/s^2]."""
        return (1.0 - self.alpha_m) / (self.beta * h * h * (1.0 - self.alpha_f))

    def gamma_prime(self, h: float) -> float:
        """d v / d q of one step, eq. (76) [1/s]."""
        return self.gamma / (self.beta * h)

    def symbols(self, h: float, delay: Complex) -> tuple[Complex, Complex]:
        """The discrete symbols of s^2 and s: accelerations and velocities per unit displacement.

            sigma = 1 / (Q F),   chi = V / Q,   with d = 1/z, the delay by one step:
            Q = h^2 (beta + (1/2 + gamma - 2 beta) d + (1/2 + beta - gamma) d^2) / (1 - d)^2
            F = ((1 - alpha_f) + alpha_f d) / ((1 - alpha_m) + alpha_m d)
        V = h (gamma + (1 - gamma) d) / (1 - d)

        h [s]; delay (n,) complex, 0 for the first lag alone, where sigma and chi are beta' and
        gamma'. Source: docs/theory.md, Impulse responses.
        """
        d, beta, gamma = delay, self.beta, self.gamma
        Q = (
            h
            * h
            * (beta + (0.5 + gamma - 2.0 * beta) * d + (0.5 + beta - gamma) * d * d)
            / (1.0 - d) ** 2
        )
        F = ((1.0 - self.alpha_f) + self.alpha_f * d) / ((1.0 - self.alpha_m) + self.alpha_m * d)
        V = h * (gamma + (1.0 - gamma) * d) / (1.0 - d)
        return 1.0 / (Q * F), V / Q
