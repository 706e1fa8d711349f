"""What the animation of a report shows: instants, bodies, how far they deform, marks."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...results import Results
from ...results.rotations import rotate
from ...results.steps import batches, evenly
from ...superelement.validation import Array
from ..space.bodies import Body, bodies_on_stage
from ..space.marks import Mark as StageMark
from ..space.marks import Placing, shapes_of
from ..space.stage import chosen_field, chosen_magnification, colored, size_of, unknown
from ..space.tracks import Tracks
from .simplify import IntArray, simplified

MOST_POINTS = 12_000
"""of all deforming surfaces"""
MOST_RIGID = 60_000
"""points of all rigid bodies"""
POINT_FRAMES = 600_000
"""points times instants of all deforming surfaces"""
POSES = 40_000
"""instants times bodies"""
FRAMES, MOST_FRAMES = 121, 2001
"""instants of a slow motion, and of any"""
TURN = 0.2
"""of a body between instants, if there can be so many [rad]"""
AT_ONCE = 3_000_000
"""points of a body, times instants, that are in memory"""


@dataclass(frozen=True, eq=False)
class Shape:
    """A body of the animation.

    points (m, 3): at rest, in body axes [m]; triangles, lines: of them; poses (k, 4, 4): into
    space, less the origin of the animation, at the instants of motion; u (f, m, 3): enlarged, in
    body axes, at the instants of deformation, None where it is rigid; values (f, m): of the field,
    None where there is none.
    """

    name: str
    points: Array
    triangles: IntArray
    lines: IntArray
    poses: Array
    u: Array | None = None
    values: Array | None = None


@dataclass(frozen=True, eq=False)
class Mark:
    """What acts between two frames: their positions (k, 2, 3) at the instants of motion [m]."""

    name: str
    group: str
    type: str
    positions: Array


@dataclass(frozen=True, eq=False)
class Motion:
    """The bodies and marks of an animation, and what there is to say of it.

    surroundings: the shapes that contacts touch, whose poses stretch them too;
    time (k,) [s]: the instants of motion; deforming (f,): those of deformation; origin (3,) [m];
    turn: largest angle between two instants [rad]; points: (drawn, of the bodies); field: of the
    colors, "" where no body has one; failed: why bodies have none; remarks: where deformation is
    not that of the mesh.
    """

    time: Array
    deforming: Array
    origin: Array
    shapes: Sequence[Shape]
    marks: Sequence[Mark]
    magnification: float
    turn: float
    points: tuple[int, int]
    field: str
    failed: Sequence[str]
    recorded: int
    remarks: Sequence[str]
    surroundings: Sequence[Shape] = ()


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
    moving = sum(_points(results, name) for name in names if _is_flexible(results, name))
    frames = min(len(rows), POINT_FRAMES // min(moving, MOST_POINTS), 4 * FRAMES) if moving else 2
    deforming = time[rows][evenly(time[rows], slice(None), max(frames, 2))]
    bodies = bodies_on_stage(results, Tracks(results, deforming))
    chosen = chosen_field(bodies, field or None)
    failed = unknown(bodies, chosen) if chosen else {}
    shown = {body.name for body in colored(bodies, chosen)} - set(failed) if chosen else set()
    parts = batches(len(deforming), _at_once(bodies))
    magnification = chosen_magnification(bodies, parts)
    origin = _origin(results, names)
    shapes = []
    for body in bodies:
        numbers, triangles = _surface(body, bodies)
        shapes.append(
            Shape(
                body.name,
                body.X[numbers],
                triangles,
                body.outline.lines,
                _poses(results, body.name, rows, origin),
                _deformed(body, numbers, parts, magnification),
                _values(body, numbers, parts, chosen) if body.name in shown else None,
            )
        )
        if on_body is not None:
            on_body()
    tracks = Tracks(results, time[rows])
    placing = Placing(tracks, bodies_on_stage(results, tracks), magnification)
    return Motion(
        time[rows],
        deforming,
        origin,
        shapes,
        [*_marks(results, placing, origin)],
        magnification,
        turn,
        (sum(len(shape.points) for shape in shapes), sum(len(body.X) for body in bodies)),
        chosen,
        tuple(failed.values()),
        len(time),
        [remark for body in bodies if (remark := results.outline_remark(body.name))],
        [_around(mark, origin) for mark in shapes_of(results, placing, size_of(bodies))],
    )


def _around(mark: StageMark, origin: Array) -> Shape:
    """The shape of a contact at all instants."""
    poses = np.zeros((len(mark.x), 4, 4))
    poses[:, :3, :3], poses[:, :3, 3], poses[:, 3, 3] = mark.A, mark.x - origin, 1.0
    glyph = mark.glyph
    return Shape(mark.color, glyph.points, glyph.triangles, glyph.lines, poses)


def _instants(results: Results, time: Array, n_bodies: int) -> tuple[IntArray, float]:
    """The rows that are shown, and the largest turn between two of them [rad]."""
    spin = np.zeros(len(time))
    for name in results.bodies:
        spin = np.maximum(spin, np.linalg.norm(results.body(name).v[:, 3:], axis=1))
    turned = np.concatenate([[0.0], np.cumsum(0.5 * (spin[1:] + spin[:-1]) * np.diff(time))])
    fastest = float(spin.max()) * float(time[-1] - time[0])
    most = max(min(MOST_FRAMES, POSES // n_bodies), FRAMES)
    wanted = int(np.clip(np.ceil(min(fastest / TURN, 1e9)) + 1, FRAMES, most))
    rows = evenly(time, slice(None), wanted)
    return rows, float(np.diff(turned[rows]).max(initial=0.0))


def _surface(body: Body, bodies: Sequence[Body]) -> tuple[IntArray, IntArray]:
    """The points that are drawn of a body, and its triangles."""
    outline = body.outline
    if len(outline.lines):
        return np.arange(len(body.X)), outline.triangles
    most = MOST_POINTS if body.flexible else MOST_RIGID
    alike = sum(len(other.X) for other in bodies if other.flexible == body.flexible)
    share = max(int(most * len(body.X) / max(alike, 1)), 50)
    return simplified(body.X, outline.triangles, share)


def _points(results: Results, name: str) -> int:
    return len(results.outline(name).points)


def _is_flexible(results: Results, name: str) -> bool:
    return results.outline_source(name) != "rigid"


def _at_once(bodies: Sequence[Body]) -> int:
    """Instants of which the displacements of any body are in memory at once."""
    return AT_ONCE // max(1, *(len(body.X) for body in bodies))


def _deformed(
    body: Body, numbers: IntArray, parts: Sequence[slice], magnification: float
) -> Array | None:
    """Displacements (f, m, 3) of the points that are drawn; None for rigid bodies."""
    if not body.flexible:
        return None
    return np.concatenate([body.displacement(rows, magnification)[:, numbers] for rows in parts])


def _values(body: Body, numbers: IntArray, parts: Sequence[slice], field: str) -> Array:
    found: Array = np.concatenate([body.values(rows, field)[:, numbers] for rows in parts])
    return np.nan_to_num(found)


def _origin(results: Results, names: Sequence[str]) -> Array:
    """Where numbers of single precision begin: 0, unless all moves far away from there [m]."""
    paths = np.concatenate([results.body(name).x for name in names])
    low, high = paths.min(axis=0), paths.max(axis=0)
    middle: Array = 0.5 * (low + high)
    size = max(float(np.linalg.norm(high - low)), *(_size(results, name) for name in names))
    far = float(np.linalg.norm(middle)) > 20.0 * size
    return np.round(middle, 3) if far else np.zeros(3)


def _size(results: Results, name: str) -> float:
    points = results.outline(name).points
    return float(np.linalg.norm(np.ptp(points, axis=0))) if len(points) else 0.0


def _poses(results: Results, name: str, rows: IntArray, origin: Array) -> Array:
    """Homogeneous matrices (k, 4, 4) of a body."""
    moved = results.body(name)
    poses = np.zeros((len(rows), 4, 4))
    poses[:, :3, :3] = _matrices(moved.R[rows])
    poses[:, :3, 3] = moved.x[rows] - origin
    poses[:, 3, 3] = 1.0
    return poses


def _matrices(q: Array) -> Array:
    """Rotation matrices (k, 3, 3) of unit quaternions (k, 4)."""
    return np.stack([rotate(q, axis) for axis in np.eye(3)], axis=-1)


def _marks(results: Results, placing: Placing, origin: Array) -> Iterator[Mark]:
    """Those whose two frames are known."""
    for coupling in results.couplings:
        if (ends := placing.ends(coupling)) is not None:
            positions = np.stack(ends, axis=1) - origin
            yield Mark(coupling.name, coupling.group, coupling.type, positions)
