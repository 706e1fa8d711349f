"""Dampers that are not linear."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from ..arrays import Array
from ..schema.values import NotNegative, Numbers
from .law import Evaluation, ForceLaw, force_law
from .tabulated import interpolate, interval

NEGLIGIBLE_FORCE_AT_REST = 1e-9
"""force at rest, over the largest force, that counts as none"""


@force_law("compression")
class DamperLaw(ForceLaw):
    """A damper with one coefficient in compression and another in rebound.

    Parameters
    ----------
    compression, rebound : float [N s/m, N m s/rad]
        Force per rate of deformation where the deformation falls, and where it rises.

    Examples
    --------
    >>> DamperLaw(compression=200.0, rebound=800.0).rebound
    800.0
    """

    compression: NotNegative
    rebound: NotNegative

    def parameters(self) -> Sequence[float]:
        return [self.compression, self.rebound]

    @staticmethod
    def evaluate(parameters: Array, memory: Array, h: float, c: float, rate: float) -> Evaluation:
        coefficient = parameters[0] if rate < 0.0 else parameters[1]
        return coefficient * rate, 0.0, coefficient, 0.0


@force_law("rate")
class TabulatedDamperLaw(ForceLaw):
    """Force over the rate of deformation: the curve of a damper.

    Linear between the points, and beyond the last ones. It must dissipate at every rate: the force
    has the sign of the rate, is zero at rest, and does not fall beyond the last points.

    Parameters
    ----------
    rate : (n,) [m/s, rad/s]
    force : (n,) [N, N m]

    Examples
    --------
    >>> TabulatedDamperLaw([-1.0, 0.0, 0.2, 1.0], [-300.0, 0.0, 400.0, 900.0]).force[-1]
    900.0
    """

    rate: Numbers
    force: Numbers

    def validate(self) -> None:
        if len(self.rate) != len(self.force) or len(self.rate) < 2:
            points = f"{list(self.rate)} and {list(self.force)}"
            raise self.error(f"a damper's curve needs two or more points, got {points}")
        if any(b <= a for a, b in pairwise(self.rate)):
            raise self.error(f"rate: expected increasing values, got {list(self.rate)}")
        at_rest = self.evaluate(np.array(self.parameters()), np.zeros(0), np.inf, 0.0, 0.0)[0]
        if abs(at_rest) > NEGLIGIBLE_FORCE_AT_REST * max(map(abs, self.force)):
            raise self.error(f"force: expected 0 at the rate 0, got {at_rest:g}")
        for rate, force in zip(self.rate, self.force, strict=True):
            if rate * force < 0.0:
                raise self.error(
                    f"force: expected the sign of the rate, got {force:g} at {rate:g}, which "
                    "creates energy"
                )
        if self.force[1] < self.force[0] or self.force[-1] < self.force[-2]:
            raise self.error(
                "force: must not fall beyond the last points, where the curve is "
                f"extrapolated, got {list(self.force)}"
            )

    def parameters(self) -> Sequence[float]:
        return [*self.rate, *self.force]

    @staticmethod
    def evaluate(parameters: Array, memory: Array, h: float, c: float, rate: float) -> Evaluation:
        n = len(parameters) // 2
        force, slope = interpolate(parameters, n, interval(parameters, n, rate), rate)
        return force, 0.0, slope, 0.0
