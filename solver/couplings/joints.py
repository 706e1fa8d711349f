"""The joints, one class each."""

from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from typing import ClassVar

import numpy as np

from ..arrays import Array
from ..schema.entry import entry
from ..schema.forms import Kinds
from ..schema.values import NO_ARRAY, Direction, NotZero, OptionalDirection, Positive
from ..signals.attitude import Attitude, Attitudes
from ..signals.curves import Input
from ..signals.signal import DrivingSignal, SmoothSignal, is_any
from ..step.rolling import Roll, SideSlip, Touch
from ..step.rows import Angle as AngleRow
from ..step.rows import AngleOfA, Distance, Rotation, Translation
from ..step.rows import Attitude as AttitudeRow
from .coupling import length_of, side_names
from .joint import (
    ABOUT_E3,
    ALL_TRANSLATIONS,
    ANGLE_ABOUT_E3,
    DRIVES_BOTH,
    NO_ROTATION,
    SPAN_A_PLANE,
    Angle,
    DrivesAngle,
    DrivesDistance,
    HasFriction,
    Joint,
    JointWithAxis,
    SideDependent,
)
from .rows import Row, Sides, Term

LYING_FLAT = 1.0 - 1e-9
"""cosine of the angle between a normal and an axle above which a disc lies flat"""
JOINTS = Kinds()
"""the classes of joints, by their types in model files"""


@JOINTS.in_files("fixed")
@entry()
class Fixed(Joint):
    """A joint that fixes two frames to each other. Parameters: see `Joint`.

    Examples
    --------
    >>> Fixed("hub.rim", "beam.root").coordinates
    ()
    """

    translations: ClassVar = ALL_TRANSLATIONS
    rotations: ClassVar = NO_ROTATION


@JOINTS.in_files("spherical")
@entry(kw_only=True)
class Spherical(Joint):
    """A ball joint: the origins of both frames coincide. Other parameters: see `Joint`.

    Parameters
    ----------
    rotation_vector, cardan_angles : sequence of 3 signals, optional [rad]
        One of them drives the orientation (solver/signals/attitude.py).

    Examples
    --------
    >>> Spherical("ground", "bob.pin").translations
    (0, 1, 2)
    """

    translations: ClassVar = ALL_TRANSLATIONS

    rotation_vector: Attitudes = None
    cardan_angles: Attitudes = None

    @property
    def attitude(self) -> Attitude | None:
        """The rotation that it follows."""
        if self.rotation_vector is not None:
            return Attitude(self.rotation_vector, "vector")
        return None if self.cardan_angles is None else Attitude(self.cardan_angles, "angles")

    @property
    def is_driven(self) -> bool:
        return self.attitude is not None

    def validate(self) -> None:
        super().validate()
        for key in ("rotation_vector", "cardan_angles"):
            if any(is_any(signal, Input) for signal in getattr(self, key) or ()):
                raise self.error(
                    f"{key}: expected a signal known before the run, got an input of a Simulator"
                )
        if self.rotation_vector is not None and self.cardan_angles is not None:
            raise self.error("a spherical joint follows rotation_vector or cardan_angles, got both")

    def carried(self, basis: Array, sides: Sides) -> tuple[Array, Array]:
        in_a, in_b = sides.carried(basis)
        if self.attitude is not None:
            R, _, _ = self.attitude.rotation(0.0)
            # The bodies are placed as R(0) has them: axes of B are turned back by it.
            in_b = in_b @ R
        return in_a, in_b

    def driven_rows(self, sides: Sides, in_a: Array, in_b: Array) -> list[Row]:
        """R(t) e_i(A) stays across e_j(B); both are placed as R(0) has them."""
        if self.attitude is None:
            return []
        A, B, axis = sides.frame_a, sides.frame_b, self.attitude.axis
        return [
            # Against R(t) these are the rows of a fixed joint: no attitude is singular for them.
            Row(AttitudeRow.number, A, B, b=in_b[:, j], axis=axis(i, in_a))
            for i, j in NO_ROTATION
        ]


@JOINTS.in_files("revolute")
@entry()
class Revolute(HasFriction, DrivesAngle, JointWithAxis):
    """A hinge, whose coordinate is `angle` [rad]. Other parameters: see `Joint`.

    Parameters
    ----------
    axis : (3,)
        In space at the start.
    angle, angular_velocity, angular_acceleration : signal, optional [rad, rad/s, rad/s^2]
        One of them drives the hinge.
    friction : JointFriction, optional

    Examples
    --------
    >>> from duhamel.solver import Constant
    >>> motor = Revolute("ground", "hub", axis=[0.0, 0.0, 1.0], angular_velocity=Constant(5.0))
    >>> motor.is_driven
    True
    """

    translations: ClassVar = ALL_TRANSLATIONS
    rotations: ClassVar = ABOUT_E3
    free_angles: ClassVar = {"angle": ANGLE_ABOUT_E3}

    def validate(self) -> None:
        super().validate()
        friction = self.friction
        if friction is not None and friction.coefficient.static > 0.0 and friction.radius is None:
            raise self.error("friction: radius: a revolute joint needs one")
        if friction is not None and friction.force > 0.0:
            raise self.error("friction: force: a revolute joint takes a torque")

    def rubbing_row(self, A: int, B: int, in_a: Array, in_b: Array) -> Row:
        return Row(AngleRow.number, A, B, in_a[:, 0], in_a[:, 1], in_b[:, 0])

    def moved_about(self, D: Array) -> Array | None:
        return self.basis(D)[:, 2]


@JOINTS.in_files("universal")
@entry()
class Universal(DrivesAngle, JointWithAxis):
    """A cross of two axes, perpendicular at the start. Other parameters: see `Joint`.

    Its coordinates are `angle` [rad] about the first axis and `second_angle` about the second.

    Parameters
    ----------
    axis, second_axis : (3,)
        Fixed in the first and in the second frame; in space at the start.
    angle, angular_velocity, angular_acceleration : signal, optional [rad, rad/s, rad/s^2]
        One of them drives the first angle.
    second_angle : signal, optional [rad]

    Examples
    --------
    >>> Universal("a", "b", axis=[1.0, 0.0, 0.0], second_axis=[0.0, 1.0, 0.0]).coordinates
    ('angle', 'second_angle')
    """

    translations: ClassVar = ALL_TRANSLATIONS
    rotations: ClassVar = ((0, 1),)
    free_angles: ClassVar = {"angle": Angle(1, 2, 1), "second_angle": Angle(0, 2, 0, by_b=True)}

    second_axis: Direction
    second_angle: DrivingSignal | None = field(default=None, kw_only=True)

    @property
    def drives(self) -> dict[str, SmoothSignal]:
        drives = super().drives
        if self.second_angle is not None:
            drives["second_angle"] = self.second_angle
        return drives

    def validate(self) -> None:
        super().validate()
        if abs(self.axis_in_space @ self.second_axis) > 1e-9:
            raise self.error("the axes of a universal joint must be perpendicular at the start")

    def basis(self, D: Array) -> Array:
        first, second = self.axis_in_space, self.second_axis
        return np.column_stack([first, second, np.cross(first, second)])

    def driven_rows(self, sides: Sides, in_a: Array, in_b: Array) -> list[Row]:
        """The driven angles, both seen from the first frame."""
        rows, driven = self.observed(sides), []
        for name, drive in self.drives.items():
            row = replace(rows[name], drive=drive, reference=self.reference_coordinates.get(name))
            if self.free_angles[name].by_b:
                A, B = sides.frame_a, sides.frame_b
                # Seen from B, but the rows of one coupling have the same first frame.
                row = replace(row, kind=AngleOfA.number, frame_a=A, frame_b=B)
            driven.append(row)
        return driven


@JOINTS.in_files("cylindrical")
@entry()
class Cylindrical(DrivesAngle, DrivesDistance, JointWithAxis):
    """A joint that turns about an axis, and slides along it. Other parameters: see `Joint`.

    Its coordinates are `distance` [m] and `angle` [rad].

    Parameters
    ----------
    axis : (3,)
        In space at the start.
    distance, velocity, acceleration : signal, optional [m, m/s, m/s^2]
        One of them drives the distance.
    angle, angular_velocity, angular_acceleration : signal, optional [rad, rad/s, rad/s^2]
        One of them drives the angle.

    Examples
    --------
    >>> Cylindrical("ground", "piston", axis=[0.0, 0.0, 1.0]).coordinates
    ('distance', 'angle')
    """

    translations: ClassVar = (0, 1)
    rotations: ClassVar = ABOUT_E3
    free_distances: ClassVar = {"distance": 2}
    free_angles: ClassVar = {"angle": ANGLE_ABOUT_E3}
    drive_keys: ClassVar = DRIVES_BOTH


@JOINTS.in_files("prismatic")
@entry()
class Prismatic(HasFriction, DrivesDistance, JointWithAxis):
    """A slide, whose coordinate is `distance` [m]. Other parameters: see `Joint`.

    Parameters
    ----------
    axis : (3,)
        In space at the start.
    distance, velocity, acceleration : signal, optional [m, m/s, m/s^2]
        One of them drives the slide.
    friction : JointFriction, optional

    Examples
    --------
    >>> Prismatic("ground", "slider", axis=[1.0, 0.0, 0.0]).coordinates
    ('distance',)
    """

    translations: ClassVar = (0, 1)
    rotations: ClassVar = NO_ROTATION
    free_distances: ClassVar = {"distance": 2}

    def validate(self) -> None:
        super().validate()
        if self.friction is not None and self.friction.radius is not None:
            raise self.error("friction: radius: a prismatic joint takes none")
        if self.friction is not None and self.friction.torque > 0.0:
            raise self.error("friction: torque: a prismatic joint takes a force")

    def rubbing_row(self, A: int, B: int, in_a: Array, in_b: Array) -> Row:
        return Row(Translation.number, A, B, in_a[:, 2])


@JOINTS.in_files("planar")
@entry()
class Planar(JointWithAxis):
    """A joint that slides on a plane. Other parameters: see `Joint`.

    Coordinates: `angle` [rad] about the normal; `distance` [m] along the x axis of the first frame,
    projected on the plane (its y axis where x is within 26 degrees of the normal), and
    `second_distance` [m] across it.

    Parameters
    ----------
    axis : (3,)
        The normal of the plane, in space at the start.

    Examples
    --------
    >>> Planar("ground", "puck", axis=[0.0, 0.0, 1.0]).coordinates
    ('distance', 'second_distance', 'angle')
    """

    translations: ClassVar = (2,)
    rotations: ClassVar = ABOUT_E3
    free_distances: ClassVar = {"distance": 0, "second_distance": 1}
    free_angles: ClassVar = {"angle": ANGLE_ABOUT_E3}


@JOINTS.in_files("rod")
@entry()
class Rod(DrivesDistance):
    """A weightless bar between the origins of two frames. Other parameters: see `Joint`.

    Parameters
    ----------
    distance, velocity, acceleration : signal, optional [m, m/s, m/s^2]
        One of them drives the length, which is otherwise that of the start.

    Examples
    --------
    >>> Rod("ground", "bob").is_driven
    False
    """

    side_dependent: ClassVar[bool] = True

    def placed_distance(self, sides: Sides) -> float:
        return float(np.linalg.norm(sides.gap(self.basis(sides.pose_a.R))))

    def extra_rows(self, sides: Sides, in_a: Array, in_b: Array) -> list[Row]:
        length, A, B = length_of(self, sides), sides.frame_a, sides.frame_b
        if drive := self.drives_from(sides).get("distance"):
            return [Row(Distance.number, A, B, drive=drive, start=length)]
        return [Row(Distance.number, A, B, zero=length)]

    def driven_rows(self, sides: Sides, in_a: Array, in_b: Array) -> list[Row]:
        return []


@JOINTS.in_files("screw")
@entry()
class Screw(DrivesAngle, DrivesDistance, JointWithAxis):
    """A nut on a screw: distance = lead angle / 2 pi. Other parameters: see `Joint`.

    Parameters
    ----------
    axis : (3,)
        In space at the start.
    lead : float [m]
        The advance in a full turn, negative for a left-handed thread.
    distance, velocity, acceleration : signal, optional [m, m/s, m/s^2]
    angle, angular_velocity, angular_acceleration : signal, optional [rad, rad/s, rad/s^2]
        One of the six drives the screw.

    Examples
    --------
    >>> Screw("ground", "nut", axis=[1.0, 0.0, 0.0], lead=2e-3).lead
    0.002
    """

    translations: ClassVar = (0, 1)
    rotations: ClassVar = ABOUT_E3
    free_distances: ClassVar = {"distance": 2}
    free_angles: ClassVar = {"angle": ANGLE_ABOUT_E3}
    drive_keys: ClassVar = DRIVES_BOTH
    side_dependent: ClassVar[bool] = True

    lead: NotZero

    def validate(self) -> None:
        super().validate()
        if len(self.drives) > 1:
            raise self.error("a screw is driven by angle or distance, got both")

    def extra_rows(self, sides: Sides, in_a: Array, in_b: Array) -> list[Row]:
        rows = self.observed(sides)
        distance, angle, ratio = rows["distance"], rows["angle"], -self.lead / (2.0 * np.pi)
        offset = distance.start + ratio * angle.start
        # The nut keeps its place on the thread where the bodies are placed.
        distance = replace(distance, zero=distance.zero + offset, start=distance.start - offset)
        return [replace(distance, terms=(Term(angle, ratio, same_frames=True),))]


@JOINTS.in_files("constant_velocity")
@entry()
class ConstantVelocity(JointWithAxis):
    """A joint that transmits the rotation of a shaft without a change of speed.

        e_1(A) . e_2(B) - e_2(A) . e_1(B) = 0

    B turns against A about an axis across both shafts, e3(A) and e3(B). Other parameters: see
    `Joint`.

    Parameters
    ----------
    axis : (3,)
        The shaft of the first frame, in space at the start.
    second_axis : (3,), optional
        The shaft of the second frame, by default the same.

    Examples
    --------
    >>> ConstantVelocity("gearbox", "wheel", axis=[0.0, 1.0, 0.0]).coordinates
    ()
    """

    translations: ClassVar = ALL_TRANSLATIONS
    side_dependent: ClassVar[bool] = True
    has_branches: ClassVar[bool] = True

    second_axis: OptionalDirection = NO_ARRAY

    def validate(self) -> None:
        super().validate()
        axis, second = self.axis_in_space, self.second_axis
        if second is not None and axis @ second < -SPAN_A_PLANE:
            raise self.error(
                f"second_axis: the shafts of a {self.type} joint must not point against each "
                f"other, got axis = {axis.tolist()}, second_axis = {second.tolist()}"
            )

    def carried(self, basis: Array, sides: Sides) -> tuple[Array, Array]:
        in_a, _ = sides.carried(basis)
        return in_a, sides.pose_b.R.T @ bent(basis, self.second_axis)

    def extra_rows(self, sides: Sides, in_a: Array, in_b: Array) -> list[Row]:
        A, B = sides.frame_a, sides.frame_b
        # With R_ij = e_i(A) . e_j(B), R_12 - R_21 is the part of the axis of rotation along e3.
        across = Row(Rotation.number, A, B, in_a[:, 1], b=in_b[:, 0])
        rows_12 = Row(Rotation.number, A, B, in_a[:, 0], b=in_b[:, 1])
        return [replace(rows_12, terms=(Term(across, -1.0, same_frames=True),))]


@JOINTS.in_files("point_on_line")
@entry()
class PointOnLine(DrivesDistance, SideDependent, JointWithAxis):
    """The origin of the second frame stays on a line that the first carries.

    The coordinate is `distance` [m] along the line. Other parameters: see `Joint`.

    Parameters
    ----------
    axis : (3,)
        Along the line, which is through the first frame; in space at the start.
    distance, velocity, acceleration : signal, optional [m, m/s, m/s^2]
        One of them drives the distance.

    Examples
    --------
    >>> PointOnLine("rail", "bead", axis=[1.0, 0.0, 0.0]).coordinates
    ('distance',)
    """

    translations: ClassVar = (0, 1)
    free_distances: ClassVar = {"distance": 2}


@JOINTS.in_files("point_on_plane")
@entry()
class PointOnPlane(SideDependent, JointWithAxis):
    """The origin of the second frame stays on a plane that the first carries.

    The coordinates are `distance` and `second_distance` [m], as of `Planar`. Other parameters: see
    `Joint`.

    Parameters
    ----------
    axis : (3,)
        The normal of the plane, which is through the first frame; in space at the start.

    Examples
    --------
    >>> PointOnPlane("table", "foot", axis=[0.0, 0.0, 1.0]).coordinates
    ('distance', 'second_distance')
    """

    translations: ClassVar = (2,)
    free_distances: ClassVar = {"distance": 0, "second_distance": 1}


@JOINTS.in_files("rolling_disc")
@entry()
class RollingDisc(JointWithAxis):
    """A disc of the second frame whose sharp rim rolls without slip on a plane of the first.

    It never lifts off: take a `Contact` with friction for wheels that do, or that slide. The
    multipliers are the normal force, the force along the heading, `second_axis` x `axis`, and that
    across it [N]. Other parameters: see `Joint`. Source: docs/theory.md, Rolling.

    Parameters
    ----------
    axis : (3,)
        The normal of the plane, which is through the first frame; in space at the start.
    second_axis : (3,)
        The axle of the disc, through the second frame; in space at the start.
    radius : float [m]
        Of the rim.

    Examples
    --------
    >>> RollingDisc("ground.road", "wheel", [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], radius=0.3).radius
    0.3
    """

    side_dependent: ClassVar[bool] = True

    second_axis: Direction
    radius: Positive

    def validate(self) -> None:
        super().validate()
        normal, axle = self.axis_in_space, self._axle
        if abs(normal @ axle) > LYING_FLAT:
            raise self.error(
                "second_axis: the axle must not be along the normal of the plane, got axis = "
                f"{normal.tolist()}, second_axis = {axle.tolist()}"
            )

    @property
    def _axle(self) -> Array:
        return np.asarray(self.second_axis)

    def extra_rows(self, sides: Sides, in_a: Array, in_b: Array) -> list[Row]:
        axle, numbers = sides.pose_b.R.T @ self._axle, [self.radius]
        return [
            Row(kind.number, sides.frame_a, sides.frame_b, in_a[:, 2], b=axle, parameters=numbers)
            for kind in (Touch, Roll, SideSlip)
        ]

    def loaded_by_moments(self, rows: Sequence[Row]) -> Mapping[str, str]:
        # The force acts where the rim touches, away from both frames.
        return dict.fromkeys(side_names(self), self.described)

    def check_opening(self, sides: Sides, limit: float) -> None:
        """`ModelError` where the rim does not touch the plane at the start."""
        normal = self.axis_in_space
        height = float(normal @ (sides.pose_b.x - sides.pose_a.x))
        upright = np.sqrt(1.0 - (normal @ self._axle) ** 2)
        opening = height - self.radius * float(upright)
        if abs(opening) > limit:
            first, second = self.between
            raise self.error(
                f"its rim is {opening:.6g} m above the plane at the start: {second} is "
                f"{height:.6g} m above {first}, expected {height - opening:.6g}; assemble = true "
                "would close it"
            )


def bent(basis: Array, second_axis: Array | None) -> Array:
    """Axes (3, 3) turned by the shortest way until e3 is along another unit vector."""
    if second_axis is None:
        return basis
    e3 = basis[:, 2]
    # Two half turns, about e3 and about the bisector, are the shortest rotation from e3 to the
    # second axis.
    middle = (e3 + second_axis) / np.linalg.norm(e3 + second_axis)
    half_turn = np.outer(middle, 2.0 * middle) - np.eye(3)
    turned: Array = half_turn @ (np.outer(e3, 2.0 * e3) - np.eye(3)) @ basis
    return turned
