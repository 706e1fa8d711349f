"""Maxwell chains: stiffness that depends on the frequency, creep and relaxation."""

import math
from collections.abc import Sequence

from ..arrays import Array
from ..compiler.marks import compiled
from ..schema.values import SomeNumbers
from .law import Evaluation, ForceLaw, force_law

MAX_SERIES_TIME = 1e-3
"""time over relaxation time below which a series of five terms is exact to rounding"""


@force_law("relaxation_times")
class MaxwellLaw(ForceLaw):
    """Springs in series with dampers, side by side: f = sum f_i, f_i' = k_i c' - f_i / tau_i.

    The static stiffness is that of the spring that has the law: at the frequency omega both
    together have the dynamic stiffness k + sum k_i i omega tau_i / (1 + i omega tau_i). Exact where
    the deformation is linear over a step; sum f_i^2 / (2 k_i) is stored. At the start all branches
    are relaxed.

    Parameters
    ----------
    relaxation_times : (n,) [s]
        tau_i.
    stiffness : (n,) [N/m, N m/rad]
        k_i.

    Examples
    --------
    >>> MaxwellLaw([1e-3, 1e-2], stiffness=[5e4, 2e4]).memories()
    [0.0, 0.0, 0.0]

    References
    ----------
    Simo, Hughes: Computational Inelasticity (1998), 10.2 and 10.3.
    """

    relaxation_times: SomeNumbers
    stiffness: SomeNumbers

    def validate(self) -> None:
        for name in ("relaxation_times", "stiffness"):
            values = getattr(self, name)
            if any(value <= 0.0 for value in values):
                raise self.error(f"{name}: expected positive numbers, got {list(values)}")
        if len(self.relaxation_times) != len(self.stiffness):
            raise self.error(
                f"expected as many relaxation_times as stiffness, got {len(self.relaxation_times)} "
                f"and {len(self.stiffness)}"
            )

    def parameters(self) -> Sequence[float]:
        return [*self.relaxation_times, *self.stiffness]

    def memories(self) -> Sequence[float]:
        """The deformation, and the force of each branch."""
        return [0.0] * (1 + len(self.stiffness))

    @staticmethod
    def evaluate(parameters: Array, memory: Array, h: float, c: float, rate: float) -> Evaluation:
        n = len(parameters) // 2
        force, slope, energy = 0.0, 0.0, 0.0
        for i in range(n):
            f, by_c = _branch(parameters, memory, i, h, c)
            force += f
            slope += by_c
            energy += 0.5 * f * f / parameters[n + i]
        return force, slope, 0.0, energy

    @staticmethod
    def remember(parameters: Array, memory: Array, h: float, c: float, rate: float) -> None:
        for i in range(len(parameters) // 2):
            memory[1 + i], _ = _branch(parameters, memory, i, h, c)
        memory[0] = c


@compiled
def _branch(parameters: Array, memory: Array, i: int, h: float, c: float) -> tuple[float, float]:
    """Force of branch i, and its derivative by the deformation c at the end of the time h."""
    x = h / parameters[i]
    decay = math.exp(-x)
    slope = parameters[len(parameters) // 2 + i] * _mean_decay(x, decay)
    return decay * memory[1 + i] + slope * (c - memory[0]), slope


@compiled
def _mean_decay(x: float, decay: float) -> float:
    """(1 - exp(-x)) / x, the mean of exp(-x s) for s from 0 to 1."""
    # For small x the difference 1 - exp(-x) loses its digits.
    if x > MAX_SERIES_TIME:
        return (1.0 - decay) / x
    return 1.0 - x / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0)))
