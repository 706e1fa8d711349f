"""Couplers: one linear equation between coordinates of joints, as gears keep.

    sum_k ratio_k q_k = offset

    gear     teeth_1 q_1 + teeth_2 q_2 = offset     internal: teeth_1 q_1 - teeth_2 q_2
    rack     radius q_1 - q_2 = offset              q_1: angle of the pinion, q_2: way of the rack
    screw    lead / (2 pi) q_1 - q_2 = offset       q_1: angle, q_2: way of the nut
    linear   any ratios

The generalized force on coordinate k is ratio_k times one multiplier: of angles moments about the
axes of their joints, of distances forces along them. Forces of teeth, which load the bearings, are
not modeled.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np

from ..arrays import Array
from ..errors import ModelError
from ..schema.entry import Entry, entry, one_of
from ..schema.values import JointNames, Name, NotZero, SomeNonZero
from ..signals.curves import Constant, Input, SmoothFunction
from ..signals.signal import DrivingSignal, SmoothSignal, derivatives_of, is_any, values_of
from .coupling import Coupling
from .joint import Joint
from .rows import Row, Sides, Term

KEYS_OF_TYPE = {
    "gear": ("teeth", "radii"),
    "rack": ("radius",),
    "screw": ("lead",),
    "linear": ("ratios",),
}
"""the keys of which each type takes one"""
COORDINATE_UNITS = {"gear": ("rad", "rad"), "rack": ("rad", "m"), "screw": ("rad", "m")}
"""units of the coordinates of each type"""
ALL_KEYS = tuple(dict.fromkeys(key for keys in KEYS_OF_TYPE.values() for key in keys))


@entry()
class Coupler(Entry):
    """A linear equation between coordinates of joints.

    Signs are those of the coordinates: gears turn in opposite senses about the axes of their
    joints.

    Parameters
    ----------
    name : str
    type : {"gear", "rack", "screw", "linear"}
    joints : sequence of str
        "JOINT.COORDINATE", or "JOINT" if it has one coordinate. A gear takes two angles; a rack and
        a screw an angle and a distance; "linear" any number of any kind.
    ratios : (n,), optional
        Of a linear one: sum ratios_i c_i = offset.
    teeth, radii : (2,), optional
        Of a gear, one of both [1, m]; of bevel gears the mean radii.
    radius : float, optional [m]
        Of the pinion of a rack.
    lead : float, optional [m]
        Of a screw.
    internal : bool
        A ring gear.
    offset : float, optional
        By default that of the bodies as they are placed.

    Examples
    --------
    >>> Coupler("gears", "gear", ["motor", "wheel"], teeth=[20, 60]).joints
    ('motor', 'wheel')
    """

    label = "coupler {name!r}"
    group: ClassVar[str] = "couplers"

    name: Name
    type: Annotated[str, one_of(KEYS_OF_TYPE)]
    joints: JointNames
    ratios: SomeNonZero | None = None
    teeth: SomeNonZero | None = None
    radii: SomeNonZero | None = None
    radius: NotZero | None = None
    lead: NotZero | None = None
    internal: bool = False
    offset: DrivingSignal | None = None

    def validate(self) -> None:
        given = [key for key in ALL_KEYS if getattr(self, key) is not None]
        if len(given) != 1 or given[0] not in KEYS_OF_TYPE[self.type]:
            needs, found = " or ".join(KEYS_OF_TYPE[self.type]), " and ".join(given) or "none"
            raise self.error(f"a {self.type} coupler takes {needs}, found {found}")
        if self.offset is not None and is_any(self.offset, Input):
            raise self.error(
                "offset: expected a signal known before the run: let the input drive a joint"
            )
        if self.internal and self.type != "gear":
            raise self.error(f"internal belongs to gears, found type = {self.type!r}")
        if self.type != "linear" and len(self.joints) != 2:
            raise self.error(f"joints: a {self.type} coupler takes two, got {list(self.joints)}")
        if len(self.factors) != len(self.joints):
            raise self.error(
                f"{given[0]}: expected {len(self.joints)}, as many as joints, "
                f"got {list(self.factors)}"
            )

    def bound(self, joints: Mapping[str, Joint]) -> "JointCoupler":
        return JointCoupler.of(self, joints)

    @property
    def factors(self) -> tuple[float, ...]:
        """The ratio of each coordinate."""
        if self.radius is not None:
            return self.radius, -1.0
        if self.lead is not None:
            # Coordinates are radians, a lead is the way of a full turn.
            return self.lead / (2.0 * np.pi), -1.0
        sizes = self.teeth or self.radii
        if sizes is None:
            return self.ratios or ()
        if len(sizes) != 2:
            return sizes
        # External gears turn in opposite senses, n_1 q_1 + n_2 q_2 = 0; a ring gear turns with its
        # pinion.
        return sizes[0], -sizes[1] if self.internal else sizes[1]


@dataclass(frozen=True)
class JointCoupler(Coupling):
    """A coupler with its joints, and which coordinate of each it takes."""

    group: ClassVar[str] = "couplers"
    dimension: ClassVar[str] = "coupler"
    keeps_turns: ClassVar[bool] = True

    coupler: Coupler
    joints: tuple[Joint, ...]
    coordinates: tuple[str, ...]

    @classmethod
    def of(cls, coupler: Coupler, joints: Mapping[str, Joint]) -> "JointCoupler":
        """ModelError unless joints of these names have coordinates that fit."""
        found = [_coordinate(coupler, reference, joints) for reference in coupler.joints]
        if len(set(found)) < len(found):
            raise coupler.error(f"joints: expected different ones, got {list(coupler.joints)}")
        chosen, names = zip(*((joints[joint], name) for joint, name in found), strict=True)
        units = tuple(joint.unit(name) for joint, name in zip(chosen, names, strict=True))
        if units != (expected := COORDINATE_UNITS.get(coupler.type, units)):
            kinds = " and ".join({"rad": "an angle", "m": "a distance"}[u] for u in expected)
            raise coupler.error(f"joints: expected {kinds}, got {list(coupler.joints)}")
        return cls(coupler, chosen, names)

    @property
    def name(self) -> str:
        return self.coupler.name

    @property
    def owner(self) -> str:
        return self.coupler.owner

    @property
    def type(self) -> str:
        return self.coupler.type

    @property
    def between(self) -> tuple[str, str]:
        return self.joints[0].between

    @property
    def framed_by(self) -> Sequence[Coupling]:
        return self.joints

    @property
    def joint_coordinates(self) -> Sequence[tuple[str, str]]:
        names = (joint.name for joint in self.joints)
        return tuple(zip(names, self.coordinates, strict=True))

    @property
    def axis_in_space(self) -> Array | None:
        return self.joints[0].axis_in_space

    def error(self, message: str) -> ModelError:
        return self.coupler.error(message)

    def rows(self, sides: Sequence[Sides]) -> list[Row]:
        """One row: the first coordinate and, by their ratios to it, the others.

        q_1 + sum_k (ratio_k / ratio_1) q_k = offset / ratio_1
        """
        observed = [joint.observed(own) for joint, own in zip(self.joints, sides, strict=True)]
        coordinates = zip(observed, self.coordinates, strict=True)
        first, *others = (rows[name] for rows, name in coordinates)
        lead, *following = self.coupler.factors
        # Divided by the first ratio, the row has the unit and the scale of a coordinate, which the
        # tolerance of constraints assumes.
        ratios = [ratio / lead for ratio in following]
        # The sum as the bodies are placed: by default the offset, so that gears may mesh anywhere.
        terms = tuple(Term(row, ratio) for row, ratio in zip(others, ratios, strict=True))
        placed = first.start + sum(term.ratio * term.row.start for term in terms)
        offset = self.coupler.offset
        if offset is not None and not isinstance(offset, Constant):
            return [replace(first, terms=terms, drive=_over(offset, lead), reference=placed)]
        value = placed if offset is None else offset(0.0) / lead
        return [replace(first, terms=terms, zero=first.zero + value, start=first.start - value)]


def _over(offset: SmoothSignal, ratio: float) -> SmoothSignal:
    """An offset over a ratio."""

    def derivative(k: int) -> Callable[[Array], Array]:
        # A function of k, for a closure in a loop would see the last k alone.
        return lambda t: derivatives_of(offset, t)[k] / ratio

    return SmoothFunction(
        lambda t: values_of(offset, t) / ratio, derivative(0), derivative(1), vectorized=True
    )


def _coordinate(coupler: Coupler, reference: str, joints: Mapping[str, Joint]) -> tuple[str, str]:
    """Joint and coordinate of "JOINT.COORDINATE" or "JOINT"."""
    name, _, coordinate = reference.partition(".")
    if name not in joints:
        known = ", ".join(joints) or "none"
        raise coupler.error(f"joints: no joint {name!r}; there are: {known}")
    free = joints[name].coordinates
    if not coordinate and len(free) == 1:
        return name, free[0]
    if coordinate not in free:
        raise coupler.error(
            f"joints: joint {name!r} has {', '.join(free) or 'no coordinates'}, got {reference!r}"
        )
    return name, coordinate
