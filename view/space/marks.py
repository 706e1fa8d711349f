"""Marks of what acts between bodies: joints, springs, contacts, forces, the ground."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...results import Results
from ...superelement.validation import Array
from . import glyphs
from .bodies import Body, place_of
from .glyphs import Glyph
from .tracks import GROUND, Track, Tracks

JOINT, SPRING, CONTACT, FORCE = "#274c8f", "#1b7f4d", "#d62728", "#d9480f"
AXES = ("#c1272d", "#2e8b40", "#2456a6")
GROUNDED = "#5c636a"
SPRINGS = ("springs",)
LONGEST = 0.2
"""of arrows, over the size of the model"""
LEAST = 0.03
"""of the largest force: those below have no arrow"""
WIDE = 1.5
"""width of springs over the radius of marks"""

SPHERE = glyphs.sphere()
BY_TYPE: dict[str, Glyph] = {
    "revolute": glyphs.cylinder(0.75, 3.2),
    "cylindrical": glyphs.cylinder(0.6, 4.4),
    "screw": glyphs.cylinder(0.6, 4.4),
    "prismatic": glyphs.box(1.5, 1.5, 3.6),
    "point_on_line": glyphs.box(1.0, 1.0, 3.6),
    "planar": glyphs.box(3.0, 3.0, 0.4),
    "point_on_plane": glyphs.box(3.0, 3.0, 0.4),
    "fixed": glyphs.box(1.3, 1.3, 1.3),
    "spherical": SPHERE,
}
"""shapes of joints with their axis along z, over the radius of marks; others are spheres"""


@dataclass(frozen=True, eq=False)
class Mark:
    """A glyph and where it is: its points turn and stretch by A (k, 3, 3) and lie at x (k, 3).

    A is 0 where there is nothing to see.
    """

    kind: str
    color: str
    glyph: Glyph
    x: Array
    A: Array

    def position(self, rows: slice) -> Array:
        """(k, p, 3) [m]"""
        placed: Array = self.x[rows, None] + np.einsum(
            "kij,pj->kpi", self.A[rows], self.glyph.points
        )
        return placed


class Placing:
    """Where frames are seen when deformation is magnified."""

    def __init__(self, tracks: Tracks, bodies: tuple[Body, ...], magnification: float) -> None:
        self.tracks, self._magnification = tracks, magnification
        self._bodies = {body.name: body for body in bodies}

    def find(self, name: str) -> Track | None:
        return self.tracks.find(name)

    def seen(self, frame: Track) -> Array:
        """The position (k, 3) of a frame as the deformation of its body is seen [m]."""
        body = self._bodies.get(frame.body)
        if body is None or frame.u is None or not body.flexible or self._magnification == 1.0:
            return frame.position
        X = place_of(body.track, frame)
        u = body.deformation(frame.u[:, None, :3], X[None], slice(None))[:, 0]
        more: Array = frame.position + (self._magnification - 1.0) * _turned(body.track.rotation, u)
        return more


def _turned(R: Array, vectors: Array) -> Array:
    """R a (k, 3) for unit quaternions R (k, 4) and vectors a (k, 3)."""
    w, r = R[:, :1], R[:, 1:]
    once = np.cross(r, vectors)
    rotated: Array = vectors + 2.0 * (w * once + np.cross(r, once))
    return rotated


def marks_of(results: Results, placing: Placing, radius: float, size: float) -> tuple[Mark, ...]:
    """The marks of all couplings and forces.

    radius: of a spherical joint [m]; size: of the model [m].
    """
    found: list[Mark] = []
    for coupling in results.couplings:
        found += _of_coupling(results, placing, coupling, radius)
    forces, _ = _forces(results, placing, size)
    return (*found, *forces)


def largest_force(results: Results, tracks: Tracks) -> float:
    """The largest force that has an arrow [N]."""
    return max((float(np.linalg.norm(f, axis=1).max()) for _, f in _loaded(results, tracks)), default=0.0)


def _of_coupling(
    results: Results, placing: Placing, coupling: Any, radius: float
) -> Iterator[Mark]:
    ends = [placing.find(name) for name in coupling.between]
    here = [end for end in ends if end is not None]
    if not here:
        return
    first = here[0]
    if coupling.group == "contacts":
        yield from _contact(results, coupling.name, placing, radius)
    elif coupling.group == "springs" or coupling.type == "rod":
        yield from _spring(coupling, [placing.seen(end) for end in here], radius)
    elif coupling.group in ("joints", "motions"):
        yield _joint(coupling, first, placing.seen(first), radius)
    for name, other in zip(coupling.between, reversed(coupling.between), strict=True):
        if name.partition(".")[0] == GROUND:
            track = placing.find(name) or placing.find(other)
            if track is not None and coupling.group != "contacts":
                yield _ground(track, radius)


def _joint(coupling: Any, frame: Track, x: Array, radius: float) -> Mark:
    glyph = BY_TYPE.get(coupling.type, SPHERE)
    axis = frame.rotation, (0.0, 0.0, 1.0) if coupling.axis is None else coupling.axis
    A = radius * along(Track(x, axis[0]).turned(np.asarray(axis[1], dtype=float)))
    return Mark("joints", JOINT, glyph, x, A)


def _spring(coupling: Any, ends: list[Array], radius: float) -> Iterator[Mark]:
    color = JOINT if coupling.type == "rod" else SPRING
    kind = "joints" if coupling.type == "rod" else "springs"
    way = ends[-1] - ends[0]
    length = np.linalg.norm(way, axis=1)
    if length.max() < 2.0 * radius:
        A = np.broadcast_to(1.2 * radius * np.eye(3), (len(way), 3, 3))
        yield Mark(kind, color, SPHERE, ends[0], A)
        return
    A = along(way)
    A[:, :, :2] *= WIDE * radius
    A[:, :, 2] *= length[:, None]
    yield Mark(kind, color, glyphs.segment() if kind == "joints" else glyphs.coil(), ends[0], A)


def _contact(results: Results, name: str, placing: Placing, radius: float) -> Iterator[Mark]:
    if f"contacts/{name}" not in results.recorded or name not in results.contacts:
        return
    motion = results.contact(name)
    tracks = placing.tracks
    closed = tracks.at(motion.state) > 0.0
    A = np.where(closed[:, None, None], 1.3 * radius * np.eye(3), 0.0)
    yield Mark("contacts", CONTACT, SPHERE, tracks.at(motion.point), A)


def _ground(track: Track, radius: float) -> Mark:
    A = np.broadcast_to(4.0 * radius * np.eye(3), (len(track.position), 3, 3))
    x = np.broadcast_to(track.position[:1], track.position.shape)
    return Mark("ground", GROUNDED, glyphs.triad(), x, A)


def _loaded(results: Results, tracks: Tracks) -> Iterator[tuple[Track, Array]]:
    """Frames with the forces (k, 3) on them [N]; of two joined ones the second alone."""
    known = [f"{name}" for name in results.frames if f"frames/{name}" in results.recorded]
    joined = {
        coupling.between[0]
        for coupling in results.couplings
        if coupling.between[1] in known and coupling.group != "contacts"
    }
    for name in known:
        track = tracks.find(name)
        if name not in joined and track is not None and track.force is not None:
            yield track, track.force[:, :3]


def _forces(results: Results, placing: Placing, size: float) -> tuple[list[Mark], float]:
    tracks = placing.tracks
    largest = largest_force(results, tracks)
    if not largest:
        return [], 0.0
    found = []
    for track, force in _loaded(results, tracks):
        strength = np.linalg.norm(force, axis=1)
        if strength.max() < LEAST * largest:
            continue
        length = np.where(strength > LEAST * largest, strength, 0.0) * LONGEST * size / largest
        A = along(force) * length[:, None, None]
        found.append(Mark("forces", FORCE, glyphs.arrow(), placing.seen(track), A))
    return found, largest


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
