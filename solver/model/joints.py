"""The lower pairs, each a table of primitive rows.

A joint aligns axes e1, e2, e3 of frame A with those of frame B. Two primitive rows cover all pairs:

    translation k:     e_k(A) . (r_B - r_A) = 0          r: the origin of a frame, in space
    rotation (i, j):   e_i(A) . e_j(B) = 0               e(A), e(B): axes carried by A and by B

A drive adds a row of the same two kinds: `angle` turns e1(A) by the signal before it meets e2(B),
`distance` subtracts the signal from e3(A) . (r_B - r_A).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ..arrays import Array
from ..errors import ModelError
from .signals import SmoothSignal
from .vectors import unit_vector


@dataclass(frozen=True)
class Angle:
    """The angle from e_i to e_k, both carried by one frame, at which e_j of the other is seen;
    `by_b`: seen from B.
    """

    i: int
    k: int
    j: int
    by_b: bool = False


@dataclass(frozen=True)
class JointType:
    translations: tuple[int, ...]
    rotations: tuple[tuple[int, int], ...]
    axes: int
    """how many axes a user gives: none, e3, or e1 and e2"""
    drives: tuple[str, ...] = ()
    distances: Mapping[str, int] = field(default_factory=dict)
    """coordinates left free: e_k(A) . (r_B - r_A) by name"""
    angles: Mapping[str, "Angle"] = field(default_factory=dict)


_ALL = (0, 1, 2)
_NO_ROTATION = ((0, 1), (1, 2), (2, 0))
ABOUT_E3 = ((0, 2), (1, 2))
_TURN = Angle(0, 1, 0)

JOINT_TYPES = {
    "fixed": JointType(_ALL, _NO_ROTATION, axes=0),
    "spherical": JointType(_ALL, (), axes=0),
    "revolute": JointType(_ALL, ABOUT_E3, axes=1, drives=("angle",), angles={"angle": _TURN}),
    "universal": JointType(
        _ALL,
        ((0, 1),),
        axes=2,
        angles={"angle": Angle(1, 2, 1), "second_angle": Angle(0, 2, 0, by_b=True)},
    ),
    "cylindrical": JointType(
        (0, 1),
        ABOUT_E3,
        axes=1,
        drives=("angle", "distance"),
        distances={"distance": 2},
        angles={"angle": _TURN},
    ),
    "prismatic": JointType(
        (0, 1), _NO_ROTATION, axes=1, drives=("distance",), distances={"distance": 2}
    ),
    "planar": JointType(
        (2,),
        ABOUT_E3,
        axes=1,
        distances={"distance": 0, "second_distance": 1},
        angles={"angle": _TURN},
    ),
}


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint between two frames, "BODY.FRAME", "BODY" (its origin) or "ground" (where the other
    frame starts).

    `axis` (3,) in space at the start: the axis of a revolute, cylindrical or prismatic joint, the
    normal of a planar one, the axis fixed in the first frame of a universal joint, whose
    `second_axis` is fixed in the second. `angle` [rad] and `distance` [m] drive a joint; the start
    is at angle(0). `start` gives free coordinates or their rates values at t = 0 other than those
    of the bodies' places: angle, angle_rate, distance, ...
    """

    name: str
    type: str
    between: tuple[str, str]
    axis: Array | None = None
    second_axis: Array | None = None
    angle: SmoothSignal | None = None
    distance: SmoothSignal | None = None
    start: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.type not in JOINT_TYPES:
            raise ModelError(
                f"joint {self.name!r}: type: expected one of {', '.join(JOINT_TYPES)}, got {self.type!r}"
            )
        object.__setattr__(self, "between", tuple(self.between))
        if len(self.between) != 2:
            raise ModelError(
                f"joint {self.name!r}: between: expected two frames, got {self.between}"
            )
        given = [axis for axis in (self.axis, self.second_axis) if axis is not None]
        if len(given) != self.kind.axes or (self.axis is None and self.second_axis is not None):
            needs = ("neither axis nor second_axis", "axis alone", "axis and second_axis")[
                self.kind.axes
            ]
            raise ModelError(f"joint {self.name!r}: a {self.type} joint takes {needs}")
        for drive in ("angle", "distance"):
            signal = getattr(self, drive)
            if signal is None:
                continue
            if drive not in self.kind.drives:
                takes = " and ".join(self.kind.drives) or "nothing"
                raise ModelError(
                    f"joint {self.name!r}: a {self.type} joint is driven by {takes}, got {drive}"
                )
            if not isinstance(signal, SmoothSignal):
                raise ModelError(
                    f"joint {self.name!r}: {drive}: expected a smooth signal "
                    f"(constant, harmonic, polynomial, spline), got {type(signal).__name__.lower()}"
                )
        known = [
            key
            for name in (*self.kind.distances, *self.kind.angles)
            for key in (name, f"{name}_rate")
        ]
        for key in self.start:
            if key not in known:
                takes = ", ".join(known) or "nothing"
                raise ModelError(
                    f"joint {self.name!r}: start: a {self.type} joint takes {takes}, got {key!r}"
                )
            if getattr(self, key.removesuffix("_rate"), None) is not None:
                raise ModelError(f"joint {self.name!r}: start: {key} is driven")
        self.basis()

    @property
    def kind(self) -> JointType:
        return JOINT_TYPES[self.type]

    def basis(self) -> Array:
        """The joint axes e1, e2, e3 at the start, in space, as columns (3, 3)."""
        owner = f"joint {self.name!r}"
        if self.axis is None:
            return np.eye(3)
        if self.second_axis is None:
            return basis_about(unit_vector(f"{owner}: axis", self.axis))
        axis, second = (
            unit_vector(f"{owner}: axis", self.axis),
            unit_vector(f"{owner}: second_axis", self.second_axis),
        )
        if abs(axis @ second) > 1e-9:
            raise ModelError(
                f"{owner}: the axes of a universal joint must be perpendicular at the start"
            )
        return np.column_stack([axis, second, np.cross(axis, second)])


def basis_about(axis: Array) -> Array:
    """Axes e1, e2, e3 as columns (3, 3): e3 along a unit vector, e1 near the coordinate axis
    farthest from it.
    """
    e1 = np.eye(3)[int(np.argmin(np.abs(axis)))]
    e1 = e1 - axis * (axis @ e1)
    e1 = e1 / np.linalg.norm(e1)
    return np.column_stack([e1, np.cross(axis, e1), axis])
