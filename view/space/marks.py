"""Marks of what acts between bodies: joints, springs, contacts, forces, the ground."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...results import Connection, Results
from ...results.motion import ContactMotion
from ...results.rotations import rotate
from ...results.space import SURFACE_CONTACTS
from ...superelement import Outline, figures
from ...superelement.validation import Array
from . import glyphs
from .bodies import Body
from .holding import HOLDING_GROUPS, place_of
from .tracks import GROUND_NAME, Track, Tracks

JOINT_COLOR = "#274c8f"
SPRING_COLOR = "#1b7f4d"
CONTACT_COLOR = "#d62728"
FORCE_COLOR = "#d9480f"
# Kinds of marks whose colors are explained; the others explain themselves.
MARK_LEGEND = {
    "joints": JOINT_COLOR,
    "springs": SPRING_COLOR,
    "contacts": CONTACT_COLOR,
    "forces": FORCE_COLOR,
}
GROUND_COLOR = "#5c636a"
LEG_COLOR = "#9aa1ab"
FLOOR_COLOR = "#e9e4da"
SHAPE_COLOR = "#b08d57"
# Of marks in bodies, which stay visible within; and of shapes around bodies, which must not hide
# them.
MARK_OPACITY = 0.85
SHAPE_OPACITY = 0.3
# Over the size of the model.
LONGEST_ARROW = 0.15
# How far a floor reaches beyond what comes near it, over the size of the model.
FLOOR_OVERHANG = 0.15
# Radius over the size of the model: a larger one stands for a face that is hardly curved, and
# would fill the picture.
MAX_ROUND_SHAPE = 2.0
# As of a floor, of a shape that a body carries.
CARRIED_OVERHANG = 0.04
# Of the largest force: smaller ones would be specks.
LEAST_ARROW_SHARE = 0.03
# Over the radius of marks.
SPRING_WIDTH = 1.5

ARROW_GLYPH = glyphs.arrow()
TRIAD_GLYPH = glyphs.triad()
COIL_GLYPH = glyphs.coil()
SEGMENT_GLYPH = glyphs.segment()
TUBE_GLYPH = glyphs.tube()
SPHERE_GLYPH = figures.sphere(1.0)
PLATE_GLYPH = figures.box([1.0, 1.0, 0.0])
E_Z = np.array([0.0, 0.0, 1.0])
# With their axis along z, over the radius of marks; others are spheres.
JOINT_GLYPHS: dict[str, Outline] = {
    "revolute": figures.cylinder(0.75, 3.2, E_Z),
    "cylindrical": figures.cylinder(0.6, 4.4, E_Z),
    "screw": figures.cylinder(0.6, 4.4, E_Z),
    "prismatic": figures.box([1.5, 1.5, 3.6]),
    "point_on_line": figures.box([1.0, 1.0, 3.6]),
    "planar": figures.box([3.0, 3.0, 0.4]),
    "point_on_plane": figures.box([3.0, 3.0, 0.4]),
    "fixed": figures.box([1.3, 1.3, 1.3]),
    "spherical": SPHERE_GLYPH,
}


@dataclass(frozen=True, eq=False)
class Mark:
    """A glyph and where it is: its points turn and stretch by A (k, 3, 3) and lie at x (k, 3).

    A is 0 where there is nothing to see; before: it is seen through all bodies; opacity: from 0
    to 1.
    """

    kind: str
    color: str
    glyph: Outline
    x: Array
    A: Array
    before: bool = True
    opacity: float = MARK_OPACITY

    def position(self, rows: slice) -> Array:
        """(k, p, 3) [m]"""
        placed: Array = self.x[rows, None] + np.einsum(
            "kij,pj->kpi", self.A[rows], self.glyph.points
        )
        return placed


class Placing:
    """Where frames are seen when deformation is magnified.

    tracks, bodies: at the same times.
    """

    def __init__(self, tracks: Tracks, bodies: tuple[Body, ...], magnification: float) -> None:
        self.tracks, self._magnification = tracks, magnification
        self._bodies = {body.name: body for body in bodies}

    def find(self, name: str) -> Track | None:
        return self.tracks.find(name)

    def flexible(self, body: str) -> bool:
        return body in self._bodies and self._bodies[body].flexible

    def seen(self, frame: Track) -> Array:
        """The position (k, 3) of a frame as the deformation of its body is seen [m]."""
        body = self._bodies.get(frame.body)
        if body is None or frame.u is None or not body.flexible or self._magnification == 1.0:
            return frame.position
        X = place_of(body.track, frame)
        u = body.deformation(frame.u[:, None, :3], X[None], slice(None))[:, 0]
        more: Array = frame.position + (self._magnification - 1.0) * rotate(body.track.rotation, u)
        return more

    def ends(self, coupling: Connection) -> tuple[Array, Array] | None:
        """The positions (k, 3) of its two frames as they are seen; None where one is unknown."""
        first, second = coupling.between
        a, b = self.tracks.end(first, second), self.tracks.end(second, first)
        return None if a is None or b is None else (self.seen(a), self.seen(b))


def marks_of(results: Results, placing: Placing, radius: float, size: float) -> tuple[Mark, ...]:
    """The marks of all couplings and forces.

    radius: of a spherical joint [m]; size: of the model [m].
    """
    found: list[Mark] = []
    for coupling in results.couplings:
        ends = tuple(placing.find(name) for name in coupling.between)
        if coupling.group == "contacts":
            found += _contact(results, coupling, placing.tracks, radius)
        elif coupling.group == "springs" or coupling.type == "rod":
            found += _between(coupling, placing, radius)
        elif coupling.group in ("joints", "motions"):
            found += _joint(coupling, ends, placing, radius)
        if coupling.group in HOLDING_GROUPS:
            found += _grounds(coupling, placing.tracks, radius)
    found += shapes_of(results, placing, size)
    found += _legs(results, placing, radius)
    found += _forces(results, placing, size)
    # What is seen through is drawn in this order.
    return tuple(sorted(found, key=lambda mark: mark.before))


def largest_force(results: Results, tracks: Tracks) -> float:
    """The largest force that has an arrow [N]."""
    forces = (np.linalg.norm(force, axis=1).max() for _, force in _loaded(results, tracks))
    return float(max(forces, default=0.0))


def is_ground(name: str) -> bool:
    return name.partition(".")[0] == GROUND_NAME


def _joint(
    coupling: Connection, ends: tuple[Track | None, ...], placing: Placing, radius: float
) -> Iterator[Mark]:
    """At the frame that moves; with the axes of the first frame, in which its axis is given."""
    moving = [
        end for name, end in zip(coupling.between, ends, strict=True) if end and not is_ground(name)
    ]
    if not moving:
        return
    glyph, axes = JOINT_GLYPHS.get(coupling.type, SPHERE_GLYPH), ends[0]
    axis = np.array([0.0, 0.0, 1.0]) if coupling.axis is None else np.asarray(coupling.axis)
    x = placing.seen(moving[0])
    if is_ground(coupling.between[0]):
        way = np.broadcast_to(axis, x.shape)
    elif axes is not None:
        way = axes.turned(axis)
    else:
        glyph, way = SPHERE_GLYPH, np.broadcast_to(axis, x.shape)
    yield Mark("joints", JOINT_COLOR, glyph, x, radius * along(way))


def _between(coupling: Connection, placing: Placing, radius: float) -> Iterator[Mark]:
    """A spring or a rod, as long as it is; a ball where it is short, as a bushing."""
    if (ends := placing.ends(coupling)) is None:
        return
    kind, color = ("joints", JOINT_COLOR) if coupling.type == "rod" else ("springs", SPRING_COLOR)
    start, way = ends[0], ends[1] - ends[0]
    length = np.linalg.norm(way, axis=1)
    if length.max() < 2.0 * radius:
        A = np.broadcast_to(1.2 * radius * np.eye(3), (len(way), 3, 3))
        yield Mark(kind, color, SPHERE_GLYPH, start, A)
        return
    A = along(way)
    A[:, :, :2] *= SPRING_WIDTH * radius
    A[:, :, 2] *= length[:, None]
    yield Mark(kind, color, SEGMENT_GLYPH if kind == "joints" else COIL_GLYPH, start, A)


def _grounds(coupling: Connection, tracks: Tracks, radius: float) -> Iterator[Mark]:
    """A small triad where something is held by the ground."""
    first, second = coupling.between
    for name, other in ((first, second), (second, first)):
        track = tracks.end(name, other) if is_ground(name) else None
        if track is not None:
            A = np.broadcast_to(4.0 * radius * np.eye(3), (len(track.position), 3, 3))
            yield Mark("ground", GROUND_COLOR, TRIAD_GLYPH, track.position, A)


def shapes_of(results: Results, placing: Placing, size: float) -> Iterator[Mark]:
    """The shapes that balls and surfaces touch; one for contacts that share it.

    What has no end reaches as far as the balls and bodies come, and somewhat beyond.
    """
    met: dict[str, tuple[Connection, Track, list[Array]]] = {}
    for coupling in results.couplings:
        first, second = coupling.between
        if coupling.group not in ("contacts", SURFACE_CONTACTS):
            continue
        carrier, ball = placing.tracks.end(first, second), placing.find(second)
        if carrier is None or ball is None:
            continue
        basis = _basis(coupling)
        apart = carrier.seen_from(ball.position) @ basis
        met.setdefault(_alike(coupling), (coupling, carrier, []))[2].append(apart)
    for coupling, carrier, apart_all in met.values():
        apart = np.concatenate(apart_all)
        low, high = apart.min(axis=0), apart.max(axis=0)
        beyond = (FLOOR_OVERHANG if is_ground(coupling.between[0]) else CARRIED_OVERHANG) * size
        yield from _shape(
            coupling, placing.seen(carrier), carrier, low - beyond, high + beyond, size
        )


def _basis(coupling: Connection) -> Array:
    """e1, e2, e3 = axis of a shape as columns (3, 3), in the axes of its first frame."""
    axis = E_Z if coupling.axis is None else np.asarray(coupling.axis, dtype=float)
    if coupling.shape is None:
        any_basis: Array = along(axis[None])[0]
        return any_basis
    across = coupling.shape.across
    basis: Array = np.column_stack([across, np.cross(axis, across), axis])
    return basis


def _alike(coupling: Connection) -> str:
    """What contacts with one shape have in common."""
    shape = coupling.shape
    own = "" if shape is None else f"{shape.radius} {shape.length} {shape.curve.tolist()}"
    return f"{coupling.between[0]} {coupling.type} {coupling.axis} {own}"


def _shape(
    coupling: Connection, x: Array, carrier: Track, low: Array, high: Array, size: float
) -> Iterator[Mark]:
    """The shape of a contact at x (k, 3), and from low to high (3,) in its own axes where it is
    without end; none of one that stands for a face that is hardly curved.
    """
    shape, middle, extent = coupling.shape, 0.5 * (low + high), high - low
    if coupling.type == "plane":
        glyph, middle, extent = PLATE_GLYPH, middle * [1, 1, 0], np.array([*extent[:2], 1.0])
        color, opacity = FLOOR_COLOR, MARK_OPACITY
    elif shape is None or shape.radius > MAX_ROUND_SHAPE * size:
        return
    else:
        color, opacity, round_ = SHAPE_COLOR, SHAPE_OPACITY, shape.radius
        if np.isfinite(shape.length):
            middle, extent[2] = np.zeros(3), shape.length
        middle = middle * [0, 0, 1]
        if coupling.type == "sphere":
            glyph, middle, extent = SPHERE_GLYPH, np.zeros(3), np.full(3, round_)
        elif coupling.type == "cylinder":
            glyph, extent = TUBE_GLYPH, np.array([round_, round_, extent[2]])
        else:
            glyph, extent = glyphs.extruded(shape.curve), np.array([1.0, 1.0, extent[2]])
    basis = _basis(coupling)
    A = np.stack([carrier.turned(column) for column in (basis * extent).T], axis=2)
    at = x + carrier.turned(basis @ middle)
    yield Mark("shapes", color, glyph, at, A, before=False, opacity=opacity)


def _legs(results: Results, placing: Placing, radius: float) -> Iterator[Mark]:
    """Lines from the centers of rigid bodies to their frames, which shapes may not reach."""
    seen: set[str] = set()
    for coupling in results.couplings:
        for name in coupling.between:
            body, _, frame = name.partition(".")
            track = placing.find(name) if frame and body != GROUND_NAME else None
            if name in seen or track is None or placing.flexible(body):
                continue
            seen.add(name)
            center = placing.tracks.body(body).position
            A = along(track.position - center)
            A[:, :, 2] *= np.linalg.norm(track.position - center, axis=1)[:, None]
            if np.linalg.norm(A[0, :, 2]) > 2.0 * radius:
                yield Mark("bodies", LEG_COLOR, SEGMENT_GLYPH, center, A, before=False)


def _contact(
    results: Results, coupling: Connection, tracks: Tracks, radius: float
) -> Iterator[Mark]:
    """A ball where it is closed."""
    name = coupling.name
    if f"contacts/{name}" not in results.recorded:
        return
    motion = results.contact(name)
    assert isinstance(motion, ContactMotion)
    closed = tracks.nearest(motion.state) > 0.0
    A = np.where(closed[:, None, None], 1.3 * radius * np.eye(3), 0.0)
    yield Mark("contacts", CONTACT_COLOR, SPHERE_GLYPH, tracks.at(motion.point), A)


def _loaded(results: Results, tracks: Tracks) -> Iterator[tuple[Track, Array]]:
    """Frames with the forces (k, 3) on them [N]; of two joined ones the second alone."""
    recorded = set(results.recorded)
    known = [name for name in results.frames if f"frames/{name}" in recorded]
    joined = {
        coupling.between[0]
        for coupling in results.couplings
        if coupling.between[1] in known and coupling.group != "contacts"
    }
    for name in known:
        track = tracks.find(name)
        if name not in joined and track is not None and track.force is not None:
            yield track, track.force[:, :3]


def _forces(results: Results, placing: Placing, size: float) -> Iterator[Mark]:
    """Arrows with one scale for all of them and all frames."""
    largest = largest_force(results, placing.tracks)
    for track, force in _loaded(results, placing.tracks):
        strength = np.linalg.norm(force, axis=1)
        shown = strength > LEAST_ARROW_SHARE * largest
        if shown.any():
            length = np.where(shown, strength, 0.0) * LONGEST_ARROW * size / largest
            A = along(force) * length[:, None, None]
            yield Mark("forces", FORCE_COLOR, ARROW_GLYPH, placing.seen(track), A)


def along(z: Array) -> Array:
    """Rotations (k, 3, 3) whose third column is the direction of z (k, 3)."""
    length = np.linalg.norm(z, axis=1, keepdims=True)
    z = np.where(length > 0.0, z, [0.0, 0.0, 1.0]) / np.where(length > 0.0, length, 1.0)
    # A third direction that is far from all of them keeps the others from jumping.
    mean = np.abs(z).mean(axis=0)
    away = np.eye(3)[int(mean.argmin())]
    x = np.cross(np.broadcast_to(away, z.shape), z)
    short = np.linalg.norm(x, axis=1) < 1e-3
    x[short] = np.cross([1.0, 0.0, 0.0], z[short])
    short = np.linalg.norm(x, axis=1) < 1e-3
    x[short] = np.cross([0.0, 1.0, 0.0], z[short])
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    return np.stack([x, np.cross(z, x), z], axis=2)
