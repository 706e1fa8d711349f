"""The motion of a run as a scene of K3D, in the bytes that it loads in a browser."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex, to_rgb

from ...superelement.validation import Array
from ..camera import ISO, axes_towards
from ..space.marks import SEEN_THROUGH
from ..styles import COLORS
from .libraries import package
from .motion import Mark, Motion, Shape
from .simplify import IntArray

GROUPS = {
    "joints": "#1c2733",
    "motions": "#1c2733",
    "motors": "#7b3fa0",
    "stops": "#7b3fa0",
    "springs": "#00785a",
    "couplers": "#00785a",
    "contacts": "#d55e00",
}
"""colors of what acts between bodies, by its kind"""
COLOR_MAP = "viridis"
LINKS = ("springs", "couplers")
"""drawn as a line between their frames too"""
MOST_MARKS, MARKED = 60, 301
"""with names, and their instants"""
SQUARES = 12
"""of the grid, along the longest side at least"""
PALE = 0.45
"""of the colors of bodies, how much white"""
FINE = 2.0**-14
"""positions are rounded to this part of the size of a body, or less"""
SHADES = 255
SURROUNDINGS = "#b08d57"
"""color of the shapes of contacts"""
GRID = 0xC9D1D9
WHITE = 0xFFFFFF
"""what colors of a field are multiplied with"""
FOV = 30.0
"""opening of the camera [degrees]"""


def body_colors(shapes: Sequence[Shape]) -> list[str]:
    """The color of each body without a field, one after the other."""
    return [_pale(COLORS[i % len(COLORS)]) for i in range(len(shapes))]


def _pale(color: str) -> str:
    red, green, blue = (PALE + (1.0 - PALE) * part for part in to_rgb(color))
    return to_hex((red, green, blue))


def largest_value(motion: Motion) -> float:
    """The end of the scale of the field, for all bodies and instants."""
    fields = [shape.values for shape in motion.shapes if shape.values is not None]
    return max((float(values.max(initial=0.0)) for values in fields), default=0.0)


def color_bar() -> list[str]:
    """The colors of the scale, from its end to 0."""
    return [to_hex(color) for color in colormaps[COLOR_MAP](np.linspace(1.0, 0.0, 12))]


def scene(motion: Motion) -> bytes:
    """All bodies, marks and names, over time."""
    k3d = package("k3d")
    low, high = bounds(motion)
    plot = k3d.plot(
        menu_visibility=False,
        grid_visible=False,
        camera_auto_fit=False,
        camera_fov=FOV,
        colorbar_object_id=0,
        axes_helper=0.0,
        antialias=3,
    )
    plot += _grid(k3d, low, high)
    plot.camera = cameras(motion)["Overview"]
    for shape, color in zip(motion.shapes, body_colors(motion.shapes), strict=True):
        for drawn in _drawn(k3d, motion, shape, color):
            plot += drawn
    for shape in motion.surroundings:
        for drawn in _drawn(k3d, motion, shape, SURROUNDINGS):
            drawn.opacity = SEEN_THROUGH
            plot += drawn
    for drawn in _marks(k3d, motion, float(np.linalg.norm(high - low))):
        plot += drawn
    snapshot: bytes = plot.get_binary_snapshot(9)
    return snapshot


def bounds(motion: Motion) -> tuple[Array, Array]:
    """The box that holds all bodies at all times (3,), (3,) [m], with some room."""
    lows, highs = [], []
    for shape in (*motion.shapes, *motion.surroundings):
        if len(shape.points):
            reach = float(np.linalg.norm(shape.points, axis=1).max())
            if shape.u is not None:
                reach += float(np.linalg.norm(shape.u, axis=-1).max(initial=0.0))
            tight = _corners(shape, reach)
            lows.append(tight.min(axis=(0, 1)))
            highs.append(tight.max(axis=(0, 1)))
    if not lows:
        return -np.ones(3), np.ones(3)
    low, high = np.min(lows, axis=0), np.max(highs, axis=0)
    least = 0.02 * float(np.linalg.norm(high - low)) + 1e-12
    thin = np.maximum(least - (high - low), 0.0)
    return low - 0.5 * thin, high + 0.5 * thin


def _corners(shape: Shape, reach: float) -> Array:
    """The corners (k, 8, 3) of the box of a body in space."""
    more = 0.0 if shape.u is None else np.abs(shape.u).max(axis=(0, 1), initial=0.0)
    low, high = shape.points.min(axis=0) - more, shape.points.max(axis=0) + more
    corners = np.array(np.meshgrid(*zip(low, high, strict=True))).reshape(3, 8)
    turned = np.einsum("kij,jc->kci", shape.poses[:, :3, :3], corners)
    moved: Array = turned + shape.poses[:, None, :3, 3]
    return moved


def square(motion: Motion) -> float:
    """The side of the squares of the grid: 1, 2 or 5 times a power of ten [m]."""
    low, high = bounds(motion)
    return _square(low, high)


def _square(low: Array, high: Array) -> float:
    wanted = float((high - low)[:2].max()) / SQUARES
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(power * max(step for step in (1.0, 2.0, 5.0) if step * power <= wanted))


def _grid(k3d: Any, low: Array, high: Array) -> Any:
    """Squares in the plane x y below all bodies."""
    side = _square(low, high)
    first, last = np.floor(low / side)[:2], np.ceil(high / side)[:2]
    x, y = (side * np.arange(a, b + 0.5) for a, b in zip(first, last, strict=True))
    along_y = [[(a, y[0]), (a, y[-1])] for a in x]
    along_x = [[(x[0], b), (x[-1], b)] for b in y]
    plane = np.array(along_y + along_x).reshape(-1, 2)
    points = np.column_stack([plane, np.full(len(plane), low[2])]).astype(np.float32)
    pairs = np.arange(len(points), dtype=np.uint32).reshape(-1, 2)
    return k3d.lines(points, pairs, indices_type="segment", shader="simple", color=GRID, name="")


def names(motion: Motion) -> dict[str, Any]:
    """The names of marks and the places of their first frames, by time.

    Marks that stand in one place at all times, as far as one sees, share a name.
    """
    every = max(len(motion.time) // MARKED, 1)
    rows = np.unique([*range(0, len(motion.time), every), len(motion.time) - 1])
    near = 0.015 * float(np.linalg.norm(np.subtract(*bounds(motion))))
    told: list[str] = []
    places: list[Array] = []
    for mark in motion.marks if len(motion.marks) <= MOST_MARKS else []:
        place = mark.positions[rows, 0]
        same = [i for i, other in enumerate(places) if np.abs(other - place).max() < near]
        if same:
            told[same[0]] += f", {mark.name}"
        else:
            told.append(mark.name)
            places.append(place)
    joined = np.hstack(places) if places else np.zeros((len(rows), 0))
    return {
        "names": told,
        "times": motion.time[rows].tolist(),
        "places": [[float(f"{x:.5g}") for x in row] for row in joined.tolist()],
    }


def cameras(motion: Motion) -> dict[str, list[float]]:
    """Places of the camera by name: its position, what it looks at, and what is up (9 numbers)."""
    low, high = bounds(motion)
    up = [0.0, 0.0, 1.0]
    views = {
        "Overview": _overview(high - low),
        "Along x": ([1.0, 0.0, 0.0], up),
        "Along y": ([0.0, -1.0, 0.0], up),
        "Along z": ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
    }
    return {name: _camera(low, high, *view) for name, view in views.items()}


def _overview(size: Array) -> tuple[list[float], list[float]]:
    """Onto the plane of a motion in the plane x y, and else from above and before."""
    if size[2] < 0.4 * max(size[0], size[1]):
        return [0.35, -0.7, 1.0], [0.0, 1.0, 0.0]
    return ISO.tolist(), [0.0, 0.0, 1.0]


def _camera(low: Array, high: Array, towards: list[float], up: list[float]) -> list[float]:
    right, upward, eye = axes_towards(np.array(towards), np.array(up))
    middle = 0.5 * (low + high)
    half = 0.5 * (high - low)
    tall, wide = float(np.abs(upward) @ half), float(np.abs(right) @ half)
    deep = float(np.abs(eye) @ half)
    distance = 1.15 * max(tall, wide / 1.8) / np.tan(np.radians(0.5 * FOV)) + deep
    return [*(middle + distance * eye).tolist(), *middle.tolist(), *np.array(up).tolist()]


def _drawn(k3d: Any, motion: Motion, shape: Shape, color: str) -> list[Any]:
    """The surface and the lines of a body."""
    plain = int(color[1:], 16) if shape.values is None else WHITE
    common = {"color": plain, "name": "", "group": ""}
    points = shape.points.astype(np.float32)
    made = []
    if len(shape.triangles):
        surface = k3d.mesh(
            points, shape.triangles.astype(np.uint32), side="double", flat_shading=True, **common
        )
        made.append(surface)
    if len(shape.lines):
        lines = k3d.lines(
            points,
            shape.lines.astype(np.uint32),
            indices_type="segment",
            shader="thick",
            width=0.004 * max(float(np.ptp(points)), 1e-9),
            **common,
        )
        made.append(lines)
    for drawn in made:
        drawn.model_matrix = _series(frames(motion), shape.poses)
        if shape.u is not None:
            drawn.vertices = _series(frames(motion, motion.deforming), _rounded(shape))
        if shape.values is not None:
            largest = largest_value(motion) or 1.0
            shades = np.round(shape.values / largest * SHADES) / SHADES
            drawn.color_map = k3d.matplotlib_color_maps.Viridis
            drawn.color_range = [0.0, 1.0]
            drawn.attribute = _series(frames(motion, motion.deforming), shades)
    return made


def _rounded(shape: Shape) -> Array:
    """Positions in body axes (f, m, 3), in steps of a power of two, which are short when packed."""
    assert shape.u is not None
    moved = shape.points + shape.u
    size = max(float(np.abs(moved).max(initial=0.0)), np.finfo(float).tiny)
    step = FINE * 2.0 ** np.ceil(np.log2(size))
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
    if len(numbers) == 1:
        return short[0]
    return {str(number): value for number, value in zip(numbers, short, strict=True)}


def _marks(k3d: Any, motion: Motion, size: float) -> list[Any]:
    """A dot at each frame, lines of springs, and names."""
    made = []
    for group, color in GROUPS.items():
        marks = [mark for mark in motion.marks if mark.group == group]
        if marks:
            made += _of_group(k3d, motion, marks, int(color[1:], 16), size, group in LINKS)
    return made


def _of_group(
    k3d: Any, motion: Motion, marks: Sequence[Mark], color: int, size: float, link: bool
) -> list[Any]:
    places = np.concatenate([mark.positions for mark in marks], axis=1)
    look: Mapping[str, Any] = {"color": color, "name": "", "group": ""}
    start = places[0].astype(np.float32)
    dots = k3d.points(start, point_size=0.012 * size, shader="3d", **look)
    dots.positions = _series(frames(motion), places)
    made = [dots]
    if link:
        pairs = np.arange(2 * len(marks), dtype=np.uint32).reshape(-1, 2)
        lines = k3d.lines(
            start, pairs, indices_type="segment", shader="thick", width=0.004 * size, **look
        )
        lines.vertices = _series(frames(motion), places)
        made.append(lines)
    return made
