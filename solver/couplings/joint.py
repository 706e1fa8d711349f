"""The base of all joints: a table of primitive rows, free coordinates, drives, friction.

A joint aligns axes e1, e2, e3 of frame A with those of frame B. Two primitive rows cover all pairs:

    translation k:     e_k(A) . (r_B - r_A) = 0          r: the origin of a frame, in space
    rotation (i, j):   e_i(A) . e_j(B) = 0               e(A), e(B): axes carried by A and by B

A drive adds a row of the same two kinds: `angle` turns e1(A) by the signal before it meets e2(B),
`distance` subtracts the signal from e3(A) . (r_B - r_A).
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field, replace
from functools import lru_cache
from typing import Annotated, Any, ClassVar

import numpy as np

from ...inputs.errors import did_you_mean
from ..arrays import Array
from ..errors import ModelError
from ..schema.entry import Entry, FormerKey, entry
from ..schema.forms import ByType, kinds_of
from ..schema.values import Direction, FrameA, FrameB, Name, NumbersByName
from ..signals.drives import ANGULAR_RATES, LINEAR_RATES, DriveKeys, IntegratedDrive, drive_of
from ..signals.signal import AnySignal, DrivingSignal, SmoothSignal
from ..step.rows import Angle as AngleRow
from ..step.rows import Rotation, Translation
from .coupling import GROUND, Coupling, Inertia, side_names
from .friction import Bristle, JointFriction, resolved_spring
from .rows import Row, Sides


@dataclass(frozen=True)
class Angle:
    """The angle from e_i towards e_k, both carried by one frame, at which e_j of the other is seen.

    by_b: seen from B.
    """

    i: int
    k: int
    j: int
    by_b: bool = False


ALL_TRANSLATIONS = (0, 1, 2)
"""axes along which a joint lets nothing slide"""
NO_ROTATION = ((0, 1), (1, 2), (2, 0))
ABOUT_E3 = ((0, 2), (1, 2))
ANGLE_ABOUT_E3 = Angle(0, 1, 0)
"""the angle of a joint that turns about e3"""
SPAN_A_PLANE = 0.9
"""cosine of the angle between two axes below which they span a plane: of none that models have"""


@entry()
class Joint(Entry, Coupling, metaclass=ByType):
    """A joint between two frames.

    Parameters
    ----------
    frame_a, frame_b : str
        "BODY.FRAME", "BODY" (its center of mass), or "ground" (where the other frame starts).
    name : str
        By default its type and number, as "revolute 2".
    start : mapping of float [rad, m, rad/s, m/s]
        Free coordinates or their rates at t = 0, other than those of the starts of the bodies:
        angle, angle_rate, distance, ...; of a coordinate that is driven by its acceleration the
        rate alone.
    reference_coordinates : mapping of float [rad, m]
        Coordinates where the bodies are placed, from which they are measured. By default an angle
        is 0 there, and a driven one at its start. The former name is `drawn`.

    Examples
    --------
    >>> from duhamel.solver import Revolute
    >>> hinge = Revolute("ground", "arm.pin", axis=[0.0, 1.0, 0.0], start={"angle": 0.1})
    >>> hinge.type, hinge.coordinates
    ('revolute', ('angle',))
    """

    label = "joint {name!r}"
    group: ClassVar[str] = "joints"
    dimension: ClassVar[str] = "joint"

    translations: ClassVar[tuple[int, ...]] = ()
    """axes of A along which it lets nothing slide"""
    rotations: ClassVar[tuple[tuple[int, int], ...]] = ()
    """pairs of axes of A and B that it keeps perpendicular"""
    free_distances: ClassVar[Mapping[str, int]] = {}
    """coordinates left free: e_k(A) . (r_B - r_A), by name"""
    free_angles: ClassVar[Mapping[str, Angle]] = {}
    side_dependent: ClassVar[bool] = False
    """whether its rows differ when the frames are swapped, or frame A must carry them"""
    drive_keys: ClassVar[tuple[DriveKeys, ...]] = ()
    """of the coordinates that it may drive"""

    frame_a: FrameA
    frame_b: FrameB
    _: KW_ONLY
    name: Name = ""
    start: NumbersByName = field(default_factory=dict)
    reference_coordinates: Annotated[NumbersByName, FormerKey("drawn")] = field(
        default_factory=dict
    )

    @classmethod
    def of_type(
        cls, name: str, type: str, between: Sequence[str], *axes: Any, **given: Any
    ) -> "Joint":
        """The joint of a type that model files know; keys that are None count as not given."""
        kinds = kinds_of(cls)
        if type not in kinds:
            known = ", ".join(map(repr, kinds))
            raise ModelError(
                f"joint {name!r}: type: expected {known}, got {type!r}{did_you_mean(type, kinds)}"
            )
        keys = {key: value for key, value in given.items() if value is not None}
        placed = dict(zip(("axis", "second_axis"), axes, strict=False))
        keys |= {key: value for key, value in placed.items() if value is not None}
        made: Joint = kinds[type](*between, name=name, **keys)
        return made

    @property
    def type(self) -> str:
        return self.tag

    @property
    def drawn(self) -> Mapping[str, float]:
        """The former name of `reference_coordinates`."""
        return self.reference_coordinates

    @property
    def between(self) -> tuple[str, str]:
        return self.frame_a, self.frame_b

    @property
    def coordinates(self) -> tuple[str, ...]:
        """The names of the coordinates that the joint leaves free."""
        return *self.free_distances, *self.free_angles

    def unit(self, coordinate: str) -> str:
        """The unit of a free coordinate; that of its rate is this per second."""
        return "rad" if coordinate in self.free_angles else "m"

    @property
    def drives(self) -> dict[str, SmoothSignal]:
        """The signals of the coordinates that follow one."""
        drives = {}
        for keys in self.drive_keys:
            name, drive = keys.coordinate, drive_of(self, keys)
            # An integrated drive starts where the bodies are placed, in the numbers of the
            # coordinate.
            if isinstance(drive, IntegratedDrive) and name in self.reference_coordinates:
                drive = drive.starting_at(self.reference_coordinates[name])
            if drive is not None:
                drives[name] = drive
        return drives

    @property
    def is_driven(self) -> bool:
        return bool(self.drives)

    def drives_from(self, sides: Sides) -> dict[str, SmoothSignal]:
        """The drives between frames at the start, where an integrated distance begins."""
        drives = self.drives
        distance = drives.get("distance")
        if isinstance(distance, IntegratedDrive) and "distance" not in self.reference_coordinates:
            drives["distance"] = distance.starting_at(self.placed_distance(sides))
        return drives

    def placed_distance(self, sides: Sides) -> float:
        """The distance of a joint that has one, where the bodies are placed [m]."""
        return float(sides.gap(self.basis(sides.pose_a.R))[2])

    def angular_rate(self, velocity: Array, ratios: Mapping[str, float]) -> float | None:
        """The rate of its angle, between bodies that turn with ratios of an angular velocity (3,)
        in space [rad/s]; None where it has no such angle, or both turn alike.
        """
        first, second = ({GROUND: 0.0, **ratios}[frame.partition(".")[0]] for frame in self.between)
        axis = self.axis_in_space
        if axis is None or self.free_angles.get("angle") != ANGLE_ABOUT_E3 or first == second:
            return None
        # The angle is that of the second frame against the first.
        return (second - first) * float(axis @ velocity) / float(np.linalg.norm(axis))

    def reference_at(self, coordinate: str, otherwise: float) -> float:
        """A coordinate where the bodies are placed, of a driven angle by default its start."""
        if coordinate in self.reference_coordinates:
            return self.reference_coordinates[coordinate]
        driven = coordinate in self.free_angles and coordinate in self.drives
        return self.drives[coordinate](0.0) if driven else otherwise

    def validate(self) -> None:
        for name in self.start:
            self._check_start(name)
        for name in self.reference_coordinates:
            if name not in self.coordinates:
                takes = ", ".join(self.coordinates) or "nothing"
                raise self.error(
                    f"reference_coordinates: a {self.type} joint takes {takes}, got {name!r}"
                )

    def _check_start(self, name: str) -> None:
        coordinates = self.coordinates
        known = [key for coordinate in coordinates for key in (coordinate, f"{coordinate}_rate")]
        if name not in known:
            takes = ", ".join(known) or "nothing"
            raise self.error(f"start: a {self.type} joint takes {takes}, got {name!r}")
        drive = self.drives.get(name.removesuffix("_rate"))
        by_acceleration = isinstance(drive, IntegratedDrive) and drive.order == 2
        if drive is not None and not (by_acceleration and name.endswith("_rate")):
            raise self.error(f"start: {name} is driven")

    def basis(self, D: Array) -> Array:
        """The joint axes e1, e2, e3 at the start, in space, as columns (3, 3).

        D (3, 3): the axes of the first frame, which lead where the joint gives none.
        """
        return D

    def carried(self, basis: Array, sides: Sides) -> tuple[Array, Array]:
        """Axes of the first frame and of the second at the start, in those of the frames."""
        return sides.carried(basis)

    def rows(self, sides: Sequence[Sides]) -> list[Row]:
        """Constraints: its table, a row of its own, then its drives; at last its friction.

        The axes of a joint with the ground are carried by the body, as its other vectors are: rows
        are the same from both sides, e_i(A) . e_j(B) as e_j(B) . e_i(A).
        """
        (own,) = sides
        rotations = self.rotations
        in_a, in_b = self.carried(self.basis(own.pose_a.R), own)
        # Rows whose axes the ground carries depend on the axes of space; those of a body do not.
        turned = own.fixed_a and not (self.is_driven or self.side_dependent)
        if turned:
            own, rotations = own.swapped(), tuple((j, i) for i, j in rotations)
            in_a, in_b = in_b, in_a
        A, B = own.frame_a, own.frame_b
        rows = [Row(Translation.number, A, B, in_a[:, k]) for k in self.translations]
        # e_i(A) . e_j(B) = 0 rather than angles: it is linear in each rotation, and has no period.
        rows += [Row(Rotation.number, A, B, in_a[:, i], b=in_b[:, j]) for i, j in rotations]
        rows = self.with_friction(rows, in_a, in_b)
        n_table = len(self.translations) + len(self.rotations)
        # Friction reads the multipliers of the table before it, and stands behind all other rows.
        rows[n_table:n_table] = [
            *self.extra_rows(own, in_a, in_b),
            *self.driven_rows(own, in_a, in_b),
        ]
        return [replace(row, swapped=turned) if turned else row for row in rows]

    def extra_rows(self, sides: Sides, in_a: Array, in_b: Array) -> list[Row]:
        """Constraints beyond those of its table."""
        return []

    def driven_rows(self, sides: Sides, in_a: Array, in_b: Array) -> list[Row]:
        """Rows of the coordinates that follow a signal."""
        drives, rows = self.drives_from(sides), []
        if "distance" in drives:
            row = self.observed(sides)["distance"]
            rows.append(
                replace(
                    row,
                    drive=drives["distance"],
                    reference=self.reference_coordinates.get("distance"),
                )
            )
        if "angle" in drives:
            A, B, placed = sides.frame_a, sides.frame_b, self.reference_coordinates.get("angle")
            rows.append(driven_angle(A, B, in_a, in_b, drives["angle"], placed))
        return rows

    def with_friction(self, rows: list[Row], in_a: Array, in_b: Array) -> list[Row]:
        """The rows of its table, followed by the row of friction if it has friction."""
        return rows

    def observed(self, sides: Sides) -> dict[str, Row]:
        """The rows of the coordinates that the joint leaves free or drives, by name."""
        basis = self.basis(sides.pose_a.R)
        in_a, in_b = sides.carried(basis)
        gap = sides.gap(basis)
        rows = {}
        for name, k in self.free_distances.items():
            start = self.reference_at(name, float(gap[k]))
            zero = float(gap[k]) - start if name in self.reference_coordinates else 0.0
            A, B = sides.frame_a, sides.frame_b
            rows[name] = Row(Translation.number, A, B, in_a[:, k], start=start, zero=zero)
        for name, angle in self.free_angles.items():
            # Angles are not read off the frames: only their change from the start is defined
            # without a period.
            start = self.reference_at(name, 0.0)
            axes, other, A, B = in_a, in_b, sides.frame_a, sides.frame_b
            if angle.by_b:
                axes, other, A, B = other, axes, B, A
            b, zero = other[:, angle.i], -start
            if angle == ANGLE_ABOUT_E3:
                # at the start e_j is e_i turned towards e_k by the starting angle
                b, zero = np.cos(start) * b + np.sin(start) * other[:, angle.k], 0.0
            row = Row(AngleRow.number, A, B, axes[:, angle.i], axes[:, angle.k], b, start=start)
            rows[name] = replace(row, zero=zero)
        return rows

    def check_opening(self, sides: Sides, limit: float) -> None:
        """`ModelError` where its frames do not meet at the start.

        Directions in which it slides do not count.
        """
        gap = sides.gap(self.basis(sides.pose_a.R))
        opening = [gap[k] for k in self.translations]
        start = ""
        drive = self.drives_from(sides).get("distance")
        if drive is not None and "distance" not in self.reference_coordinates:
            distance = drive(0.0)
            opening.append(self.placed_distance(sides) - distance)
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
        for table in ("start", "reference_coordinates"):
            for coordinate, value in getattr(self, table).items():
                if coordinate in self.free_angles:
                    yield f"{table}.{coordinate}", value
        for coordinate, signal in self.drives.items():
            if coordinate in self.free_angles:
                yield coordinate, signal


@entry()
class JointWithAxis(Joint):
    """A joint about or along one axis, e3.

    axis (3,): in space at the start.
    """

    axis: Direction

    @property
    def axis_in_space(self) -> Array:
        return self.axis

    def basis(self, D: Array) -> Array:
        return basis_about(self.axis, D)


@entry(kw_only=True)
class DrivesAngle(Joint):
    """A joint whose angle may follow a signal.

    angle [rad]: the start is at angle(0). Or its angular_velocity [rad/s] or angular_acceleration
    [rad/s^2]; the angle then starts where the bodies are placed.
    """

    drive_keys: ClassVar[tuple[DriveKeys, ...]] = (DriveKeys("angle", *ANGULAR_RATES),)

    angle: DrivingSignal | None = None
    angular_velocity: AnySignal | None = None
    angular_acceleration: AnySignal | None = None


@entry(kw_only=True)
class DrivesDistance(Joint):
    """A joint whose distance may follow a signal.

    distance [m]: the start is at distance(0). Or its velocity [m/s] or acceleration [m/s^2]; the
    distance then starts where the bodies are placed.
    """

    drive_keys: ClassVar[tuple[DriveKeys, ...]] = (DriveKeys("distance", *LINEAR_RATES),)

    distance: DrivingSignal | None = None
    velocity: AnySignal | None = None
    acceleration: AnySignal | None = None


DRIVES_BOTH = (*DrivesAngle.drive_keys, *DrivesDistance.drive_keys)


@entry(kw_only=True)
class HasFriction(Joint):
    """A joint with friction on its coordinate, by its own forces."""

    friction: JointFriction | None = None

    def with_friction(self, rows: list[Row], in_a: Array, in_b: Array) -> list[Row]:
        if self.friction is None:
            return rows
        weights = self._normal_weights(self.friction)
        weighed = [replace(row, normal=n) for row, n in zip(rows, weights, strict=True)]
        A, B = rows[0].frame_a, rows[0].frame_b
        return [*weighed, replace(self.rubbing_row(A, B, in_a, in_b), has_friction=True)]

    def rubbing_row(self, A: int, B: int, in_a: Array, in_b: Array) -> Row:
        """The coordinate of friction."""
        raise NotImplementedError

    def moved_about(self, D: Array) -> Array | None:
        """The axis in space about which friction moves inertias; None where it moves masses."""
        return None

    def bristle(self, inertia: Inertia, sides: Sides, h: float) -> Bristle | None:
        friction = self.friction
        if friction is None:
            return None
        moved = inertia(self.moved_about(sides.pose_a.R))
        coefficient, preload = friction.steady
        return Bristle(
            coefficient,
            *resolved_spring(friction.stiffness, friction.damping, moved, h),
            friction.viscous,
            preload,
        )

    def _normal_weights(self, friction: JointFriction) -> list[tuple[float, int]]:
        """Weight and group of each row in the normal force, by which friction is one of the
        joint's coordinate: times the radius of a revolute joint.
        """
        if friction.constant > 0.0:
            return [(0.0, 0)] * (len(self.translations) + len(self.rotations))
        arm = friction.radius or 1.0
        # A moment M across the axis loads two bearings, width apart, with M / width each.
        bearings = 2.0 * arm / friction.width if friction.width else 0.0
        forces = [(arm, 1 if k == 2 else 0) for k in self.translations]
        # a moment about e3 of a prismatic joint turns what those across e3 tilt
        moments = [(bearings, 1 if {i, j} == {0, 1} else 2) for i, j in self.rotations]
        return forces + moments


class SideDependent(Joint):
    """A joint whose axis is carried by its first frame alone."""

    side_dependent: ClassVar[bool] = True

    def loaded_by_moments(self, rows: Sequence[Row]) -> Mapping[str, str]:
        causes = super().loaded_by_moments(rows)
        # The reaction acts at the second origin, away from the frame that carries the axis.
        return causes or {side_names(self)[0]: f"{self.described}, whose axis it carries"}


def driven_angle(
    A: int, B: int, in_a: Array, in_b: Array, angle: SmoothSignal, reference: float | None = None
) -> Row:
    """The row of a driven angle: e1(A), turned about e3 by the signal, stays across an axis of B.

    That axis is e2 turned by minus the angle where the bodies are placed, by default angle(0).
    """
    # Placed so, the row is zero at the start, and no jump of the drive loads the joint.
    start = angle(0.0) if reference is None else reference
    e2 = np.cos(start) * in_b[:, 1] - np.sin(start) * in_b[:, 0]
    return Row(Rotation.number, A, B, in_a[:, 0], in_a[:, 1], e2, drive=angle, reference=reference)


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
    if abs(e3 @ e1) > SPAN_A_PLANE:
        e1 = np.array(y)
    # One step of Gram-Schmidt; the choice above keeps the difference far from zero.
    e1 = e1 - e3 * (e3 @ e1)
    e1 = e1 / np.linalg.norm(e1)
    basis = np.column_stack([e1, np.cross(e3, e1), e3])
    # The cache hands the same array to all joints about this axis.
    basis.flags.writeable = False
    return basis
