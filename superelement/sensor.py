"""Sensors: points and strain gauges inside a body, which are read and never loaded."""

from dataclasses import dataclass

from ..files.arrays import Array
from .validation import SuperelementError, check_name, checked

CHANNELS_OF_KIND: dict[str, tuple[str, ...]] = {
    "motion": ("x", "y", "z"),
    "strain": ("strain",),
    "stress": ("xx", "yy", "zz", "yz", "xz", "xy"),
}
"""kinds of sensors, and the names of their channels"""


@dataclass(frozen=True, eq=False)
class Sensor:
    """A point inside a body at which motion, strain or stress is read.

    Parameters
    ----------
    name : str
        One line without '/' and '.'.
    kind : {"motion", "strain", "stress"}
        Elastic displacement (3 channels) [m], strain (1) [1], or stress (6) in the order xx, yy,
        zz, yz, xz, xy in body axes [Pa].
    X : (3,) [m]
        Position from the center of mass, in body axes.

    Raises
    ------
    SuperelementError
        For a name, kind or position that is not one.

    Examples
    --------
    >>> import numpy as np
    >>> Sensor("accelerometer", "motion", X=np.zeros(3)).channels
    ('x', 'y', 'z')
    """

    name: str
    kind: str
    X: Array

    def __post_init__(self) -> None:
        check_name("sensor", self.name)
        if self.kind not in CHANNELS_OF_KIND:
            raise SuperelementError(
                f"sensor {self.name!r}: kind: expected {', '.join(CHANNELS_OF_KIND)}, found "
                f"{self.kind!r}"
            )
        object.__setattr__(self, "X", checked(f"sensor {self.name!r}: X", self.X, (3,)))

    @property
    def channels(self) -> tuple[str, ...]:
        """The names of its channels."""
        return CHANNELS_OF_KIND[self.kind]
