"""Functions of time with their first and second derivative, and arithmetic with them."""

from typing import NamedTuple

import numpy as np

from ..arrays import Array
from .signal import SmoothSignal


class Jet(NamedTuple):
    """A number, a vector or a matrix as a function of time, with its first and second derivative.

    `*` multiplies entries, `@` matrices.
    """

    value: Array
    rate: Array
    acceleration: Array

    @classmethod
    def of(cls, signal: SmoothSignal, t: float) -> "Jet":
        """A signal at time t [s]."""
        return cls(*map(np.array, (signal(t), *signal.derivatives(t))))

    def __add__(self, other: "Jet") -> "Jet":  # type: ignore[override]
        return Jet(*(a + b for a, b in zip(self, other, strict=True)))

    def __mul__(self, other: "Jet") -> "Jet":  # type: ignore[override]
        (a, da, dda), (b, db, ddb) = self, other
        return Jet(a * b, da * b + a * db, dda * b + 2.0 * da * db + a * ddb)

    def __matmul__(self, other: "Jet") -> "Jet":
        (a, da, dda), (b, db, ddb) = self, other
        return Jet(a @ b, da @ b + a @ db, dda @ b + 2.0 * da @ db + a @ ddb)


def sine(x: Jet) -> Jet:
    s, c = np.sin(x.value), np.cos(x.value)
    return Jet(s, c * x.rate, c * x.acceleration - s * x.rate**2)


def cosine(x: Jet) -> Jet:
    s, c = np.sin(x.value), np.cos(x.value)
    return Jet(c, -s * x.rate, -s * x.acceleration - c * x.rate**2)


def angle_between(y: Jet, x: Jet) -> Jet:
    """atan2(y, x)."""
    # d atan2(y, x) = (x dy - y dx) / (x^2 + y^2).
    square = x.value**2 + y.value**2
    rate = (x.value * y.rate - y.value * x.rate) / square
    turning = x.value * y.acceleration - y.value * x.acceleration
    growing = 2.0 * (x.value * x.rate + y.value * y.rate)
    value: Array = np.arctan2(y.value, x.value)
    return Jet(value, rate, (turning - growing * rate) / square)
