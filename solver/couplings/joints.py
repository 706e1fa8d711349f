"""The lower pairs, each a table of primitive rows.

A joint aligns axes e1, e2, e3 of frame A with those of frame B. Two primitive rows cover all pairs:

    translation k:     e_k(A) . (r_B - r_A) = 0          r: the origin of a frame, in space
    rotation (i, j):   e_i(A) . e_j(B) = 0               e(A), e(B): axes carried by A and by B

A drive adds a row of the same two kinds: `angle` turns e1(A) by the signal before it meets e2(B),
`distance` subtracts the signal from e3(A) . (r_B - r_A). Some joints have a row of their own: a rod
keeps |r_B - r_A|, a screw couples its distance and its angle, a constant-velocity joint keeps

    e_1(A) . e_2(B) - e_2(A) . e_1(B) = 0

whereby B is turned against A about an axis across both shafts, e3(A) and e3(B).
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from ..arrays import Array
from ..schema.entry import Entry, entry, one_of
from ..schema.values import ABSENT, Name, NotZero, NumbersByName, OptionalDirection, Pair
from ..signals.attitude import Attitude, Attitudes
from ..signals.curves import Input
from ..signals.drives import ANGULAR, LINEAR, DriveKeys, IntegratedDrive, drive_of
from ..signals.signal import AnySignal, DrivingSignal, SmoothSignal, is_any
from ..step.rows import Angle as AngleRow
from ..step.rows import AngleOfA, Distance, Rotation, Translation
from ..step.rows import Attitude as AttitudeRow
from .coupling import Coupling, Inertia, length_of, side_names
from .friction import Bristle, JointFriction, resolved_spring
from .rows import Row, Sides, Term


@dataclass(frozen=True)
class Angle:
    """The angle from e_i towards e_k, both carried by one frame, at which e_j of the other is seen.

    by_b: seen from B.
    """

    i: int
    k: int
    j: int
    by_b: bool = False


@dataclass(frozen=True)
class JointType:
    """The rows that a joint closes, and the coordinates that it leaves free."""

    translations: tuple[int, ...]
    rotations: tuple[tuple[int, int], ...]
    axes: int
    """number of axes that a user gives: none, e3, or e1 and e2"""
    drives: tuple[str, ...] = ()
    distances: Mapping[str, int] = field(default_factory=dict)
    """coordinates left free: e_k(A) . (r_B - r_A) by name"""
    angles: Mapping[str, Angle] = field(default_factory=dict)
    sided: bool = False
    """its translations are not the same along axes of B"""
    own: Literal["", "rod", "screw", "constant velocity"] = ""
    """a row beside the table"""

    @property
    def coordinates(self) -> tuple[str, ...]:
        """The names of all that it leaves free."""
        return *self.distances, *self.angles

    def unit(self, coordinate: str) -> str:
        """The unit of a free coordinate; that of its rate is this per second."""
        return "rad" if coordinate in self.angles else "m"


_ALL = (0, 1, 2)
NO_ROTATION = ((0, 1), (1, 2), (2, 0))
ABOUT_E3 = ((0, 2), (1, 2))
ALONG = 0.9
"""cosine of the angle between two axes below which they span a plane: of none that models have"""
TURN = Angle(0, 1, 0)

JOINT_TYPES = {
    "fixed": JointType(_ALL, NO_ROTATION, axes=0),
    "spherical": JointType(_ALL, (), axes=0, drives=("rotation_vector", "cardan_angles")),
    "revolute": JointType(_ALL, ABOUT_E3, axes=1, drives=("angle",), angles={"angle": TURN}),
    "universal": JointType(
        _ALL,
        ((0, 1),),
        axes=2,
        drives=("angle", "second_angle"),
        angles={"angle": Angle(1, 2, 1), "second_angle": Angle(0, 2, 0, by_b=True)},
    ),
    "cylindrical": JointType(
        (0, 1),
        ABOUT_E3,
        axes=1,
        drives=("angle", "distance"),
        distances={"distance": 2},
        angles={"angle": TURN},
    ),
    "prismatic": JointType(
        (0, 1), NO_ROTATION, axes=1, drives=("distance",), distances={"distance": 2}
    ),
    "planar": JointType(
        (2,),
        ABOUT_E3,
        axes=1,
        distances={"distance": 0, "second_distance": 1},
        angles={"angle": TURN},
    ),
    "rod": JointType((), (), axes=0, drives=("distance",), own="rod"),
    "screw": JointType(
        (0, 1),
        ABOUT_E3,
        axes=1,
        drives=("angle", "distance"),
        distances={"distance": 2},
        angles={"angle": TURN},
        own="screw",
    ),
    "constant_velocity": JointType(_ALL, (), axes=1, own="constant velocity"),
    "point_on_line": JointType(
        (0, 1), (), axes=1, drives=("distance",), distances={"distance": 2}, sided=True
    ),
    "point_on_plane": JointType(
        (2,), (), axes=1, distances={"distance": 0, "second_distance": 1}, sided=True
    ),
}

DRIVES = {"angle": DriveKeys("angle", *ANGULAR), "distance": DriveKeys("distance", *LINEAR)}
"""coordinates that joints may drive, with the keys that do so"""
FRICTION_COORDINATES = {"revolute": "angle", "prismatic": "distance"}
"""joints that have friction, on these coordinates"""


@entry()
class Joint(Entry, Coupling):
    """A joint between two frames.

    Frames are "BODY.FRAME", "BODY" (its origin) or "ground" (where the other frame starts).
    `axis` (3,) in space at the start: the axis of a revolute, cylindrical or prismatic joint, the
    normal of a planar one, the axis fixed in the first frame of a universal joint, whose
    `second_axis` is fixed in the second. A planar joint slides along the x axis of its first frame,
    projected on the plane (its y axis where x is within 26 degrees of the normal), and across it.
    `angle` [rad] and `distance` [m] drive a joint; the start is at angle(0). So do their integrands
    `angular_velocity` or `angular_acceleration`, and `velocity` or `acceleration`; the coordinate
    then starts where the bodies are placed. `start` gives free coordinates or their rates values
    at t = 0 other than those of the starts of the bodies: angle, angle_rate, distance, ...; and to
    a coordinate that is driven by its acceleration its rate. `friction` of a revolute or prismatic
    joint. `second_angle` [rad]
    drives a universal joint with or without `angle`; a spherical one follows three signals,
    `rotation_vector` or `cardan_angles` (attitude.py). `drawn` [rad, m]: what coordinates are where
    the bodies are placed, from which they are measured; angles are 0 there, and driven ones at
    their start, unless it says so. `lead` [m] of a screw: its way in a full turn, negative where it
    is left-handed. A rod has the length of its start, or of the signal `distance`. `axis` of a
    constant-velocity joint: the shaft of the first frame, and of the second, unless `second_axis`
    says so; of a point on a line or a plane: the line, the normal, carried by the first frame.
    """

    label = "joint {name!r}"
    group: ClassVar[str] = "joints"
    dimension: ClassVar[str] = "joint"

    name: Name
    type: Annotated[str, one_of(JOINT_TYPES)]
    between: Pair
    axis: OptionalDirection = ABSENT
    second_axis: OptionalDirection = ABSENT
    angle: DrivingSignal | None = None
    distance: DrivingSignal | None = None
    start: NumbersByName = field(default_factory=dict)
    friction: JointFriction | None = None
    second_angle: DrivingSignal | None = None
    rotation_vector: Attitudes = None
    cardan_angles: Attitudes = None
    drawn: NumbersByName = field(default_factory=dict)
    lead: NotZero | None = None
    velocity: AnySignal | None = None
    acceleration: AnySignal | None = None
    angular_velocity: AnySignal | None = None
    angular_acceleration: AnySignal | None = None

    @property
    def kind(self) -> JointType:
        return JOINT_TYPES[self.type]

    @property
    def drives(self) -> dict[str, SmoothSignal]:
        """The signals of the coordinates that follow one."""
        signals = {name: drive_of(self, keys) for name, keys in DRIVES.items()}
        drives = {name: signal for name, signal in signals.items() if signal is not None}
        for name, drive in drives.items():
            if isinstance(drive, IntegratedDrive) and name in self.drawn:
                drives[name] = drive.starting_at(self.drawn[name])
        if self.second_angle is not None:
            drives["second_angle"] = self.second_angle
        return drives

    @property
    def attitude(self) -> Attitude | None:
        """The rotation that a spherical joint follows."""
        if self.rotation_vector is not None:
            return Attitude(self.rotation_vector, "vector")
        return None if self.cardan_angles is None else Attitude(self.cardan_angles, "angles")

    def drawn_at(self, coordinate: str, otherwise: float) -> float:
        """A coordinate where the bodies are placed, of a driven angle by default its start."""
        if coordinate in self.drawn:
            return self.drawn[coordinate]
        driven = coordinate in self.kind.angles and coordinate in self.drives
        return self.drives[coordinate](0.0) if driven else otherwise

    def validate(self) -> None:
        self._check_axes()
        self._check_drives()
        for name in self.start:
            self._check_start(name)
        for name in self.drawn:
            if name not in self.kind.coordinates:
                takes = ", ".join(self.kind.coordinates) or "nothing"
                raise self.error(f"drawn: a {self.type} joint takes {takes}, got {name!r}")
        if (self.lead is not None) != (self.kind.own == "screw"):
            takes = "needs a" if self.kind.own == "screw" else "takes no"
            raise self.error(f"lead: a {self.type} joint {takes} lead")
        if self.friction is not None:
            self._check_friction(self.friction)

    def _check_axes(self) -> None:
        axis, second, kind = self.axis, self.second_axis, self.kind
        n_axes = (axis is not None) + (second is not None)
        if kind.own == "constant velocity" and axis is not None:
            if second is not None and axis @ second < -ALONG:
                raise self.error(
                    f"second_axis: the shafts of a {self.type} joint must not point against each "
                    f"other, got axis = {axis.tolist()}, second_axis = {second.tolist()}"
                )
        elif n_axes != kind.axes or (axis is None and second is not None):
            needs = ("neither axis nor second_axis", "axis alone", "axis and second_axis")
            raise self.error(f"a {self.type} joint takes {needs[kind.axes]}")
        elif axis is not None and second is not None and abs(axis @ second) > 1e-9:
            raise self.error(f"the axes of a {self.type} joint must be perpendicular at the start")

    def _check_drives(self) -> None:
        attitudes = ("rotation_vector", "cardan_angles")
        given = [*self.drives, *(key for key in attitudes if getattr(self, key) is not None)]
        for name in given:
            if name not in self.kind.drives:
                takes = " and ".join(self.kind.drives) or "nothing"
                keys = DRIVES.get(name, (name,))
                key = next(key for key in keys if getattr(self, key) is not None)
                raise self.error(f"a {self.type} joint is driven by {takes}, got {key}")
        for key in attitudes:
            if any(is_any(signal, Input) for signal in getattr(self, key) or ()):
                raise self.error(f"{key}: takes no input of a Simulator: prescribe it beforehand")
        if len(given) > 1 and self.kind.own == "screw":
            raise self.error("a screw is driven by angle or distance, got both")
        if len(given) > 1 and self.type == "spherical":
            raise self.error("a spherical joint follows rotation_vector or cardan_angles, got both")

    def _check_friction(self, friction: JointFriction) -> None:
        if self.type not in FRICTION_COORDINATES:
            known = " and ".join(FRICTION_COORDINATES)
            raise self.error(f"friction: {known} joints take it, got a {self.type} one")
        needed = self.type == "revolute" and friction.coefficient.static > 0.0
        if needed and friction.radius is None:
            raise self.error("friction: radius: a revolute joint needs one")
        if self.type == "prismatic" and friction.radius is not None:
            raise self.error("friction: radius: a prismatic joint takes none")

    def _check_start(self, name: str) -> None:
        coordinates = self.kind.coordinates
        known = [key for coordinate in coordinates for key in (coordinate, f"{coordinate}_rate")]
        if name not in known:
            takes = ", ".join(known) or "nothing"
            raise self.error(f"start: a {self.type} joint takes {takes}, got {name!r}")
        drive = self.drives.get(name.removesuffix("_rate"))
        by_acceleration = isinstance(drive, IntegratedDrive) and drive.order == 2
        if drive is not None and not (by_acceleration and name.endswith("_rate")):
            raise self.error(f"start: {name} is driven")

    @property
    def axis_in_space(self) -> Array | None:
        return self.axis

    def rows(self, sides: Sequence[Sides]) -> list[Row]:
        """Constraints: its table, a row of its own, then its drives; at last its friction.

        The axes of a joint with the ground are carried by the body, as its other vectors are: rows
        are the same from both sides, e_i(A) . e_j(B) as e_j(B) . e_i(A).
        """
        (own,) = sides
        kind, rotations = self.kind, self.kind.rotations
        basis = self.basis(own.pose_a.R)
        drives = self.drives_from(own)
        in_a, in_b = self._carried(basis, own)
        driven = bool(drives) or self.attitude is not None
        turned = own.fixed_a and not (driven or kind.sided or kind.own)
        if turned:
            own, rotations = own.swapped(), tuple((j, i) for i, j in rotations)
            in_a, in_b = in_b, in_a
        A, B = own.frame_a, own.frame_b
        rows = [Row(Translation.number, A, B, in_a[:, k]) for k in kind.translations]
        rows += [Row(Rotation.number, A, B, in_a[:, i], b=in_b[:, j]) for i, j in rotations]
        if self.friction is not None:
            weights = self._normal_weights(self.friction)
            rows = [replace(row, normal=n) for row, n in zip(rows, weights, strict=True)]
        rows += self._own_rows(own, in_a, in_b)
        if "distance" in drives and kind.own != "rod":
            row = self.observed(own)["distance"]
            rows.append(replace(row, drive=drives["distance"], drawn=self.drawn.get("distance")))
        if "angle" in drives and self.type != "universal":
            drawn = self.drawn.get("angle")
            rows.append(driven_angle(A, B, in_a, in_b, drives["angle"], drawn))
        if self.type == "universal":
            rows += self._driven_angles(own)
        if self.attitude is not None:
            rows += [
                Row(AttitudeRow.number, A, B, b=in_b[:, j], axis=self.attitude.axis(i, in_a))
                for i, j in NO_ROTATION
            ]
        if self.friction is not None and self.type == "revolute":
            axes = in_a[:, 0], in_a[:, 1], in_b[:, 0]
            rows.append(Row(AngleRow.number, A, B, *axes, has_friction=True))
        elif self.friction is not None:
            rows.append(Row(Translation.number, A, B, in_a[:, 2], has_friction=True))
        return [replace(row, swapped=turned) if turned else row for row in rows]

    def observed(self, sides: Sides) -> dict[str, Row]:
        """The coordinates that it leaves free or drives, by name."""
        basis = self.basis(sides.pose_a.R)
        in_a, in_b = sides.carried(basis)
        gap = sides.gap(basis)
        rows = {}
        for name, k in self.kind.distances.items():
            start = self.drawn_at(name, float(gap[k]))
            zero = float(gap[k]) - start if name in self.drawn else 0.0
            A, B = sides.frame_a, sides.frame_b
            rows[name] = Row(Translation.number, A, B, in_a[:, k], start=start, zero=zero)
        for name, angle in self.kind.angles.items():
            start = self.drawn_at(name, 0.0)
            axes, other, A, B = in_a, in_b, sides.frame_a, sides.frame_b
            if angle.by_b:
                axes, other, A, B = other, axes, B, A
            b, zero = other[:, angle.i], -start
            if angle == TURN:
                # at the start e_j is e_i turned towards e_k by the starting angle
                b, zero = np.cos(start) * b + np.sin(start) * other[:, angle.k], 0.0
            row = Row(AngleRow.number, A, B, axes[:, angle.i], axes[:, angle.k], b, start=start)
            rows[name] = replace(row, zero=zero)
        return rows

    def drives_from(self, sides: Sides) -> dict[str, SmoothSignal]:
        """The signals of driven coordinates; a distance that is integrated starts where it is."""
        drives = self.drives
        distance = drives.get("distance")
        if isinstance(distance, IntegratedDrive) and "distance" not in self.drawn:
            drives["distance"] = distance.starting_at(self._placed_distance(sides))
        return drives

    def _placed_distance(self, sides: Sides) -> float:
        gap = sides.gap(self.basis(sides.pose_a.R))
        return float(np.linalg.norm(gap) if self.kind.own == "rod" else gap[2])

    def _carried(self, basis: Array, sides: Sides) -> tuple[Array, Array]:
        """Axes of the first frame and of the second at the start, in those of the frames."""
        in_a, in_b = sides.carried(basis)
        if self.kind.own == "constant velocity":
            in_b = sides.pose_b.R.T @ bent(basis, self.second_axis)
        if self.attitude is not None:
            R, _, _ = self.attitude.rotation(0.0)
            in_b = in_b @ R
        return in_a, in_b

    def _own_rows(self, sides: Sides, in_a: Array, in_b: Array) -> list[Row]:
        """The row that no table makes: of a rod, a screw, a constant-velocity joint."""
        A, B, own = sides.frame_a, sides.frame_b, self.kind.own
        if own == "rod":
            length = length_of(self, sides)
            if drive := self.drives_from(sides).get("distance"):
                return [Row(Distance.number, A, B, drive=drive, start=length)]
            return [Row(Distance.number, A, B, zero=length)]
        if own == "screw":
            rows = self.observed(sides)
            distance, ratio = rows["distance"], -(self.lead or 0.0) / (2.0 * np.pi)
            angle = rows["angle"]
            offset = distance.start + ratio * angle.start
            turning = Term(angle, ratio, own=True)
            distance = replace(distance, zero=distance.zero + offset, start=distance.start - offset)
            return [replace(distance, terms=(turning,))]
        if own == "constant velocity":
            across = Row(Rotation.number, A, B, in_a[:, 1], b=in_b[:, 0])
            rows_12 = Row(Rotation.number, A, B, in_a[:, 0], b=in_b[:, 1])
            return [replace(rows_12, terms=(Term(across, -1.0, own=True),))]
        return []

    def _driven_angles(self, sides: Sides) -> list[Row]:
        """The rows of the driven angles of a universal joint, all from its first frame."""
        rows, driven = self.observed(sides), []
        for name, drive in self.drives.items():
            row = replace(rows[name], drive=drive, drawn=self.drawn.get(name))
            if self.kind.angles[name].by_b:
                A, B = sides.frame_a, sides.frame_b
                row = replace(row, kind=AngleOfA.number, frame_a=A, frame_b=B)
            driven.append(row)
        return driven

    def bristle(self, inertia: Inertia, sides: Sides, h: float) -> Bristle | None:
        friction = self.friction
        if friction is None:
            return None
        axis = self.basis(sides.pose_a.R)[:, 2] if self.type == "revolute" else None
        return Bristle(
            friction.coefficient,
            *resolved_spring(friction.stiffness, friction.damping, inertia(axis), h),
            friction.viscous,
            friction.preload * (friction.radius or 1.0),
        )

    def _normal_weights(self, friction: JointFriction) -> list[tuple[float, int]]:
        """Weight and group of each row in the normal force, by which friction is one of the
        joint's coordinate: times the radius of a revolute joint.
        """
        kind, arm = self.kind, friction.radius or 1.0
        bearings = 2.0 * arm / friction.width if friction.width else 0.0
        forces = [(arm, 1 if k == 2 else 0) for k in kind.translations]
        # a moment about e3 of a prismatic joint turns what those across e3 tilt
        moments = [(bearings, 1 if {i, j} == {0, 1} else 2) for i, j in kind.rotations]
        return forces + moments

    def loaded_by_moments(self, rows: Sequence[Row]) -> Mapping[str, str]:
        causes = super().loaded_by_moments(rows)
        if not causes and self.kind.sided:
            return {side_names(self)[0]: f"{self.described}, whose axis it carries"}
        return causes

    def check_opening(self, sides: Sides, limit: float) -> None:
        """`ModelError` where its frames do not meet at the start.

        Directions in which it slides do not count.
        """
        gap = sides.gap(self.basis(sides.pose_a.R))
        opening = [gap[k] for k in self.kind.translations]
        start = ""
        drive = self.drives_from(sides).get("distance")
        if drive is not None and "distance" not in self.drawn:
            distance = drive(0.0)
            opening.append(self._placed_distance(sides) - distance)
            start = f", the distance starts at {distance:.6g}"
        worst = max(map(abs, opening), default=0.0)
        if worst > limit:
            first, second = self.between
            r_a, r_b = sides.pose_a.x.tolist(), sides.pose_b.x.tolist()
            raise self.error(
                f"open by {worst:.6g} m at the start: {first} is at {r_a}, "
                f"{second} at {r_b}{start}; assemble = true would close it"
            )

    def given_angles(self) -> Iterator[tuple[str, Any]]:
        for table in ("start", "drawn"):
            for coordinate, value in getattr(self, table).items():
                if coordinate in self.kind.angles:
                    yield f"{table}.{coordinate}", value
        for coordinate, signal in self.drives.items():
            if coordinate in self.kind.angles:
                yield coordinate, signal

    def basis(self, D: Array) -> Array:
        """The joint axes e1, e2, e3 at the start, in space, as columns (3, 3).

        D (3, 3): the axes of the first frame, which lead where the joint gives none.
        """
        if self.axis is None:
            return D
        if self.second_axis is None or self.kind.own == "constant velocity":
            return basis_about(self.axis, D)
        third = np.cross(self.axis, self.second_axis)
        return np.column_stack([self.axis, self.second_axis, third])


def driven_angle(
    A: int, B: int, in_a: Array, in_b: Array, angle: SmoothSignal, drawn: float | None = None
) -> Row:
    """The row of a driven angle: e1(A), turned about e3 by the signal, stays across an axis of B.

    That axis is e2 turned by minus the angle where the bodies are placed, by default angle(0).
    """
    start = angle(0.0) if drawn is None else drawn
    e2 = np.cos(start) * in_b[:, 1] - np.sin(start) * in_b[:, 0]
    return Row(Rotation.number, A, B, in_a[:, 0], in_a[:, 1], e2, drive=angle, drawn=drawn)


def bent(basis: Array, second_axis: Array | None) -> Array:
    """Axes (3, 3) turned by the shortest way until e3 is along another unit vector."""
    if second_axis is None:
        return basis
    e3 = basis[:, 2]
    middle = (e3 + second_axis) / np.linalg.norm(e3 + second_axis)
    half_turn = np.outer(middle, 2.0 * middle) - np.eye(3)
    turned: Array = half_turn @ (np.outer(e3, 2.0 * e3) - np.eye(3)) @ basis
    return turned


def basis_about(axis: Array, D: Array) -> Array:
    """Axes e1, e2, e3 as columns (3, 3): e3 along a unit vector.

    e1 is nearest to the x axis of a frame with the axes D (3, 3), or to its y axis where e3 is
    along x: so it turns with the whole model.
    """
    return _basis_about(tuple(axis.tolist()), tuple(D[:, 0].tolist()), tuple(D[:, 1].tolist()))


@lru_cache(maxsize=1024)
def _basis_about(axis: tuple[float, ...], x: tuple[float, ...], y: tuple[float, ...]) -> Array:
    """Mechanisms have few different axes, and many joints about each."""
    e3, e1 = np.array(axis), np.array(x)
    if abs(e3 @ e1) > ALONG:
        e1 = np.array(y)
    e1 = e1 - e3 * (e3 @ e1)
    e1 = e1 / np.linalg.norm(e1)
    basis = np.column_stack([e1, np.cross(e3, e1), e3])
    basis.flags.writeable = False
    return basis
