"""A force law given by points."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from ..arrays import Array
from ..compiler.marks import compiled
from ..schema.values import Numbers
from .law import Evaluation, ForceLaw, force_law


@force_law("deformation")
class TabulatedLaw(ForceLaw):
    """Force over deformation, linear between the points, and beyond the last ones.

    The stored energy is 0 at the deformation without force that is nearest to rest, or at rest
    where there is none.

    Parameters
    ----------
    deformation : (n,) [m, rad]
        Ascending.
    force : (n,) [N, N m]
        That resists.

    Examples
    --------
    >>> TabulatedLaw([-0.01, 0.0, 0.01], [-50.0, 0.0, 80.0]).force[2]
    80.0
    """

    deformation: Numbers
    force: Numbers

    def validate(self) -> None:
        if len(self.deformation) != len(self.force) or len(self.force) < 2:
            points = f"{list(self.deformation)} and {list(self.force)}"
            raise self.error(f"a law needs two or more points, got {points}")
        if any(b <= a for a, b in pairwise(self.deformation)):
            values = f"{list(self.deformation)}"
            raise self.error(f"deformation: expected increasing values, got {values}")

    def parameters(self) -> Sequence[float]:
        counted = [*self.deformation, *self.force, 0.0]
        at_rest, none = self._without_force(), np.zeros(0)
        _, _, _, energy = self.evaluate(np.array(counted), none, np.inf, at_rest, 0.0)
        return [*counted[:-1], energy]

    def _without_force(self) -> float:
        """The deformation without force that is nearest to 0, or 0 where there is none."""
        c, f = np.array(self.deformation), np.array(self.force)
        first, last = c[:-1].copy(), c[1:].copy()
        first[0], last[-1] = -np.inf, np.inf
        rises = np.diff(f) != 0.0
        roots = c[:-1][rises] - (f[:-1] * np.diff(c))[rises] / np.diff(f)[rises]
        roots = roots[(roots >= first[rises]) & (roots <= last[rises])]
        idle = ~rises & (f[:-1] == 0.0)
        found = np.append(roots, np.clip(0.0, first, last)[idle])
        return float(found[np.argmin(np.abs(found))]) if len(found) else 0.0

    @staticmethod
    def evaluate(parameters: Array, memory: Array, h: float, c: float, rate: float) -> Evaluation:
        """The law; the last parameter is the energy that is stored there when counted from the
        first point.
        """
        n = len(parameters) // 2
        energy, last = -parameters[2 * n], interval(parameters, n, c)
        for k in range(last):
            width = parameters[k + 1] - parameters[k]
            energy += 0.5 * (parameters[n + k] + parameters[n + k + 1]) * width
        force, slope = interpolate(parameters, n, last, c)
        energy += 0.5 * (parameters[n + last] + force) * (c - parameters[last])
        return force, slope, 0.0, energy


@compiled
def interval(points: Array, n: int, x: float) -> int:
    """The interval of the increasing points[:n] that x is in, the first or last one beyond them."""
    k = 0
    while k + 2 < n and x > points[k + 1]:
        k += 1
    return k


@compiled
def interpolate(points: Array, n: int, k: int, x: float) -> tuple[float, float]:
    """Value and slope on the line through the points k and k + 1; points[n:] are the values."""
    slope = (points[n + k + 1] - points[n + k]) / (points[k + 1] - points[k])
    return points[n + k] + slope * (x - points[k]), slope
