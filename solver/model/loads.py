"""Loads on frames."""

from dataclasses import dataclass
from typing import Annotated

from ..schema.entry import Entry, entry, one_of
from ..schema.values import Vector
from .signals import AnySignal


@dataclass(frozen=True)
class LoadType:
    """A kind of load; `moment`: it is a moment, not a force."""

    moment: bool


LOAD_TYPES = {"force": LoadType(moment=False), "torque": LoadType(moment=True)}


@entry()
class Load(Entry):
    """A force [N] or torque [N m] on a frame: signal(t) times `direction`, whose length counts.

    `direction` (3,) is in space, or in the axes of the frame when the load follows it.
    """

    label = "load ({type}) on {on!r}"

    type: Annotated[str, one_of(LOAD_TYPES)]
    on: str
    direction: Vector
    signal: AnySignal
    follower: bool = False

    @property
    def kind(self) -> LoadType:
        return LOAD_TYPES[self.type]
