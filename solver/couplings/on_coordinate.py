"""What acts on a coordinate of a joint, as stops and motors do."""

from typing import Any

from ..errors import ModelError
from .joints import Joint


class OnCoordinate:
    """A part of a model with the joint on whose coordinate it acts."""

    joint: Joint

    @property
    def part(self) -> Any:
        """It as the model gives it."""
        raise NotImplementedError

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
    def between(self) -> tuple[str, str]:
        return self.joint.between

    @property
    def type(self) -> str:
        return self.joint.type

    def error(self, message: str) -> ModelError:
        error: ModelError = self.part.error(message)
        return error
