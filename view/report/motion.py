"""What the animation of a report shows: instants, bodies, how far they deform, marks."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...results import RecoveryError, Results
from ...results.rotations import rotate
from ...superelement.validation import Array
from .simplify import IntArray, simplified

FIELDS = {
    "von_mises": ("von Mises stress", "Pa"),
    "displacement": ("elastic displacement", "m"),
    "velocity": ("velocity", "m/s"),
}
"""words and units"""
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
SEEN = 0.04
"""largest deformation as it is drawn, over the size of its body"""
AT_ONCE = 1 << 24
"""numbers of a field that are in memory"""


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
    """time (k,) [s]: the instants of motion; deforming (f,): those of deformation; origin (3,) [m];
    turn: largest angle between two instants [rad]; points: (drawn, of the bodies); field: of the
    colors, "" where no body has one; failed: why bodies have none."""

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


def motion(results: Results, field: str = "") -> Motion | None:
    """The motion of all bodies that were recorded; None if none was.

    field: one of `FIELDS`; by default von Mises stress where it is known, or else elastic
    displacement.
    """
    names, time = results.bodies, results.time
    if not names or not len(time):
        return None
    flexible = [name for name in names if results.outline_source(name) != "rigid"]
    rows, turn = _instants(results, time, len(names))
    surfaces = {name: _surface(results, name, names, flexible) for name in names}
    moving = sum(len(surfaces[name][0]) for name in flexible)
    frames = len(rows) if not moving else min(len(rows), POINT_FRAMES // moving, 4 * FRAMES)
    deforming = time[rows[_evenly(len(rows), max(frames, 2))]]
    origin = _origin(results, names)
    chosen, failed = _field(results, flexible, field, deforming)
    deformed = {name: _deformed(results, name, surfaces[name][0], deforming) for name in flexible}
    magnification = _magnification(results, deformed)
    shapes = []
    for name in names:
        numbers, triangles, lines = surfaces[name]
        values = _values(results, name, numbers, deforming, chosen, flexible)
        u = magnification * deformed[name] if name in deformed else None
        poses = _poses(results, name, rows, origin)
        points = results.outline(name).points[numbers]
        shapes.append(Shape(name, points, triangles, lines, poses, u, values))
    whole = sum(len(results.outline(name).points) for name in names)
    drawn = sum(len(numbers) for numbers, _, _ in surfaces.values())
    marks = [*_marks(results, rows, origin, magnification)]
    return Motion(
        time[rows],
        deforming,
        origin,
        shapes,
        marks,
        magnification,
        turn,
        (drawn, whole),
        chosen,
        failed,
        len(time),
    )


def _evenly(n: int, most: int) -> IntArray:
    """At most so many of n numbers, evenly, the first and the last among them."""
    return np.unique(np.linspace(0, n - 1, min(n, most)).round().astype(np.int64))


def _instants(results: Results, time: Array, n_bodies: int) -> tuple[IntArray, float]:
    """The rows that are shown, and the largest turn between two of them [rad]."""
    spin = np.zeros(len(time))
    for name in results.bodies:
        spin = np.maximum(spin, np.linalg.norm(results.body(name).v[:, 3:], axis=1))
    turned = np.concatenate([[0.0], np.cumsum(0.5 * (spin[1:] + spin[:-1]) * np.diff(time))])
    fastest = float(spin.max()) * float(time[-1] - time[0])
    most = max(min(MOST_FRAMES, POSES // n_bodies), FRAMES)
    wanted = int(np.clip(np.ceil(min(fastest / TURN, 1e9)) + 1, FRAMES, most))
    rows = _evenly(len(time), wanted)
    return rows, float(np.diff(turned[rows]).max(initial=0.0))


def _surface(
    results: Results, name: str, names: Sequence[str], flexible: Sequence[str]
) -> tuple[IntArray, IntArray, IntArray]:
    """The points that are drawn of a body, its triangles and its lines."""
    outline = results.outline(name)
    group, most = (flexible, MOST_POINTS) if name in flexible else (names, MOST_RIGID)
    sizes = {other: len(results.outline(other).points) for other in group}
    share = max(int(most * sizes[name] / max(sum(sizes.values()), 1)), 50)
    if len(outline.lines):
        numbers = np.arange(len(outline.points))
        return numbers, outline.triangles, outline.lines
    numbers, triangles = simplified(outline.points, outline.triangles, share)
    return numbers, triangles, outline.lines


def _deformed(results: Results, name: str, numbers: IntArray, times: Array) -> Array:
    """Elastic displacements (f, m, 3) of the points that are drawn."""
    size = 3 * len(results.outline(name).points)
    parts = [results.outline_displacement(name, t)[:, numbers] for t in _batches(times, size)]
    return np.concatenate(parts)


def _batches(times: Array, size: int) -> Iterator[Array]:
    count = max(AT_ONCE // max(size, 1), 1)
    for first in range(0, len(times), count):
        yield times[first : first + count]


def _values(
    results: Results,
    name: str,
    numbers: IntArray,
    times: Array,
    field: str,
    flexible: Sequence[str],
) -> Array | None:
    if not field or (name not in flexible and field != "velocity"):
        return None
    size = 6 * len(results.outline(name).points)
    try:
        parts = [results.outline_field(name, t, field)[:, numbers] for t in _batches(times, size)]
    except RecoveryError:
        return None
    return np.nan_to_num(np.concatenate(parts))


def _field(
    results: Results, flexible: Sequence[str], wanted: str, times: Array
) -> tuple[str, list[str]]:
    """The field that is shown, and why bodies have none."""
    if wanted and wanted not in FIELDS:
        raise RecoveryError(f"field {wanted!r}: expected one of {', '.join(FIELDS)}")
    failed: list[str] = []
    for field in [wanted] if wanted else ["von_mises", "displacement"]:
        failed = []
        for name in flexible:
            try:
                results.outline_field(name, times[:1], field)
            except RecoveryError as error:
                failed.append(str(error))
        if field == "velocity" or len(failed) < len(flexible):
            return field, failed
    return "", failed


def _magnification(results: Results, deformed: dict[str, Array]) -> float:
    """So large that the largest deformation is seen, and not less than 1: 1, 2, 5, 10, ..."""
    parts = []
    for name, u in deformed.items():
        size = float(np.ptp(results.outline(name).points, axis=0).max())
        largest = float(np.linalg.norm(u, axis=-1).max(initial=0.0))
        parts.append(largest / size if size > 0.0 else 0.0)
    largest = max(parts, default=0.0)
    if largest <= 0.0 or not np.isfinite(largest):
        return 1.0
    wanted = min(SEEN / largest, 1e6)
    if wanted < 1.5:
        return 1.0
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(power * max(step for step in (1.0, 2.0, 5.0) if step * power <= wanted))


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


def _marks(results: Results, rows: IntArray, origin: Array, magnification: float) -> Iterator[Mark]:
    """Those whose two frames are known."""
    for coupling in results.couplings:
        ends = [_end(results, name, rows, magnification) for name in coupling.between]
        first, second = ends
        first = second if first is None and coupling.between[0] == "ground" else first
        second = first if second is None and coupling.between[1] == "ground" else second
        if first is not None and second is not None:
            positions = np.stack([first, second], axis=1) - origin
            yield Mark(coupling.name, coupling.group, coupling.type, positions)


def _end(results: Results, name: str, rows: IntArray, magnification: float) -> Array | None:
    """Where a frame is (k, 3), on a body that is drawn deformed; None where it is unknown."""
    where, _, frame = name.partition(".")
    if where == "ground":
        found = results.ground_frames.get(frame) if frame else None
        return None if found is None else np.tile(found, (len(rows), 1))
    if name in results.bodies:
        return results.body(name).x[rows]
    if name not in results.frames or where not in results.bodies:
        return None
    moved = results.frame(name)
    R, u = _matrices(results.body(where).R[rows]), moved.u[rows, :3]
    further: Array = moved.position[rows] + (magnification - 1.0) * np.einsum("kij,kj->ki", R, u)
    return further
