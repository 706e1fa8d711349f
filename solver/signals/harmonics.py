"""Integrals of sines, without cancellation where they are slow."""

import numpy as np

from ..arrays import Array

# [rad] Here x - sin x loses two digits by cancellation, and the series of six terms has rounding
# errors alone.
SERIES_LIMIT = 0.3


def harmonic_integrals(t: Array, omega: Array | float, phase: Array | float) -> tuple[Array, Array]:
    """The first and second integral from 0 of sin(omega t + phase), of one shape by broadcasting.

    sin(phase) sin(x)/omega + cos(phase) (1 - cos x)/omega,                 x = omega t
    sin(phase) (1 - cos x)/omega^2 + cos(phase) (x - sin x)/omega^2
    """
    x: Array = np.asarray(omega * t, dtype=np.float64)
    sine, cosine = np.sin(phase), np.cos(phase)
    half = np.sinc(x / (2.0 * np.pi))  # sin(x / 2) / (x / 2)
    by_x = 0.5 * half**2  # (1 - cos x) / x^2
    once = t * (sine * np.sinc(x / np.pi) + cosine * x * by_x)
    return once, t**2 * (sine * by_x + cosine * _lag(x))


def _lag(x: Array) -> Array:
    """(x - sin x) / x^2."""
    near = np.abs(x) < SERIES_LIMIT
    # numpy evaluates both branches: 1 keeps the unused one from dividing by zero.
    far = np.where(near, 1.0, x)
    squared = x * x
    series = 1.0 - squared / 110.0 * (1.0 - squared / 156.0)
    series = 1.0 - squared / 20.0 * (1.0 - squared / 42.0 * (1.0 - squared / 72.0 * series))
    lag: Array = np.where(near, x / 6.0 * series, (far - np.sin(far)) / far**2)
    return lag
