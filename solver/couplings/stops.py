"""Stops: limits of joint coordinates."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field, replace
from typing import Annotated, Any, ClassVar

from ..schema.entry import Entry, Flattened, entry
from ..schema.values import JointName, Limits, Name
from .impact import Impact
from .joint import Joint
from .on_coordinate import OnCoordinate
from .rows import Row, Sides


@entry()
class Stop(Entry):
    """Limits of a joint coordinate, with the force of a contact beyond them.

    Parameters
    ----------
    name : str
    joint : str
    coordinate : str
        One that the joint leaves free, or drives.
    range : (2,) [m, rad]
        The free play, of which one end may be infinite. Backlash is such a range.
    impact : Impact
        The force by the penetration. Model files have its keys beside those of the stop.

    Examples
    --------
    >>> from duhamel.solver import Impact
    >>> Stop("bumper", "hinge", "angle", range=(-0.5, 0.5), impact=Impact(stiffness=1e4)).range
    (-0.5, 0.5)
    """

    label = "stop {name!r}"
    group: ClassVar[str] = "stops"

    name: Name
    joint: JointName
    coordinate: str
    range: Limits
    impact: Annotated[Impact, Flattened()] = field(default_factory=Impact)

    def validate(self) -> None:
        if (self.impact.stiffness is None) == (self.impact.law is None):
            found = "none" if self.impact.law is None else "both"
            raise self.error(f"expected one of stiffness and law, found {found}")

    def bound(self, joints: Mapping[str, Joint]) -> "JointStop":
        bound: JointStop = JointStop.of(self, joints)
        return bound


class JointStop(OnCoordinate):
    """A stop with the joint that it belongs to."""

    part: Stop
    group: ClassVar[str] = "stops"
    dimension: ClassVar[str] = "stop"
    opens: ClassVar[bool] = True

    @property
    def in_words(self) -> str:
        lower, upper = self.part.range
        return f"{self.coordinate} of joint {self.joint.name!r} in [{lower:g}, {upper:g}]"

    def rows(self, sides: Sequence[Sides]) -> list[Row]:
        """The joint coordinate with the law beyond its limits."""
        return [replace(self.row(sides), laws=(self.part.impact.beyond(self.part.range),))]

    def given_angles(self) -> Iterator[tuple[str, Any]]:
        if self.turns:
            yield from (("range", limit) for limit in self.part.range)
