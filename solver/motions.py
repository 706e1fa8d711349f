"""Prescribed motion of a frame: its displacement from the start, along a direction in space, follows a signal."""

from dataclasses import dataclass

from .compiled import Array
from .errors import ModelError
from .joints import unit_vector
from .signals import Motion


@dataclass(frozen=True, eq=False)
class PrescribedMotion:
    """direction . (r(t) - r(0)) = displacement(t) [m] for the origin r of the frame `on`."""

    name: str
    on: str
    direction: Array
    displacement: Motion

    def __post_init__(self) -> None:
        owner = f"motion {self.name!r}"
        object.__setattr__(self, "direction", unit_vector(f"{owner}: direction", self.direction))
        if not isinstance(self.displacement, Motion):
            raise ModelError(
                f"{owner}: displacement: expected a smooth signal, got {type(self.displacement).__name__.lower()}"
            )
        if self.displacement(0.0) != 0.0:
            raise ModelError(f"{owner}: displacement: expected 0 at t = 0, got {self.displacement(0.0)}")
