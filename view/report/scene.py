"""The motion of a run as a scene of K3D, in the bytes that it loads in a browser."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from matplotlib.colors import to_hex

from ...superelement.cells import IntArray
from ...superelement.validation import Array
from ..camera import Camera, Fitting, chosen_axes, spread_of
from ..field_kinds import COLOR_MAP
from ..prefixes import rounded_down
from ..space.marks import Mark
from .libraries import package
from .motion import Motion, Shape, poses

# Words of buttons, and views as `chosen_axes` has them.
CAMERA_BUTTONS = {"Overview": "", "Along x": "yz", "Along y": "xz", "Along z": "xy"}
# More names would hide the mechanism.
MAX_NAMED_MARKS = 60
# Names follow their marks in straight lines between these instants.
NAME_INSTANTS = 301
# Along the longest side.
LEAST_GRID_SQUARES = 12
# Of the size of a body: less than a pixel, and numbers that are short when packed.
POSITION_ROUNDING = 2.0**-14
# As many as a color has levels: finer values would be packed in vain.
COLOR_STEPS = 255
# Over the size of what is drawn.
RELATIVE_LINE_WIDTH = 0.004
# Of joints and contacts, over the size of what is drawn.
LEAST_MARK_RADIUS = 0.006
# Of a mark that is not to be seen, over that of the model: K3D cannot invert 0.
UNSEEN_SIZE = 1e-6
GRID_COLOR = 0xC9D1D9
# What colors of a field are multiplied with.
UNCHANGED_COLOR = 0xFFFFFF
CAMERA_OPENING = 30.0  # [degrees]
# Width over height, as the style of the page makes it on a wide screen.
STAGE_ASPECT = 1.8


def color_bar() -> list[str]:
    """The colors of the scale, from its end to 0."""
    return [to_hex(color) for color in COLOR_MAP(np.linspace(1.0, 0.0, 12))]


def scene(motion: Motion) -> bytes:
    """All bodies and marks, over time."""
    k3d = package("k3d")
    plot = k3d.plot(
        menu_visibility=False,
        grid_visible=False,
        camera_auto_fit=False,
        camera_fov=CAMERA_OPENING,
        colorbar_object_id=0,
        axes_helper=0.0,
        antialias=3,
    )
    plot += _grid(k3d, motion)
    plot.camera = placed(cameras(motion)["Overview"])
    parts = [part for shape in motion.shapes for part in _body(k3d, motion, shape)]
    parts += [_mark(k3d, motion, mark) for mark in motion.moving.marks]
    for number, (part, moved) in enumerate(zip(parts, movements(motion), strict=True)):
        # By its name the script of a page finds it.
        part.name = str(number)
        if moved.matrices is not None:
            part.model_matrix = _series(frames(motion), moved.matrices)
        if moved.vertices is not None:
            part.vertices = _series(frames(motion, moved.times), moved.vertices)
        plot += part
    snapshot: bytes = plot.get_binary_snapshot(9)
    return snapshot


class Movement(NamedTuple):
    """What changes of a part of the scene: matrices (k, 4, 4) at the instants of motion, vertices
    (f, m, 3) at times (f,); None where they do not change.
    """

    matrices: Array | None
    vertices: Array | None
    times: Array | None = None


def movements(motion: Motion) -> Iterator[Movement]:
    """Those of all parts of the scene but the grid, in order."""
    for shape in motion.shapes:
        deformed = None if shape.u is None else _rounded(shape)
        moved = Movement(shape.poses, deformed, motion.deforming.times)
        yield from [moved] * (bool(len(shape.triangles)) + bool(len(shape.lines)))
    for mark in motion.moving.marks:
        if not len(mark.glyph.triangles):
            yield Movement(None, mark.position(slice(None)) - motion.origin)
            continue
        A = mark.A
        if mark.kind in ("joints", "contacts"):
            # Where a small body goes far, marks in proportion to it alone would hardly be seen.
            A = A * max(1.0, LEAST_MARK_RADIUS * _size(motion) / motion.moving.radius)
        A = A + UNSEEN_SIZE * motion.moving.size * np.eye(3)
        yield Movement(poses(mark.x - motion.origin, A), None)


def square(motion: Motion) -> float:
    """The side of the squares of the grid: 1, 2 or 5 times a power of ten [m]."""
    low, high = motion.box
    return rounded_down(float((high - low)[:2].max()) / LEAST_GRID_SQUARES)


def _grid(k3d: Any, motion: Motion) -> Any:
    """Squares in the plane x y below all bodies."""
    (low, high), side = motion.box, square(motion)
    first, last = np.floor(low / side)[:2], np.ceil(high / side)[:2]
    x, y = (side * np.arange(a, b + 0.5) for a, b in zip(first, last, strict=True))
    along_y = [[(a, y[0]), (a, y[-1])] for a in x]
    along_x = [[(x[0], b), (x[-1], b)] for b in y]
    plane = np.array(along_y + along_x).reshape(-1, 2)
    points = np.column_stack([plane, np.full(len(plane), low[2])]).astype(np.float32)
    pairs = np.arange(len(points), dtype=np.uint32).reshape(-1, 2)
    return k3d.lines(
        points, pairs, indices_type="segment", shader="simple", color=GRID_COLOR, name=""
    )


def names(motion: Motion) -> dict[str, Any]:
    """The names of couplings and the places of their first frames, by time.

    Those that stand in one place at all times, as far as one sees, share a name.
    """
    every = max(len(motion.time) // NAME_INSTANTS, 1)
    rows = np.unique([*range(0, len(motion.time), every), len(motion.time) - 1])
    near = 0.015 * _size(motion)
    told: list[str] = []
    places: list[Array] = []
    for name, positions in motion.named if len(motion.named) <= MAX_NAMED_MARKS else ():
        place = positions[rows]
        same = [i for i, other in enumerate(places) if np.abs(other - place).max() < near]
        if same:
            told[same[0]] += f", {name}"
        else:
            told.append(name)
            places.append(place)
    joined = np.hstack(places) if places else np.zeros((len(rows), 0))
    return {
        "names": told,
        "times": motion.time[rows].tolist(),
        "places": [[float(f"{x:.5g}") for x in row] for row in joined.tolist()],
    }


def cameras(motion: Motion) -> dict[str, Camera]:
    """Places of the camera by name; the first one is chosen as that of a film."""
    spread = spread_of(motion.reached[: len(motion.shapes)])
    corners = np.array(np.meshgrid(*zip(*motion.box, strict=True))).reshape(3, 8).T
    found = {}
    for name, view in CAMERA_BUTTONS.items():
        fitting = Fitting(chosen_axes(view, spread, motion.gravity))
        fitting.take(corners)
        found[name] = fitting.camera(STAGE_ASPECT)
    return found


def placed(camera: Camera) -> list[float]:
    """A camera of K3D: its position, what it looks at, and what is up (9 numbers)."""
    _, up, towards = camera.axes
    distance = 0.5 * camera.height / np.tan(np.radians(0.5 * CAMERA_OPENING)) + camera.depth
    return [*(camera.focus + distance * towards).tolist(), *camera.focus.tolist(), *up.tolist()]


def _size(motion: Motion) -> float:
    low, high = motion.box
    return float(np.linalg.norm(high - low))


def _body(k3d: Any, motion: Motion, shape: Shape) -> list[Any]:
    """The surface and the lines of a body."""
    color = int(shape.color[1:], 16) if shape.values is None else UNCHANGED_COLOR
    width = (
        RELATIVE_LINE_WIDTH * max(float(np.ptp(shape.points)), 1e-9) if len(shape.points) else 0.0
    )
    made = []
    if len(shape.triangles):
        made.append(_surface(k3d, shape.points, shape.triangles, color))
    if len(shape.lines):
        made.append(_lines(k3d, shape.points, shape.lines, color, width))
    for drawn in made:
        if shape.values is not None:
            shades = np.round(shape.values / (motion.largest or 1.0) * COLOR_STEPS) / COLOR_STEPS
            ends = np.linspace(0.0, 1.0, COLOR_STEPS + 1)
            drawn.color_map = np.column_stack([ends, COLOR_MAP(ends)[:, :3]]).ravel().tolist()
            drawn.color_range = [0.0, 1.0]
            drawn.attribute = _series(frames(motion, motion.deforming.times), shades)
    return made


def _mark(k3d: Any, motion: Motion, mark: Mark) -> Any:
    color, glyph = int(mark.color[1:], 16), mark.glyph
    if not len(glyph.triangles):
        width = RELATIVE_LINE_WIDTH * _size(motion)
        return _lines(k3d, glyph.points, glyph.lines, color, width)
    drawn = _surface(k3d, glyph.points, glyph.triangles, color)
    drawn.opacity = mark.opacity
    return drawn


def _surface(k3d: Any, points: Array, triangles: IntArray, color: int) -> Any:
    return k3d.mesh(
        points.astype(np.float32),
        triangles.astype(np.uint32),
        side="double",
        flat_shading=True,
        color=color,
        name="",
        group="",
    )


def _lines(k3d: Any, points: Array, lines: IntArray, color: int, width: float) -> Any:
    return k3d.lines(
        points.astype(np.float32),
        lines.astype(np.uint32),
        indices_type="segment",
        shader="thick",
        width=width,
        color=color,
        name="",
        group="",
    )


def _rounded(shape: Shape) -> Array:
    """Positions in body axes (f, m, 3), in steps of a power of two, which are short when packed."""
    assert shape.u is not None
    moved = shape.points + shape.u
    size = max(float(np.abs(moved).max(initial=0.0)), np.finfo(float).tiny)
    step = POSITION_ROUNDING * 2.0 ** np.ceil(np.log2(size))
    rounded: Array = np.round(moved / step) * step
    return rounded


def frames(motion: Motion, time: Array | None = None) -> IntArray:
    """The numbers of instants among those of the motion.

    They are what K3D takes for time: keys of small fractions it does not tell apart.
    """
    return np.searchsorted(motion.time, motion.time if time is None else time)


def _series(numbers: IntArray, values: Array) -> Any:
    """Values by the number of their instant, or the value where there is one."""
    short = np.ascontiguousarray(values, dtype=np.float32)
    if (short == short[:1]).all():
        return short[0]
    return {str(number): value for number, value in zip(numbers, short, strict=True)}
