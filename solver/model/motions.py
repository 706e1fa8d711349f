"""Prescribed motion of a frame: a displacement along a direction, or a rotation about an axis,
follows a signal.
"""

from dataclasses import dataclass
from typing import Any

from ..arrays import Array
from ..errors import ModelError
from .signals import SmoothSignal
from .vectors import unit_vector


@dataclass(frozen=True, eq=False)
class PrescribedDisplacement:
    """direction . (r(t) - r(0)) = displacement(t) [m] for the origin r of the frame `on`;
    displacement(0) = 0.

    One constraint: the frame moves across `direction` (3,), in space, as it will. Three of them
    make up a path.
    """

    name: str
    on: str
    direction: Array
    displacement: SmoothSignal

    def __post_init__(self) -> None:
        owner = f"motion {self.name!r}"
        object.__setattr__(self, "direction", unit_vector(f"{owner}: direction", self.direction))
        _check_from_rest(f"{owner}: displacement", self.displacement)


@dataclass(frozen=True, eq=False)
class PrescribedRotation:
    """D(t) = exp(angle(t) axis~) D(0) for the axes D of the frame `on`, in space; angle(0) = 0
    [rad].

    Three constraints: the whole orientation is given, and `axis` (3,), in space, keeps its
    direction.
    """

    name: str
    on: str
    axis: Array
    angle: SmoothSignal

    def __post_init__(self) -> None:
        owner = f"motion {self.name!r}"
        object.__setattr__(self, "axis", unit_vector(f"{owner}: axis", self.axis))
        _check_from_rest(f"{owner}: angle", self.angle)


PrescribedMotion = PrescribedDisplacement | PrescribedRotation


def _check_from_rest(name: str, signal: Any) -> None:
    if not isinstance(signal, SmoothSignal):
        raise ModelError(f"{name}: expected a smooth signal, got {type(signal).__name__.lower()}")
    if signal(0.0) != 0.0:
        raise ModelError(
            f"{name}: expected 0 at t = 0, got {signal(0.0):.6g}: it counts from where the frame starts; "
            f"an offset of {-signal(0.0):.6g} would make it so"
        )
