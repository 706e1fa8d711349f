"""Stops: limits of joint coordinates."""

from dataclasses import dataclass, field
from typing import Annotated

from ..schema.entry import Beside, Entry, entry
from ..schema.values import Limits, Name
from .impact import Impact
from .joints import Joint
from .on_coordinate import OnCoordinate


@entry()
class Stop(Entry):
    """Limits of a joint coordinate, with the force of a contact beyond them.

    coordinate: one that the joint leaves free, or drives; range [m, rad]: its free play, of which
    one end may be infinite. The gaps of play and backlash are such ranges.
    """

    label = "stop {name!r}"

    name: Name
    joint: str
    coordinate: str
    range: Limits
    impact: Annotated[Impact, Beside()] = field(default_factory=Impact)

    def validate(self) -> None:
        if (self.impact.stiffness is None) == (self.impact.law is None):
            found = "none" if self.impact.law is None else "both"
            raise self.error(f"expected one of stiffness and law, found {found}")


@dataclass(frozen=True)
class JointStop(OnCoordinate):
    """A stop with the joint that it belongs to."""

    stop: Stop
    joint: Joint

    @property
    def part(self) -> Stop:
        return self.stop
