"""Generalized-alpha for one coordinate: Newmark's formulas and the pseudo-acceleration.

    (1 - alpha_m) a_{n+1} + alpha_m a_n = (1 - alpha_f) x''_{n+1} + alpha_f x''_n

Bodies and elastic dofs take the same step. Source: docs/theory.md, The time step, eqs (66)-(70).
"""

from ..compiler.marks import compiled
from .records.scheme import Scheme


@compiled
def free_pseudo_acceleration(scheme: Scheme, acceleration: float, a_n: float) -> float:
    """a*, the pseudo-acceleration at the end of a step that ends with x'' = 0."""
    return (scheme.alpha_f * acceleration - scheme.alpha_m * a_n) / (1.0 - scheme.alpha_m)


@compiled
def predicted_change(scheme: Scheme, rate: float, a_n: float, a: float) -> float:
    """Change of a coordinate in a step from a pseudo-acceleration a_n to another, a."""
    h, beta = scheme.h, scheme.beta
    return h * rate + h * h * ((0.5 - beta) * a_n + beta * a)


@compiled
def predicted_rate(scheme: Scheme, rate: float, a_n: float, a: float) -> float:
    """Rate of a coordinate after a step from a pseudo-acceleration a_n to another, a."""
    h, gamma = scheme.h, scheme.gamma
    return rate + h * ((1.0 - gamma) * a_n + gamma * a)


@compiled
def end_pseudo_acceleration(scheme: Scheme, a: float, acceleration: float) -> float:
    """a_{n+1} = a* + x''_{n+1} / inertia_ratio"""
    return a + (1.0 - scheme.alpha_f) / (1.0 - scheme.alpha_m) * acceleration
