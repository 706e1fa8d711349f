"""Drives of an orientation that three angles give, row by row.

    D(t) = R_z(yaw) R_y(pitch) R_x(roll) D(0),    |angles| <= 1 rad

A row (j, k) turns the axis e_k, fixed in space, by an angle s about e_k x -e_j until it is across
axis j of the frame: s = atan2((R e_j)_k, (R e_j)_j). The three rows (1, 2), (2, 3), (3, 1) of the
angles s = yaw, and two that mix all, hold in that orientation alone.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..errors import ModelError
from .signal import SmoothSignal, values_of

# [rad] The rows are regular up to somewhat more.
MAX_ANGLE = 1.0


class Jet(NamedTuple):
    """A function of time with its first and second derivative."""

    value: Array
    rate: Array
    acceleration: Array

    def __add__(self, other: "Jet") -> "Jet":  # type: ignore[override]
        return Jet(*(a + b for a, b in zip(self, other, strict=True)))

    def __mul__(self, other: "Jet") -> "Jet":  # type: ignore[override]
        (a, da, dda), (b, db, ddb) = self, other
        return Jet(a * b, da * b + a * db, dda * b + 2.0 * da * db + a * ddb)


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


@dataclass(frozen=True, eq=False)
class OrientationDrive:
    """The drive of row `row`, 0 to 2, by the angles about x, y and z.

    owner: in messages.
    """

    angles: tuple[SmoothSignal, SmoothSignal, SmoothSignal]
    row: int
    owner: str

    def values_at(self, t: Array) -> Array:
        none = np.zeros(t.shape)
        return self._turn(t, [Jet(values_of(a, t), none, none) for a in self.angles]).value

    def __call__(self, t: float) -> float:
        return float(self.values_at(np.array([t]))[0])

    def samples(self, t: Array, h: float) -> Array:
        return self.values_at(t)

    def derivatives(self, t: float) -> tuple[float, float]:
        angles = [np.array([a(t), *a.derivatives(t)])[:, None] for a in self.angles]
        turn = self._turn(np.array([t]), [Jet(*angle) for angle in angles])
        return float(turn.rate[0]), float(turn.acceleration[0])

    def _turn(self, t: Array, angles: list[Jet]) -> Jet:
        for axis, angle in zip("xyz", angles, strict=True):
            if (beyond := np.abs(angle.value) > MAX_ANGLE).any():
                k = int(np.argmax(beyond))
                raise ModelError(
                    f"{self.owner}: angles: expected at most {MAX_ANGLE:g} rad, got "
                    f"{angle.value[k]:.6g} about {axis} at t = {t[k]:.6g} s; for larger "
                    "angles use driven joints in series"
                )
        roll, pitch, yaw = angles
        # Row (1, 2): R_21 / R_11 = tan(yaw) at any pitch and roll.
        if self.row == 0:
            return yaw
        s_y, s_z = sine(pitch), sine(yaw)
        c_x, c_y, c_z = cosine(roll), cosine(pitch), cosine(yaw)
        s_x = sine(roll)
        if self.row == 1:
            return angle_between(c_y * s_x, c_z * c_x + s_z * s_y * s_x)
        return angle_between(c_z * s_y * c_x + s_z * s_x, c_y * c_x)
