"""The rows of joints, motions and springs as arrays, seen from the frames at the start."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..arrays import Array, Index, as_index, as_rows
from ..couplings.contacts import Contact
from ..couplings.couplers import JointCoupler
from ..couplings.joints import ABOUT_E3, NO_ROTATION, TURN, Joint, basis_about, bent
from ..couplings.motions import PrescribedDisplacement, PrescribedMotion, PrescribedOrientation
from ..couplings.motors import JointMotor, Motor
from ..couplings.springs import Spring
from ..couplings.stops import JointStop
from ..laws.law import ForceLaw
from ..model.model import Coupling
from ..signals.attitude import Attitude as Rotations
from ..signals.curves import Constant
from ..signals.drives import IntegratedDrive
from ..signals.orientations import OrientationDrive
from ..signals.signal import SmoothSignal
from ..step.gaps import FirstSlip, Gap, SecondSlip
from ..step.rows import Angle, AngleOfA, Attitude, Distance, Rotation, Translation
from ..step.system import Couplings, Friction, Laws, Motors, Rows, Terms
from .contacts import SHAPES, contact_axes, shape_parameters, size_of
from .friction import Bristle, normal_weights
from .placement import Pose

COINCIDENT = 1e-12
"""distance of points, relative to their coordinates, that has lost its direction by rounding"""


@dataclass(frozen=True, eq=False)
class Row:
    """One row between frames A and B, by their numbers, with its drive or its law."""

    kind: int
    frame_a: int
    frame_b: int
    a: Array = field(default_factory=lambda: np.zeros(3))
    a_turned: Array = field(default_factory=lambda: np.zeros(3))
    b: Array = field(default_factory=lambda: np.zeros(3))
    drive: SmoothSignal | None = None
    start: float = 0.0
    rest: float = 0.0
    stiffness: Array | None = None
    damping: Array | None = None
    laws: tuple[ForceLaw, ...] = ()
    swapped: bool = False
    """frame A is the second that the coupling names"""
    shape: int = 0
    parameters: Sequence[float] = ()
    """of the shape of a contact"""
    size: float = math.inf
    """of a contact's ball and shape"""
    normal: tuple[float, int] = (0.0, 0)
    """weight and group in the normal force of friction"""
    rubs: bool = False
    """has friction"""
    motor: Motor | None = None
    zero: float = 0.0
    """what the coordinate is measured from"""
    axis: tuple[SmoothSignal, ...] = ()
    """the components of a, of a row of an attitude"""
    drawn: float | None = None
    """the coordinate where the bodies are placed, of a driven one unless it is the drive's start"""
    terms: tuple["Term", ...] = ()

    @property
    def drives(self) -> tuple[SmoothSignal, ...]:
        return self.axis if self.drive is None else (self.drive,)

    @property
    def compliant(self) -> bool:
        """Obeys a law, and is no constraint."""
        follows_law = self.stiffness is not None or bool(self.laws) or self.motor is not None
        return follows_law or self.rubs


@dataclass(frozen=True, eq=False)
class Term:
    """The coordinate of another row that joins a constraint, times a ratio."""

    row: Row
    ratio: float
    own: bool = False
    """between the frames of the coupling itself"""


@dataclass(frozen=True, eq=False)
class Sides:
    """The two frames of a coupling: numbers and poses at the start."""

    frame_a: int
    frame_b: int
    pose_a: Pose
    pose_b: Pose
    fixed_a: bool = False
    """frame A is fixed in space"""

    def swapped(self) -> "Sides":
        return Sides(self.frame_b, self.frame_a, self.pose_b, self.pose_a)

    def carried(self, basis: Array) -> tuple[Array, Array]:
        """Axes in space at the start, in the axes of frames A and B."""
        return self.pose_a.R.T @ basis, self.pose_b.R.T @ basis

    def gap(self, basis: Array) -> Array:
        """r_B - r_A at the start along axes in space."""
        gap: Array = basis.T @ (self.pose_b.x - self.pose_a.x)
        return gap


def coupling_rows(coupling: Coupling, sides: Sequence[Sides]) -> list[Row]:
    """The rows of a coupling, in the order of its coordinates or constraints.

    sides: its own; of a coupler those of its joints.
    """
    if isinstance(coupling, JointCoupler):
        return coupler_rows(coupling, sides)
    if isinstance(coupling, Contact):
        return contact_rows(coupling, sides[0])
    if isinstance(coupling, JointStop):
        return stop_rows(coupling, sides[0])
    if isinstance(coupling, JointMotor):
        return motor_rows(coupling, sides[0])
    if isinstance(coupling, Joint):
        return joint_rows(coupling, sides[0])
    if isinstance(coupling, Spring):
        return spring_rows(coupling, sides[0])
    return motion_rows(coupling, sides[0])


def joint_rows(joint: Joint, sides: Sides) -> list[Row]:
    """Constraints of a joint: its table, a row of its own, then its drives; at last its friction.

    The axes of a joint with the ground are carried by the body, as its other vectors are: rows are
    the same from both sides, e_i(A) . e_j(B) as e_j(B) . e_i(A).
    """
    kind, rotations = joint.kind, joint.kind.rotations
    basis = joint.basis(sides.pose_a.R)
    drives = joint_drives(joint, sides)
    in_a, in_b = _carried(joint, basis, sides)
    driven = bool(drives) or joint.attitude is not None
    turned = sides.fixed_a and not (driven or kind.sided or kind.own)
    if turned:
        sides, rotations = sides.swapped(), tuple((j, i) for i, j in rotations)
        in_a, in_b = in_b, in_a
    A, B = sides.frame_a, sides.frame_b
    rows = [Row(Translation.number, A, B, in_a[:, k]) for k in kind.translations]
    rows += [Row(Rotation.number, A, B, in_a[:, i], b=in_b[:, j]) for i, j in rotations]
    if joint.friction is not None:
        weights = normal_weights(joint, joint.friction)
        rows = [replace(row, normal=n) for row, n in zip(rows, weights, strict=True)]
    rows += _own_rows(joint, sides, in_a, in_b)
    if "distance" in drives and kind.own != "rod":
        row = joint_observers(joint, sides)["distance"]
        rows.append(replace(row, drive=drives["distance"], drawn=joint.drawn.get("distance")))
    if "angle" in drives and joint.type != "universal":
        drawn = joint.drawn.get("angle")
        rows.append(_driven_angle(A, B, in_a, in_b, drives["angle"], drawn))
    if joint.type == "universal":
        rows += _driven_angles(joint, sides)
    if joint.attitude is not None:
        rows += _attitude_rows(joint.attitude, A, B, in_a, in_b)
    if joint.friction is not None and joint.type == "revolute":
        rows.append(Row(Angle.number, A, B, in_a[:, 0], in_a[:, 1], in_b[:, 0], rubs=True))
    elif joint.friction is not None:
        rows.append(Row(Translation.number, A, B, in_a[:, 2], rubs=True))
    return [replace(row, swapped=turned) if turned else row for row in rows]


def joint_drives(joint: Joint, sides: Sides) -> dict[str, SmoothSignal]:
    """The signals of driven coordinates; a distance that is integrated starts where it is."""
    drives = joint.drives
    distance = drives.get("distance")
    if isinstance(distance, IntegratedDrive) and "distance" not in joint.drawn:
        gap = sides.gap(joint.basis(sides.pose_a.R))
        placed = float(np.linalg.norm(gap) if joint.kind.own == "rod" else gap[2])
        drives["distance"] = distance.starting_at(placed)
    return drives


def _carried(joint: Joint, basis: Array, sides: Sides) -> tuple[Array, Array]:
    """Axes of the first frame and of the second at the start, in those of the frames."""
    in_a, in_b = sides.carried(basis)
    if joint.kind.own == "constant velocity":
        in_b = sides.pose_b.R.T @ bent(basis, joint.second_axis)
    if joint.attitude is not None:
        R, _, _ = joint.attitude.rotation(0.0)
        in_b = in_b @ R
    return in_a, in_b


def _own_rows(joint: Joint, sides: Sides, in_a: Array, in_b: Array) -> list[Row]:
    """The row of a joint that no table makes: of a rod, a screw, a constant-velocity joint."""
    A, B, own = sides.frame_a, sides.frame_b, joint.kind.own
    if own == "rod":
        length = _length(joint, sides)
        if drive := joint_drives(joint, sides).get("distance"):
            return [Row(Distance.number, A, B, drive=drive, start=length)]
        return [Row(Distance.number, A, B, zero=length)]
    if own == "screw":
        rows = joint_observers(joint, sides)
        distance, ratio = rows["distance"], -(joint.lead or 0.0) / (2.0 * np.pi)
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


def _length(coupling: Joint | Spring, sides: Sides) -> float:
    """The distance of two frames at the start, which must not be zero."""
    length = float(np.linalg.norm(sides.gap(np.eye(3))))
    if length <= COINCIDENT * float(np.abs([sides.pose_a.x, sides.pose_b.x]).max()):
        raise coupling.error(f"its ends {list(coupling.between)} coincide at the start")
    return length


def _driven_angle(
    A: int, B: int, in_a: Array, in_b: Array, angle: SmoothSignal, drawn: float | None = None
) -> Row:
    """The row of a driven angle: e1(A), turned about e3 by the signal, stays across an axis of B.

    That axis is e2 turned by minus the angle where the bodies are placed, by default angle(0).
    """
    start = angle(0.0) if drawn is None else drawn
    e2 = np.cos(start) * in_b[:, 1] - np.sin(start) * in_b[:, 0]
    return Row(Rotation.number, A, B, in_a[:, 0], in_a[:, 1], e2, drive=angle, drawn=drawn)


def _driven_angles(joint: Joint, sides: Sides) -> list[Row]:
    """The rows of the driven angles of a universal joint, all from its first frame."""
    rows, driven = joint_observers(joint, sides), []
    for name, drive in joint.drives.items():
        row = replace(rows[name], drive=drive, drawn=joint.drawn.get(name))
        if joint.kind.angles[name].by_b:
            A, B = sides.frame_a, sides.frame_b
            row = replace(row, kind=AngleOfA.number, frame_a=A, frame_b=B)
        driven.append(row)
    return driven


def _attitude_rows(attitude: Rotations, A: int, B: int, in_a: Array, in_b: Array) -> list[Row]:
    """R(t) e_i(A) stays across e_j(B), which are where the bodies are placed as R(0) has them."""
    return [
        Row(Attitude.number, A, B, b=in_b[:, j], axis=attitude.axis(i, in_a))
        for i, j in NO_ROTATION
    ]


def joint_observers(joint: Joint, sides: Sides) -> dict[str, Row]:
    """The coordinates that a joint leaves free or drives, by name."""
    basis = joint.basis(sides.pose_a.R)
    in_a, in_b = sides.carried(basis)
    gap = sides.gap(basis)
    rows = {}
    for name, k in joint.kind.distances.items():
        start = joint.drawn_at(name, float(gap[k]))
        zero = float(gap[k]) - start if name in joint.drawn else 0.0
        A, B = sides.frame_a, sides.frame_b
        rows[name] = Row(Translation.number, A, B, in_a[:, k], start=start, zero=zero)
    for name, angle in joint.kind.angles.items():
        start = joint.drawn_at(name, 0.0)
        axes, other, A, B = in_a, in_b, sides.frame_a, sides.frame_b
        if angle.by_b:
            axes, other, A, B = other, axes, B, A
        b, zero = other[:, angle.i], -start
        if angle == TURN:
            # at the start e_j is e_i turned towards e_k by the starting angle
            b, zero = np.cos(start) * b + np.sin(start) * other[:, angle.k], 0.0
        row = Row(Angle.number, A, B, axes[:, angle.i], axes[:, angle.k], b, start=start)
        rows[name] = replace(row, zero=zero)
    return rows


def coupler_rows(coupling: JointCoupler, sides: Sequence[Sides]) -> list[Row]:
    """One row: the first coordinate and, by their ratios to it, the others.

    q_1 + sum_k (ratio_k / ratio_1) q_k = offset / ratio_1
    """
    observers = [joint_observers(j, s) for j, s in zip(coupling.joints, sides, strict=True)]
    coordinates = zip(observers, coupling.coordinates, strict=True)
    first, *others = (rows[name] for rows, name in coordinates)
    ratios = [ratio / coupling.ratios[0] for ratio in coupling.ratios[1:]]
    terms = tuple(Term(row, ratio) for row, ratio in zip(others, ratios, strict=True))
    drawn = first.start + sum(term.ratio * term.row.start for term in terms)
    offset = coupling.coupler.offset
    if offset is not None and not isinstance(offset, Constant):
        return [replace(first, terms=terms, drive=coupling.scaled(offset), drawn=drawn)]
    value = drawn if offset is None else offset(0.0) / coupling.ratios[0]
    return [replace(first, terms=terms, zero=first.zero + value, start=first.start - value)]


def motion_rows(motion: PrescribedMotion, sides: Sides) -> list[Row]:
    """Driven rows against the frame fixed in space where the moving frame starts.

    A displacement is one translation; a rotation keeps its axis, as a revolute joint does, and
    drives the angle.
    """
    A, B = sides.frame_a, sides.frame_b
    if isinstance(motion, PrescribedDisplacement):
        return [
            Row(
                Translation.number,
                A,
                B,
                sides.pose_a.R.T @ motion.direction,
                drive=motion.drive,
            )
        ]
    if isinstance(motion, PrescribedOrientation):
        return _oriented(motion, sides)
    in_a, in_b = sides.carried(basis_about(motion.axis, sides.pose_a.R))
    rows = [Row(Rotation.number, A, B, in_a[:, i], b=in_b[:, j]) for i, j in ABOUT_E3]
    return [*rows, _driven_angle(A, B, in_a, in_b, motion.drive)]


def _oriented(motion: PrescribedOrientation, sides: Sides) -> list[Row]:
    """The rows of an orientation, see solver/signals/orientations.py."""
    in_a, in_b = sides.carried(np.eye(3))
    A, B, angles = sides.frame_a, sides.frame_b, motion.drives
    return [
        Row(
            Rotation.number,
            A,
            B,
            in_a[:, (j + 1) % 3],
            -in_a[:, j],
            in_b[:, j],
            drive=OrientationDrive(angles, j, motion.owner),
        )
        for j in (1, 2, 0)
    ]


def spring_rows(spring: Spring, sides: Sides) -> list[Row]:
    """The coordinates of a spring with their law."""
    kind, basis = spring.kind, spring.basis(sides.pose_a.R)
    in_a, in_b = sides.carried(basis)
    A, B = sides.frame_a, sides.frame_b
    gap = sides.gap(basis)
    rows = []
    if kind.distance:
        rows.append(Row(Distance.number, A, B, start=_length(spring, sides)))
    rows += [
        Row(Translation.number, A, B, in_a[:, k], start=float(gap[k])) for k in kind.translations
    ]
    rows += [Row(Angle.number, A, B, in_a[:, t.i], in_a[:, t.k], in_b[:, t.j]) for t in kind.angles]
    rows += [Row(Rotation.number, A, B, in_a[:, i], b=in_b[:, j]) for i, j in kind.rotations]
    rest = np.array([row.start for row in rows]) if spring.rest is None else spring.rest
    return [
        replace(
            row,
            rest=float(rest[i]),
            stiffness=spring.stiffness[i],
            damping=spring.damping[i],
            laws=spring.laws_of_rows[i],
        )
        for i, row in enumerate(rows)
    ]


def contact_rows(contact: Contact, sides: Sides) -> list[Row]:
    """The gap, and slip along two tangents where there is friction."""
    axis, across = contact_axes(contact, sides.pose_a.R)
    A, B, shape = sides.frame_a, sides.frame_b, SHAPES[contact.shape]
    parameters, size = shape_parameters(contact), size_of(contact)
    gap = Row(Gap.number, A, B, axis, across, laws=(contact.law(),), normal=(1.0, 0))
    slips = [Row(kind.number, A, B, axis, across, rubs=True) for kind in (FirstSlip, SecondSlip)]
    rows = [gap, *slips] if contact.friction is not None else [gap]
    return [replace(row, shape=shape, parameters=parameters, size=size) for row in rows]


def stop_rows(coupling: JointStop, sides: Sides) -> list[Row]:
    """The joint coordinate with the law beyond its limits."""
    stop = coupling.stop
    row = joint_observers(coupling.joint, sides)[stop.coordinate]
    law = stop.impact.beyond(stop.range)
    return [replace(row, laws=(law,), swapped=row.frame_a != sides.frame_a)]


def motor_rows(coupling: JointMotor, sides: Sides) -> list[Row]:
    """The joint coordinate with its motor."""
    row = joint_observers(coupling.joint, sides)[coupling.motor.coordinate]
    return [replace(row, motor=coupling.motor, swapped=row.frame_a != sides.frame_a)]


def lay_out_rows(rows: Sequence[Row]) -> Rows:
    return Rows(
        kind=as_index([row.kind for row in rows]),
        frame_a=as_index([row.frame_a for row in rows]),
        frame_b=as_index([row.frame_b for row in rows]),
        a=as_rows([row.a for row in rows]),
        a_turned=as_rows([row.a_turned for row in rows]),
        b=as_rows([row.b for row in rows]),
        shape=as_index([row.shape for row in rows]),
        size=np.array([row.size for row in rows], dtype=np.float64),
        first=as_index(np.cumsum([0, *(len(row.parameters) for row in rows)])),
        parameters=np.array([x for row in rows for x in row.parameters], dtype=np.float64),
        zero=np.array([row.zero for row in rows], dtype=np.float64),
        axis=np.full(len(rows), -1, dtype=np.int64),
    )


def _first_drives(drives: Sequence[Sequence[SmoothSignal]]) -> Index:
    """The number of the first drive of each row, -1 of those that have none."""
    first = np.cumsum([0, *map(len, drives)])[:-1]
    return as_index(np.where([bool(signals) for signals in drives], first, -1))


def _lay_out_terms(couplings: Sequence[list[Row]]) -> Terms:
    """The terms of all rows, in their order."""
    terms = [
        (term, i, j)
        for j, rows in enumerate(couplings)
        for i, row in enumerate(rows)
        for term in row.terms
    ]
    before = np.cumsum([0, *map(len, couplings)])
    return Terms(
        rows=lay_out_rows([term.row for term, _, _ in terms]),
        ratio=np.array([term.ratio for term, _, _ in terms], dtype=np.float64),
        row=as_index([before[j] + i for _, i, j in terms]),
        number=as_index([i for _, i, _ in terms]),
        own=as_index([j if term.own else -1 for term, _, j in terms]),
        range=as_index(np.cumsum([0, *(len(row.terms) for rows in couplings for row in rows)])),
    )


def lay_out_couplings(
    couplings: Sequence[list[Row]], bristles: Sequence[Bristle | None], contacts: Sequence[bool]
) -> tuple[Couplings, list[SmoothSignal]]:
    """The rows of all couplings one after the other, and the signals that drive some of them.

    bristles: of each coupling; contacts: whether it is one.
    """
    rows = [row for coupling in couplings for row in coupling]
    drives = [drive for row in rows for drive in row.drives]
    first = _first_drives([row.drives for row in rows])
    attitudes = np.array([bool(row.axis) for row in rows], dtype=bool)
    rub = [any(row.rubs for row in coupling) for coupling in couplings]
    laid_out = Couplings(
        rows=lay_out_rows(rows).replace(axis=np.where(attitudes, first, -1)),
        terms=_lay_out_terms(couplings),
        laws=_lay_out_laws(rows),
        friction=_lay_out_friction(rows, [bristle for bristle in bristles if bristle]),
        friction_of=_numbers(rub),
        contact=as_index(np.flatnonzero(contacts)),
        contact_of=_numbers(contacts),
        switching=as_index(np.flatnonzero(np.array(contacts, bool) | np.array(rub, bool))),
        n_compliant=sum(row.compliant for row in rows),
        range=as_index(np.cumsum([0, *(len(coupling) for coupling in couplings)])),
        second=as_index([0 if row.swapped else 6 for row in rows]),
        drive=first,
        driven=as_index(np.repeat(np.arange(len(rows)), [len(row.drives) for row in rows])),
        compliant=as_index([row.compliant for row in rows]),
    )
    return laid_out, drives


def _numbers(chosen: Sequence[bool]) -> Index:
    """The number of each among those that are chosen, -1 of the others."""
    return as_index(np.where(chosen, np.cumsum(chosen) - 1, -1))


def _lay_out_friction(rows: Sequence[Row], bristles: Sequence[Bristle]) -> Friction:
    rub = np.array([row.rubs for row in rows], dtype=bool)
    first = np.flatnonzero(np.diff(rub.astype(int), prepend=0) == 1).tolist()
    coefficients = [bristle.coefficient for bristle in bristles]
    return Friction(
        first=as_index(first),
        n=as_index([int(np.argmin([*rub[i:], False])) for i in first]),
        static=np.array([mu.static for mu in coefficients], dtype=float),
        sliding=np.array([mu.sliding for mu in coefficients], dtype=float),
        speed=np.array([mu.speed for mu in coefficients], dtype=float),
        stiffness=np.array([bristle.stiffness for bristle in bristles], dtype=float),
        damping=np.array([bristle.damping for bristle in bristles], dtype=float),
        viscous=np.array([bristle.viscous for bristle in bristles], dtype=float),
        preload=np.array([bristle.preload for bristle in bristles], dtype=float),
        weight=np.array([row.normal[0] for row in rows], dtype=float),
        group=as_index([row.normal[1] for row in rows]),
    )


def _lay_out_laws(rows: Sequence[Row]) -> Laws:
    laws = [law for row in rows for law in row.laws]
    parameters = [law.parameters() for law in laws]
    return Laws(
        rest=np.array([row.rest for row in rows], dtype=np.float64),
        stiffness=_six_wide([row.stiffness for row in rows]),
        damping=_six_wide([row.damping for row in rows]),
        range=as_index(np.cumsum([0, *(len(row.laws) for row in rows)])),
        number=as_index([law.number for law in laws]),
        first=as_index(np.cumsum([0, *map(len, parameters)])),
        parameters=np.array([number for numbers in parameters for number in numbers], dtype=float),
        memory=as_index(np.cumsum([0, *(len(law.memories()) for law in laws)])),
        motor=_numbers([row.motor is not None for row in rows]),
        motors=_lay_out_motors(rows),
    )


def _lay_out_motors(rows: Sequence[Row]) -> Motors:
    motors = [row.motor for row in rows if row.motor is not None]
    limits = [(-np.inf, np.inf) if motor.limit is None else motor.limit for motor in motors]
    speeds = [np.inf if motor.speed is None else motor.speed for motor in motors]
    return Motors(
        row=as_index([i for i, row in enumerate(rows) if row.motor is not None]),
        stiffness=np.array([motor.stiffness for motor in motors], dtype=float),
        damping=np.array([motor.damping for motor in motors], dtype=float),
        integral=np.array([motor.integral for motor in motors], dtype=float),
        lower=np.array([lower for lower, _ in limits], dtype=float),
        upper=np.array([upper for _, upper in limits], dtype=float),
        speed=np.array(speeds, dtype=float),
        tracking=np.array([motor.tracking for motor in motors], dtype=float),
    )


def _six_wide(vectors: Sequence[Array | None]) -> Array:
    out = np.zeros((len(vectors), 6))
    for i, vector in enumerate(vectors):
        if vector is not None:
            out[i, : len(vector)] = vector
    return out
