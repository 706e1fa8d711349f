"""Drives of an orientation that three angles give, row by row.

    D(t) = R_z(yaw) R_y(pitch) R_x(roll) D(0),    |angles| <= 1 rad

A row (j, k) turns the axis e_k, fixed in space, by an angle s about e_k x -e_j until it is across
axis j of the frame: s = atan2((R e_j)_k, (R e_j)_j). The three rows (1, 2), (2, 3), (3, 1) of the
angles s = yaw, and two that mix all, hold in that orientation alone.
"""

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..errors import ModelError
from .jets import Jet, angle_between, cosine, sine
from .signal import Pointwise, SmoothSignal, values_of

# [rad] The rows are regular up to somewhat more.
MAX_ANGLE = 1.0


@dataclass(frozen=True, eq=False)
class OrientationDrive(Pointwise):
    """The drive of row `row`, 0 to 2, by the angles about x, y and z.

    owner: in messages.
    """

    angles: tuple[SmoothSignal, SmoothSignal, SmoothSignal]
    row: int
    owner: str

    def values_at(self, t: Array) -> Array:
        none = np.zeros(t.shape)
        return self._turn(t, [Jet(values_of(a, t), none, none) for a in self.angles]).value

    def derivatives(self, t: float) -> tuple[float, float]:
        turn = self._turn(np.array(t), [Jet.of(angle, t) for angle in self.angles])
        return float(turn.rate), float(turn.acceleration)

    def _turn(self, t: Array, angles: list[Jet]) -> Jet:
        for axis, angle in zip("xyz", angles, strict=True):
            if (beyond := np.abs(angle.value) > MAX_ANGLE).any():
                k = int(np.argmax(beyond))
                raise ModelError(
                    f"{self.owner}: angles: expected at most {MAX_ANGLE:g} rad, got "
                    f"{angle.value.flat[k]:.6g} about {axis} at t = {t.flat[k]:.6g} s; for larger "
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
