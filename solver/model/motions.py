"""Prescribed motions of a frame: a displacement or a rotation that follows a signal."""

from ..errors import ModelError
from ..schema.entry import Entry, entry
from ..schema.values import Direction, Name
from .signals import DrivingSignal, SmoothSignal

ROUNDING = 1e-12
"""value at t = 0, relative to those at some later times, that counts as none"""
TIMES = tuple(10.0**k for k in range(-6, 1))
"""[s]"""


@entry()
class PrescribedDisplacement(Entry):
    """A displacement along a direction that follows a signal.

        direction . (r(t) - r(0)) = displacement(t) [m],    displacement(0) = 0

    for the origin r of the frame `on`. One constraint: the frame moves freely across `direction`
    (3,), in space. Three of them make up a path.
    """

    label = "motion {name!r}"

    name: Name
    on: str
    direction: Direction
    displacement: DrivingSignal

    def validate(self) -> None:
        _check_from_rest(f"{self.owner}: displacement", self.displacement)


@entry()
class PrescribedRotation(Entry):
    """A rotation about an axis that follows a signal.

        D(t) = exp(angle(t) axis~) D(0),    angle(0) = 0 [rad]

    for the axes D of the frame `on`, in space. Three constraints: the whole orientation is
    prescribed, and `axis` (3,), in space, keeps its direction.
    """

    label = "motion {name!r}"

    name: Name
    on: str
    axis: Direction
    angle: DrivingSignal

    def validate(self) -> None:
        _check_from_rest(f"{self.owner}: angle", self.angle)


PrescribedMotion = PrescribedDisplacement | PrescribedRotation


def _check_from_rest(name: str, signal: SmoothSignal) -> None:
    if (start := signal(0.0)) != 0.0 and abs(start) > ROUNDING * max(map(abs, map(signal, TIMES))):
        raise ModelError(
            f"{name}: expected 0 at t = 0, got {start:.6g}: it counts from where the frame starts; "
            f"an offset of {-start:.6g} would make it so"
        )
