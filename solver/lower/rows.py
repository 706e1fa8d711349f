"""The rows of joints, motions and springs as arrays, seen from the frames at the start."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..arrays import Array, Index, as_index, as_rows
from ..laws.law import ForceLaw
from ..model.contacts import Contact
from ..model.drives import IntegratedDrive
from ..model.joints import ABOUT_E3, Joint, basis_about
from ..model.model import Coupling
from ..model.motions import PrescribedDisplacement, PrescribedMotion, PrescribedOrientation
from ..model.orientations import OrientationDrive
from ..model.signals import SmoothSignal
from ..model.springs import Spring
from ..model.stops import JointStop
from ..step.gaps import FirstSlip, Gap, SecondSlip
from ..step.rows import Angle, Distance, Rotation, Translation
from ..step.system import Couplings, Friction, Laws, Rows
from .contacts import SHAPES, contact_axes, shape_parameters
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
    normal: tuple[float, int] = (0.0, 0)
    """weight and group in the normal force of friction"""
    rubs: bool = False
    """has friction"""

    @property
    def compliant(self) -> bool:
        """Obeys a law, and is no constraint."""
        return self.stiffness is not None or bool(self.laws) or self.rubs


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


def coupling_rows(coupling: Coupling, sides: Sides) -> list[Row]:
    """The rows of a coupling, in the order of its coordinates or constraints."""
    if isinstance(coupling, Contact):
        return contact_rows(coupling, sides)
    if isinstance(coupling, JointStop):
        return stop_rows(coupling, sides)
    if isinstance(coupling, Joint):
        return joint_rows(coupling, sides)
    if isinstance(coupling, Spring):
        return spring_rows(coupling, sides)
    return motion_rows(coupling, sides)


def joint_rows(joint: Joint, sides: Sides) -> list[Row]:
    """Constraints of a joint: its table, then its drives; at last its friction.

    The axes of a joint with the ground are carried by the body, as its other vectors are: rows are
    the same from both sides, e_i(A) . e_j(B) as e_j(B) . e_i(A).
    """
    kind, rotations = joint.kind, joint.kind.rotations
    basis = joint.basis(sides.pose_a.R)
    drives = joint_drives(joint, sides)
    turned = sides.fixed_a and not drives
    if turned:
        sides, rotations = sides.swapped(), tuple((j, i) for i, j in rotations)
    in_a, in_b = sides.carried(basis)
    A, B = sides.frame_a, sides.frame_b
    rows = [Row(Translation.number, A, B, in_a[:, k]) for k in kind.translations]
    rows += [Row(Rotation.number, A, B, in_a[:, i], b=in_b[:, j]) for i, j in rotations]
    if joint.friction is not None:
        weights = normal_weights(joint, joint.friction)
        rows = [replace(row, normal=n) for row, n in zip(rows, weights, strict=True)]
    if "distance" in drives:
        rows.append(Row(Translation.number, A, B, in_a[:, 2], drive=drives["distance"]))
    if "angle" in drives:
        rows.append(_driven_angle(A, B, in_a, in_b, drives["angle"]))
    if joint.friction is not None and joint.type == "revolute":
        rows.append(Row(Angle.number, A, B, in_a[:, 0], in_a[:, 1], in_b[:, 0], rubs=True))
    elif joint.friction is not None:
        rows.append(Row(Translation.number, A, B, in_a[:, 2], rubs=True))
    return [replace(row, swapped=turned) for row in rows]


def joint_drives(joint: Joint, sides: Sides) -> dict[str, SmoothSignal]:
    """The signals of driven coordinates; a distance that is integrated starts where it is."""
    drives = joint.drives
    distance = drives.get("distance")
    if isinstance(distance, IntegratedDrive):
        drives["distance"] = distance.starting_at(float(sides.gap(joint.basis(sides.pose_a.R))[2]))
    return drives


def _driven_angle(A: int, B: int, in_a: Array, in_b: Array, angle: SmoothSignal) -> Row:
    """The row of a driven angle: e1(A), turned about e3 by the signal, stays across an axis of B.

    That axis is e2 turned by -angle(0).
    """
    start = angle(0.0)
    e2 = np.cos(start) * in_b[:, 1] - np.sin(start) * in_b[:, 0]
    return Row(Rotation.number, A, B, in_a[:, 0], in_a[:, 1], e2, drive=angle)


def joint_observers(joint: Joint, sides: Sides) -> dict[str, Row]:
    """The coordinates that a joint leaves free or drives, by name."""
    in_a, in_b = sides.carried(joint.basis(sides.pose_a.R))
    rows = {
        name: Row(Translation.number, sides.frame_a, sides.frame_b, in_a[:, k])
        for name, k in joint.kind.distances.items()
    }
    for name, angle in joint.kind.angles.items():
        start = joint.drives[name](0.0) if name in joint.drives else 0.0
        axes, other, A, B = in_a, in_b, sides.frame_a, sides.frame_b
        if angle.by_b:
            axes, other, A, B = other, axes, B, A
        # at the start e_j is e_i turned towards e_k by the starting angle
        along, across = other[:, angle.i], other[:, angle.k]
        b = np.cos(start) * along + np.sin(start) * across
        rows[name] = Row(Angle.number, A, B, axes[:, angle.i], axes[:, angle.k], b, start=start)
    return rows


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
    """The rows of an orientation, see solver/model/orientations.py."""
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
        for j in range(3)
    ]


def spring_rows(spring: Spring, sides: Sides) -> list[Row]:
    """The coordinates of a spring with their law."""
    kind, basis = spring.kind, spring.basis(sides.pose_a.R)
    in_a, in_b = sides.carried(basis)
    A, B = sides.frame_a, sides.frame_b
    gap = sides.gap(basis)
    rows = []
    if kind.distance:
        length = float(np.linalg.norm(gap))
        if length <= COINCIDENT * float(np.abs([sides.pose_a.x, sides.pose_b.x]).max()):
            ends = list(spring.between)
            raise spring.error(f"its ends {ends} coincide at the start")
        rows.append(Row(Distance.number, A, B, start=length))
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
    parameters = shape_parameters(contact)
    gap = Row(Gap.number, A, B, axis, across, laws=(contact.law(),), normal=(1.0, 0))
    slips = [Row(kind.number, A, B, axis, across, rubs=True) for kind in (FirstSlip, SecondSlip)]
    rows = [gap, *slips] if contact.friction is not None else [gap]
    return [replace(row, shape=shape, parameters=parameters) for row in rows]


def stop_rows(coupling: JointStop, sides: Sides) -> list[Row]:
    """The joint coordinate with the law beyond its limits."""
    stop = coupling.stop
    row = joint_observers(coupling.joint, sides)[stop.coordinate]
    law = stop.impact.beyond(stop.range)
    return [replace(row, laws=(law,), swapped=row.frame_a != sides.frame_a)]


def lay_out_rows(rows: Sequence[Row]) -> Rows:
    return Rows(
        kind=as_index([row.kind for row in rows]),
        frame_a=as_index([row.frame_a for row in rows]),
        frame_b=as_index([row.frame_b for row in rows]),
        a=as_rows([row.a for row in rows]),
        a_turned=as_rows([row.a_turned for row in rows]),
        b=as_rows([row.b for row in rows]),
        shape=as_index([row.shape for row in rows]),
        first=as_index(np.cumsum([0, *(len(row.parameters) for row in rows)])),
        parameters=np.array([x for row in rows for x in row.parameters], dtype=np.float64),
    )


def lay_out_couplings(
    couplings: Sequence[list[Row]], bristles: Sequence[Bristle | None], contacts: Sequence[bool]
) -> tuple[Couplings, list[SmoothSignal]]:
    """The rows of all couplings one after the other, and the signals that drive some of them.

    bristles: of each coupling; contacts: whether it is one.
    """
    rows = [row for coupling in couplings for row in coupling]
    drives = [row.drive for row in rows if row.drive is not None]
    numbers = iter(range(len(drives)))
    rub = [any(row.rubs for row in coupling) for coupling in couplings]
    laid_out = Couplings(
        rows=lay_out_rows(rows),
        laws=_lay_out_laws(rows),
        friction=_lay_out_friction(rows, [bristle for bristle in bristles if bristle]),
        friction_of=_numbers(rub),
        contact=as_index(np.flatnonzero(contacts)),
        contact_of=_numbers(contacts),
        switching=as_index(np.flatnonzero(np.array(contacts, bool) | np.array(rub, bool))),
        n_compliant=sum(row.compliant for row in rows),
        range=as_index(np.cumsum([0, *(len(coupling) for coupling in couplings)])),
        second=as_index([0 if row.swapped else 6 for row in rows]),
        drive=as_index([-1 if row.drive is None else next(numbers) for row in rows]),
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
    )


def _six_wide(vectors: Sequence[Array | None]) -> Array:
    out = np.zeros((len(vectors), 6))
    for i, vector in enumerate(vectors):
        if vector is not None:
            out[i, : len(vector)] = vector
    return out
