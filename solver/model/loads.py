"""Loads on frames."""

from typing import Annotated, Any

from ..schema.entry import Entry, entry, one_of
from ..schema.values import Vector
from ..step.loads import LOAD_KINDS
from .signals import AnySignal


@entry()
class Load(Entry):
    """A force [N] or torque [N m] on a frame: signal(t) times `direction`, whose length counts.

    `direction` (3,) is in space, or in the axes of the frame when the load follows it.
    """

    label = "load ({type}) on {on!r}"

    type: Annotated[str, one_of(LOAD_KINDS)]
    on: str
    direction: Vector
    signal: AnySignal
    follower: bool = False

    @property
    def kind(self) -> Any:
        """The class of solver/step/loads.py that computes the load."""
        return LOAD_KINDS[self.type]
