"""Couplings that act on a coordinate of a joint: stops and motors."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..arrays import Array
from ..errors import ModelError
from .coupling import Coupling
from .joint import Joint
from .rows import Row, Sides


@dataclass(frozen=True)
class OnCoordinate(Coupling):
    """A part of a model with the joint on whose coordinate it acts.

    The part names the joint and the coordinate; `ModelError` where the joint has not got it.
    """

    part: Any
    joint: Joint

    @classmethod
    def of(cls, part: Any, joints: Mapping[str, Joint]) -> Any:
        """The part with its joint, found by name; `ModelError` for an unknown joint."""
        if part.joint not in joints:
            known = ", ".join(joints) or "none"
            raise part.error(f"joint: no joint {part.joint!r}; there are: {known}")
        return cls(part, joints[part.joint])

    def __post_init__(self) -> None:
        free = self.joint.coordinates
        if self.coordinate not in free:
            raise self.error(
                f"coordinate: joint {self.joint.name!r} has {', '.join(free) or 'none'}, "
                f"got {self.coordinate!r}"
            )

    @property
    def name(self) -> str:
        name: str = self.part.name
        return name

    @property
    def owner(self) -> str:
        owner: str = self.part.owner
        return owner

    @property
    def coordinate(self) -> str:
        coordinate: str = self.part.coordinate
        return coordinate

    @property
    def type(self) -> str:
        return self.coordinate

    @property
    def described(self) -> str:
        return f"{self.owner} ({self.joint.type})"

    @property
    def between(self) -> tuple[str, str]:
        return self.joint.between

    @property
    def framed_by(self) -> Sequence[Coupling]:
        return (self.joint,)

    @property
    def joint_coordinates(self) -> Sequence[tuple[str, str]]:
        return ((self.joint.name, self.coordinate),)

    @property
    def axis_in_space(self) -> Array | None:
        return self.joint.axis_in_space

    @property
    def turns(self) -> bool:
        """Whether the coordinate is an angle."""
        return self.joint.unit(self.coordinate) == "rad"

    def error(self, message: str) -> ModelError:
        error: ModelError = self.part.error(message)
        return error

    def row(self, sides: Sequence[Sides]) -> Row:
        """The row of the coordinate."""
        (own,) = sides
        row = self.joint.observed(own)[self.coordinate]
        # A coordinate seen from B has its signs from there: forces are recorded on the side of the
        # joint.
        return replace(row, swapped=row.frame_a != own.frame_a)
