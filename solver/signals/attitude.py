"""Attitudes: rotations of one frame against another that follow three signals.

    rotation vector w(t):    R = exp(w~)
    Cardan angles a(t):      R = R_1(a_1) R_2(a_2) R_3(a_3), about e1, the new e2, the new e3

The joint keeps R(t) e_i(A) . e_j(B) = 0 for three pairs i, j. No attitude is singular for that, as
gimbal lock is for the angles themselves. Source: docs/theory.md, Frames, joints, loads.
"""

import math
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

import numpy as np

from ..arrays import Array
from ..schema.entry import FieldSpec
from ..schema.forms import Members
from .jets import Jet
from .signal import SIGNAL_FORMS, Pointwise, SmoothSignal, is_smooth, values_of

# Closed forms divide differences that cancel by a^2 to a^4. Below, the series of nine terms is
# exact to rounding.
SERIES_ANGLE_SQUARED = 1e-2
_I, _J, _K = np.eye(3)


def _three_signals(value: Any) -> tuple[SmoothSignal, SmoothSignal, SmoothSignal]:
    first, second, third = value
    signals = (first, second, third)
    if not all(map(is_smooth, signals)):
        raise TypeError
    return first, second, third


Attitudes = Annotated[
    tuple[SmoothSignal, SmoothSignal, SmoothSignal] | None,
    Members(SIGNAL_FORMS),
    FieldSpec("three smooth signals", _three_signals),
]


@dataclass(frozen=True)
class Attitude:
    """A rotation R(t) by three signals: the components of its vector, or three angles."""

    signals: tuple[SmoothSignal, SmoothSignal, SmoothSignal]
    form: Literal["vector", "angles"]
    _last: dict[bytes, Array] = field(default_factory=dict, repr=False, compare=False)
    """the last sampled rotations, which nine components share"""

    def rotation(self, t: float) -> Jet:
        """R, R' and R'' (3, 3) at time t [s]."""
        jets = [Jet.of(signal, t) for signal in self.signals]
        if self.form == "vector":
            return _exponential(Jet(*map(np.array, zip(*jets, strict=True))))
        first, second, third = map(_about, (_I, _J, _K), jets)
        return first @ second @ third

    def rotations(self, t: Array) -> Array:
        """R (n, 3, 3) at times t (n,)."""
        if (key := t.tobytes()) not in self._last:
            # Three rows of three components ask for the same rotations one after the other.
            values = np.stack([values_of(signal, t) for signal in self.signals], axis=1)
            self._last.clear()
            self._last[key] = _rotations(values, self.form)
        return self._last[key]

    def axis(self, i: int, basis: Array) -> tuple[SmoothSignal, SmoothSignal, SmoothSignal]:
        """The components of R(t) e_i in axes in which e1, e2, e3 are the columns of `basis`."""
        first, second, third = (Component(self, i, basis[m]) for m in range(3))
        return first, second, third


@dataclass(frozen=True, eq=False)
class Component(Pointwise):
    """row . R(t) e_i, a signal."""

    attitude: Attitude
    i: int
    row: Array

    def __call__(self, t: float) -> float:
        return float(self.row @ self.attitude.rotation(t).value[:, self.i])

    def values_at(self, t: Array) -> Array:
        # no product of BLAS: its rounding of a row may depend on the number of rows
        first, second, third = self.attitude.rotations(t)[..., self.i].T
        x, y, z = self.row.tolist()
        values: Array = first * x + second * y + third * z
        return values

    def derivatives(self, t: float) -> tuple[float, float]:
        _, rate, acceleration = self.attitude.rotation(t)
        return float(self.row @ rate[:, self.i]), float(self.row @ acceleration[:, self.i])


def _rotations(values: Array, form: str) -> Array:
    """R (n, 3, 3) of rotation vectors or angles (n, 3)."""
    if form == "vector":
        W = np.zeros((len(values), 3, 3))
        for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            W[:, i, j], W[:, j, i] = -values[:, k], values[:, k]
        # sinc has no cancellation at small angles: (1 - cos a) / a^2 = sinc(a / 2)^2 / 2.
        a = np.linalg.norm(values, axis=1)[:, None, None]
        half = np.sinc(0.5 * a / np.pi)
        R: Array = np.eye(3) + np.sinc(a / np.pi) * W + 0.5 * half**2 * (W @ W)
        return R
    first, second, third = (
        _turns(axis, angles) for axis, angles in zip((_I, _J, _K), values.T, strict=True)
    )
    product: Array = first @ second @ third
    return product


def _turns(axis: Array, angles: Array) -> Array:
    """exp(angle axis~) (n, 3, 3)."""
    S, P, a = _skew(axis), np.eye(3) - np.outer(axis, axis), angles[:, None, None]
    R: Array = np.outer(axis, axis) + np.cos(a) * P + np.sin(a) * S
    return R


def _about(axis: Array, angle: Jet) -> Jet:
    """exp(angle axis~)."""
    a, rate, acceleration = map(float, angle)
    S, P = _skew(axis), np.eye(3) - np.outer(axis, axis)
    # Derivatives by the angle; the chain rule follows below.
    slope = math.cos(a) * S - math.sin(a) * P
    curvature = -math.sin(a) * S - math.cos(a) * P
    R = np.outer(axis, axis) + math.cos(a) * P + math.sin(a) * S
    return Jet(R, rate * slope, acceleration * slope + rate**2 * curvature)


def _exponential(w: Jet) -> Jet:
    """exp(w~) = 1 + s w~ + c w~ w~, with s and c functions of x = w . w."""
    x, rate = w.value @ w.value, 2.0 * (w.value @ w.rate)
    acceleration = 2.0 * (w.value @ w.acceleration + w.rate @ w.rate)
    # Functions of x = a^2, not of a: they are smooth at zero, where a = |w| is not.
    s, c = (
        Jet(np.array(f), first * rate, second * rate**2 + first * acceleration)
        for f, first, second in _coefficients(float(x))
    )
    W = Jet(*map(_skew, w))
    one = Jet(np.eye(3), np.zeros((3, 3)), np.zeros((3, 3)))
    return one + s * W + c * (W @ W)


def _coefficients(x: float) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """sin(a) / a and (1 - cos a) / a^2 with their derivatives by x = a^2."""
    if x < SERIES_ANGLE_SQUARED:
        return _by_powers(x, 1), _by_powers(x, 2)
    a = math.sqrt(x)
    sine, cosine = math.sin(a), math.cos(a)
    s_0, c_0 = sine / a, (1.0 - cosine) / x
    s_1, c_1 = (cosine - s_0) / (2.0 * x), (0.5 * s_0 - c_0) / x
    # From the differential equations of s and c by x, which need no further trigonometric
    # functions.
    s_2 = (-0.5 * s_0 - 3.0 * s_1) / (2.0 * x)
    c_2 = (0.5 * s_1 - 2.0 * c_1) / x
    return (s_0, s_1, s_2), (c_0, c_1, c_2)


def _by_powers(x: float, first: int) -> tuple[float, float, float]:
    """sum_n (-x)^n / (2 n + first)! with its first two derivatives."""
    terms = [(-1.0) ** n / math.factorial(2 * n + first) for n in range(9)]
    series = np.polynomial.Polynomial(terms)
    return float(series(x)), float(series.deriv(1)(x)), float(series.deriv(2)(x))


def _skew(a: Array) -> Array:
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])
