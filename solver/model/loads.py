"""Loads on frames, and patterns of loads on flexible bodies."""

from typing import Annotated, Any

from ...superelement import Pattern, Superelement
from ..schema.entry import Entry, entry, one_of
from ..schema.values import Vector
from ..signals.signal import AnySignal
from ..step.loads import LOAD_KINDS


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


@entry()
class PatternLoad(Entry):
    """A load pattern of a flexible body: signal(t) times the loads of its body file.

    They turn with the body. body: its name; pattern: that of [loads.NAME] in its body file.
    """

    label = "load (pattern) on {body!r}"

    body: str
    pattern: str
    signal: AnySignal

    @property
    def owner_of_pattern(self) -> str:
        """BODY.PATTERN."""
        return f"{self.body}.{self.pattern}"

    def pattern_of(self, element: Superelement) -> Pattern:
        """The pattern among those of a superelement; `ModelError` where it has none of the name."""
        for pattern in element.patterns:
            if pattern.name == self.pattern:
                return pattern
        known = ", ".join(pattern.name for pattern in element.patterns) or "none"
        raise self.error(f"pattern: no load pattern {self.pattern!r}; there are: {known}")


AnyLoad = Load | PatternLoad
