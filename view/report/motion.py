"""What the animation of a report shows: instants, bodies, how far they deform, marks."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from matplotlib.colors import to_hex

from ...results import Results
from ...results.steps import evenly
from ...superelement.cells import IntArray
from ...superelement.validation import Array
from ..camera import Fitting
from ..scene import tint
from ..space.bodies import Body
from ..space.film import gravity_of
from ..space.stage import NO_FIELD, Stage
from .simplify import simplified

# Of all bodies. The limits below keep a page under 15 MB, which mail takes.
MAX_DEFORMING_POINTS = 12_000
# Rigid bodies are stored once, not at every instant.
MAX_RIGID_POINTS = 60_000
# Of all deforming surfaces.
MAX_POINT_INSTANTS = 600_000
# Instants times bodies.
MAX_POSES = 40_000
# Of a slow motion, and of any: a browser loads them all before it plays.
LEAST_INSTANTS = 121
MAX_INSTANTS = 2001
# Of a body between instants, if there can be so many [rad]: straight ways between look round.
WANTED_TURN = 0.2
# Over the size of the model: beyond, positions in single precision would be seen to jump.
FAR_FROM_ORIGIN = 100.0
# Instants at which the camera looks for marks: near enough, and far fewer than all.
MARK_SAMPLES = 61


@dataclass(frozen=True, eq=False)
class Shape:
    """A body of the animation.

    color: where it has no values; points (m, 3): at rest, in body axes [m]; triangles, lines: of
    them; poses (k, 4, 4): into space, less the origin of the animation, at the instants of motion;
    u (f, m, 3): enlarged, in body axes, at the instants of deformation, None where it is rigid;
    values (f, m): of the field, None where there is none.
    """

    name: str
    color: str
    points: Array
    triangles: IntArray
    lines: IntArray
    poses: Array
    u: Array | None = None
    values: Array | None = None


@dataclass(frozen=True, eq=False)
class Motion:
    """The bodies and marks of an animation, and what there is to say of it.

    moving: the stage at the instants of motion (k,), with marks; deforming: the same at those of
    deformation (f,), with the field; origin (3,) [m]; named: names of couplings with the places
    (k, 3) of their first frames [m]; gravity (3,), if there is any; turn: largest angle between two
    instants [rad]; recorded: instants of the run; known: a box that other instants reach.
    """

    moving: Stage
    deforming: Stage
    origin: Array
    shapes: Sequence[Shape]
    named: Sequence[tuple[str, Array]]
    gravity: Array | None
    turn: float
    recorded: int
    known: Sequence[Array] = ()

    @property
    def time(self) -> Array:
        """The instants of motion (k,) [s]."""
        return self.moving.times

    @property
    def points(self) -> tuple[int, int]:
        """Points that are drawn, and those of the bodies."""
        drawn = sum(len(shape.points) for shape in self.shapes)
        return drawn, sum(len(body.X) for body in self.moving.bodies)

    @cached_property
    def largest(self) -> float:
        """The end of the scale of the field, for all bodies and instants."""
        fields = [shape.values for shape in self.shapes if shape.values is not None]
        return max((float(values.max(initial=0.0)) for values in fields), default=0.0)

    @cached_property
    def reached(self) -> list[Array]:
        """Points (n, p, 3) of boxes around bodies, and of marks: all is between them [m]."""
        some = slice(None, None, len(self.time) // MARK_SAMPLES + 1)
        boxes = [_corners(shape) for shape in self.shapes if len(shape.points)]
        return [*boxes, *(mark.position(some) - self.origin for mark in self.moving.marks)]

    @cached_property
    def box(self) -> tuple[Array, Array]:
        """The box that holds all bodies at all times (3,), (3,) [m], with some room."""
        fitting = Fitting(np.eye(3))
        for points in (*self.reached, *self.known):
            fitting.take(points)
        low, high = fitting.box
        if not np.isfinite(low).all():
            return -np.ones(3), np.ones(3)
        least = 0.02 * float(np.linalg.norm(high - low)) + 1e-12
        thin = np.maximum(least - (high - low), 0.0)
        return low - 0.5 * thin, high + 0.5 * thin


def motion(
    results: Results, field: str = "", on_body: Callable[[], object] | None = None
) -> Motion | None:
    """The motion of all bodies that were recorded; None if none was.

    field: one of `field_kinds.FIELDS`; by default as films have it; on_body: called when one more
    body is made.
    """
    names, time = results.bodies, results.time
    if not names or not len(time):
        return None
    rows, turn = _instants(results, time, len(names))
    flexible = [name for name in names if results.outline_source(name) != "rigid"]
    points = sum(len(results.outline(name).points) for name in flexible)
    frames = (
        min(len(rows), MAX_POINT_INSTANTS // min(points, MAX_DEFORMING_POINTS), 4 * LEAST_INSTANTS)
        if points
        else 2
    )
    instants = time[rows][evenly(time[rows], slice(None), max(frames, 2))]
    deforming = Stage(results, instants, field or None, marks=False)
    moving = Stage(results, time[rows], NO_FIELD, deforming.magnification)
    return staged(results, moving, deforming, turn, on_body)


def staged(
    results: Results,
    moving: Stage,
    deforming: Stage,
    turn: float = 0.0,
    on_body: Callable[[], object] | None = None,
    known: Sequence[Array] = (),
) -> Motion:
    """The motion of stages at its instants, and at those of deformation.

    turn: largest angle of a body between two instants [rad]; known: a box of other instants.
    """
    far = float(np.linalg.norm(moving.middle)) > FAR_FROM_ORIGIN * moving.size
    origin = np.round(moving.middle, 3) if far else np.zeros(3)
    shapes = []
    for number in range(len(moving.bodies)):
        shapes.append(_shape(moving, deforming, number, origin))
        if on_body is not None:
            on_body()
    ends = ((c.name, moving.placing.ends(c)) for c in results.couplings)
    named = [(name, found[0] - origin) for name, found in ends if found is not None]
    recorded = len(results.time)
    gravity = gravity_of(results)
    return Motion(moving, deforming, origin, shapes, named, gravity, turn, recorded, known)


def poses(x: Array, A: Array) -> Array:
    """Homogeneous matrices (k, 4, 4) that turn and stretch by A (k, 3, 3), and move by x (k, 3)."""
    whole = np.zeros((len(x), 4, 4))
    whole[:, :3, :3], whole[:, :3, 3], whole[:, 3, 3] = A, x, 1.0
    return whole


def _instants(results: Results, time: Array, n_bodies: int) -> tuple[IntArray, float]:
    """The rows that are shown, and the largest turn between two of them [rad]."""
    spin = np.zeros(len(time))
    for name in results.bodies:
        spin = np.maximum(spin, np.linalg.norm(results.body(name).v[:, 3:], axis=1))
    turned = np.concatenate([[0.0], np.cumsum(0.5 * (spin[1:] + spin[:-1]) * np.diff(time))])
    fastest = float(spin.max()) * float(time[-1] - time[0])
    most = max(min(MAX_INSTANTS, MAX_POSES // n_bodies), LEAST_INSTANTS)
    wanted = int(np.clip(np.ceil(min(fastest / WANTED_TURN, 1e9)) + 1, LEAST_INSTANTS, most))
    rows = evenly(time, slice(None), wanted)
    return rows, float(np.diff(turned[rows]).max(initial=0.0))


def _shape(moving: Stage, deforming: Stage, number: int, origin: Array) -> Shape:
    body, parts = deforming.bodies[number], deforming.rows
    kept, triangles = _surface(body, deforming.bodies)
    u = values = None
    if body.flexible:
        moved = (body.displacement(rows, deforming.magnification)[:, kept] for rows in parts)
        u = np.concatenate(list(moved))
    if body in deforming.told:
        found = (body.values(rows, deforming.field)[:, kept] for rows in parts)
        values = np.nan_to_num(np.concatenate(list(found)))
    track = moving.bodies[number].track
    R = np.stack([track.turned(axis) for axis in np.eye(3)], axis=-1)
    return Shape(
        body.name,
        to_hex(tint(number)),
        body.X[kept],
        triangles,
        body.outline.lines,
        poses(track.position - origin, R),
        u,
        values,
    )


def _surface(body: Body, bodies: Sequence[Body]) -> tuple[IntArray, IntArray]:
    """The points that are drawn of a body, and its triangles."""
    outline = body.outline
    if len(outline.lines):
        return np.arange(len(body.X)), outline.triangles
    most = MAX_DEFORMING_POINTS if body.flexible else MAX_RIGID_POINTS
    alike = sum(len(other.X) for other in bodies if other.flexible == body.flexible)
    share = max(int(most * len(body.X) / max(alike, 1)), 50)
    return simplified(body.X, outline.triangles, share)


def _corners(shape: Shape) -> Array:
    """The corners (k, 8, 3) of the box of a body in space."""
    more = 0.0 if shape.u is None else np.abs(shape.u).max(axis=(0, 1), initial=0.0)
    low, high = shape.points.min(axis=0) - more, shape.points.max(axis=0) + more
    corners = np.array(np.meshgrid(*zip(low, high, strict=True))).reshape(3, 8)
    turned = np.einsum("kij,jc->kci", shape.poses[:, :3, :3], corners)
    moved: Array = turned + shape.poses[:, None, :3, 3]
    return moved
