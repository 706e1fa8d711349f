"""Bodies in space as pictures: shaded surfaces, lines, and points with their names."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import hsv_to_rgb, to_rgb
from matplotlib.figure import Figure

from ..superelement.cells import IntArray
from ..superelement.validation import Array
from .camera import ISOMETRIC_EYE, UPWARD, Camera, Fitting, axes_towards
from .picture import style
from .styles import COLORS

BODY_COLOR = (0.82, 0.84, 0.87)
MASS_COLOR = (0.15, 0.15, 0.15)
AXIS_COLORS = (("x", "#c1272d"), ("y", "#2e8b40"), ("z", "#2456a6"))
# Of its length: an axis along the line of sight is a dot, and its letter would lie on the others.
LEAST_SEEN_AXIS = 0.1
# In the axes of the picture: from above the left shoulder, as drawings have it.
TOWARDS_LIGHT = np.array([-0.35, 0.55, 0.76]) / np.linalg.norm([-0.35, 0.55, 0.76])
# So much that the color of a marked face is known in the shade too.
AMBIENT_LIGHT = 0.68
# Light colors let the colors of marks stand out.
TINT_WHITENESS = 0.45
PLAN_WIDTH = 9.0  # [inch]
MAX_BODY_HEIGHT = 4.6  # [inch]
PLAN_MARGIN = 0.3  # [inch]
TEXT_LINE_HEIGHT = 0.2  # [inch]
LETTER_WIDTH = 0.085  # [inch]
SECTION_AXIS_LENGTH = 0.45  # [inch]
# A PDF or SVG holds them one by one; more are a picture in it: tens of megabytes else.
MAX_VECTOR_FACETS = 3000
# Seen ones: edges of more would blacken the picture.
MAX_EDGED_FACETS = 20_000


@dataclass(frozen=True, eq=False)
class Patch:
    """Facets of one shape, see `Scene` for an example.

    Parameters
    ----------
    facets : (m, k, 3) [m]
        Corners that turn outwards.
    markers : (m,)
        The marker that each belongs to, -1 for none.
    colors : (m, 3), optional
        By default those of their markers and of bodies.
    """

    facets: Array
    markers: IntArray
    colors: Array | None = None


@dataclass(frozen=True, eq=False)
class Marker:
    """A point with a name, see `Scene` for an example.

    Parameters
    ----------
    name : str
    point : (3,) [m]
    has_axes : bool
        Whether it is a frame.
    facing : (3,), optional
        The outward normal of what it is on, which tells from which side it is seen.
    """

    name: str
    point: Array
    has_axes: bool = True
    facing: Array | None = None


@dataclass(frozen=True, eq=False)
class Cross:
    """The local axes of a section at a point of a line, for an example see `Scene`.

    Parameters
    ----------
    point : (3,) [m]
    y, z : (3,)
        Unit vectors.
    """

    point: Array
    y: Array
    z: Array


@dataclass(frozen=True, eq=False)
class Scene:
    """A body of facets or of lines, with markers, masses, and axes of sections.

    A marker has the color of its facets.

    Parameters
    ----------
    patches : sequence of Patch
    lines : (m, 2, 3) [m]
    markers, masses : sequence of Marker
    sections : sequence of Cross

    Examples
    --------
    >>> import numpy as np
    >>> from duhamel import view
    >>> triangle = view.Patch(np.eye(3)[None], np.array([0]))
    >>> scene = view.Scene([triangle], markers=[view.Marker("tip", np.array([1.0, 0.0, 0.0]))])
    >>> scene.points.shape
    (4, 3)
    """

    patches: Sequence[Patch] = ()
    lines: Array = field(default_factory=lambda: np.zeros((0, 2, 3)))
    markers: Sequence[Marker] = ()
    masses: Sequence[Marker] = ()
    sections: Sequence[Cross] = ()

    @property
    def points(self) -> Array:
        """All points (n, 3)."""
        corners = [patch.facets.reshape(-1, 3) for patch in self.patches]
        marks = [mark.point[None] for mark in (*self.markers, *self.masses)]
        return np.concatenate([*corners, self.lines.reshape(-1, 3), *marks])


@dataclass(frozen=True, eq=False)
class View:
    """What a camera sees on paper: sizes (2,) of the paper, and of the body on it [inch]."""

    camera: Camera
    size: Array
    body: Array

    def on_paper(self, points: Array) -> Array:
        """(..., 3) in space to (..., 2) from the middle of the paper [inch]."""
        return self.camera.seen(points) * float(self.size[1])


def color(number: int) -> tuple[float, float, float]:
    """The color of a marker: those of all pictures, then further ones, each far from the last."""
    if number < len(COLORS):
        return to_rgb(COLORS[number])
    red, green, blue = hsv_to_rgb((0.618034 * number % 1.0, 0.75, 0.85)).tolist()
    return red, green, blue


def tint(number: int) -> tuple[float, float, float]:
    """A light color for a body."""
    red, green, blue = (
        TINT_WHITENESS + (1.0 - TINT_WHITENESS) * channel for channel in color(number)
    )
    return red, green, blue


def draw_scene(scene: Scene) -> Figure:
    """Draw a view of lines, or two views of surfaces from opposite sides, at one scale.

    A marker has its name in the view that shows more of its facets.

    Examples
    --------
    >>> import numpy as np
    >>> from duhamel import view
    >>> triangle = view.Patch(np.eye(3)[None], np.array([0]))
    >>> tip = view.Marker("tip", np.array([1.0, 0.0, 0.0]))
    >>> figure = view.draw_scene(view.Scene([triangle], markers=[tip]))
    >>> len(figure.axes)
    2
    """
    eyes = (ISOMETRIC_EYE, -ISOMETRIC_EYE) if scene.patches else (ISOMETRIC_EYE,)
    cameras = [axes_towards(eye, UPWARD) for eye in eyes]
    marks = (*scene.markers, *scene.masses)
    shades = [*(color(i) for i in range(len(scene.markers))), *(MASS_COLOR for _ in scene.masses)]
    where = _best_views(scene, cameras)
    views, beside = _layout(scene, cameras)
    columns, rows = (len(views), 1) if beside else (1, len(views))
    with style():
        figure = Figure(figsize=tuple(views[0].size * (columns, rows)))
        for i, view in enumerate(views):
            across, down = i % columns, i // columns
            place = (across / columns, 1.0 - (down + 1) / rows, 1.0 / columns, 1.0 / rows)
            axes = pane(figure, place, view)
            paint(axes, scene, view)
            draw_triad(axes, view.camera.axes, -0.5 * view.size + 0.35, 0.22, 1.6, 8.0)
            _axes_of_sections(axes, scene.sections, view)
            shown = [n for n in range(len(marks)) if where[n] == i]
            _name(axes, [marks[n] for n in shown], [shades[n] for n in shown], view)
    return figure


def pane(figure: Figure, place: tuple[float, float, float, float], view: View) -> Axes:
    """The axes of a view, in inches from its middle, at a place in a figure."""
    axes = figure.add_axes(place)
    axes.set_axis_off()
    axes.set_xlim(-0.5 * view.size[0], 0.5 * view.size[0])
    axes.set_ylim(-0.5 * view.size[1], 0.5 * view.size[1])
    return axes


def _layout(scene: Scene, cameras: Sequence[Array]) -> tuple[list[View], bool]:
    """The views, and True if they stand beside each other.

    The body fills the paper but for margins and names.
    """
    fits = [Fitting(camera) for camera in cameras]
    for fit in fits:
        fit.take(scene.points)
    extent = np.max([fit.extent[:2] for fit in fits], axis=0)
    marks = (*scene.markers, *scene.masses)
    names = PLAN_MARGIN + LETTER_WIDTH * max((len(mark.name) for mark in marks), default=0)
    beside = len(cameras) > 1 and extent[0] < 1.8 * extent[1]
    width = PLAN_WIDTH / 2 if beside else PLAN_WIDTH
    largest = np.array([max(width - 2.0 * names, 0.4 * width), MAX_BODY_HEIGHT])
    inch = float((extent / largest).max())
    height = max(extent[1] / inch, TEXT_LINE_HEIGHT * len(marks) / 2, 0.8) + 2.0 * PLAN_MARGIN
    size, body = np.array([width, height]), extent / inch
    return [View(fit.camera_of_height(inch * height), size, body) for fit in fits], beside


def _area_vectors(facets: Array) -> Array:
    """Normals (m, 3) of polygons (m, k, 3), as long as their areas, by Newell's formula."""
    areas: Array = 0.5 * np.cross(facets, np.roll(facets, -1, axis=1)).sum(axis=1)
    return areas


def _best_views(scene: Scene, cameras: Sequence[Array]) -> IntArray:
    """The view (n,) in which more facets of each marker and mass face the eye.

    For points the nearer view.
    """
    middle = scene.points.mean(axis=0)
    marks = (*scene.markers, *scene.masses)
    shown = np.zeros((len(marks), len(cameras)))
    for patch in scene.patches:
        marked = patch.markers >= 0
        areas = _area_vectors(patch.facets[marked])
        for view, camera in enumerate(cameras):
            shown[:, view] += np.bincount(
                patch.markers[marked], np.maximum(areas @ camera[2], 0.0), len(marks)
            )
    for row, mark in zip(shown, marks, strict=True):
        if not row.any():
            outward = mark.point - middle if mark.facing is None else mark.facing
            row[:] = [outward @ camera[2] for camera in cameras]
    # What shows alike on both sides is named on the first.
    best: IntArray = np.argmax(
        shown >= shown.max(axis=1, keepdims=True) - 1e-2 * np.abs(shown), axis=1
    )
    return best


def paint(axes: Axes, scene: Scene, view: View) -> None:
    """Facets that face the eye, from the farthest to the nearest, and lines."""
    base = np.array([*(color(i) for i in range(len(scene.markers))), BODY_COLOR])
    polygons: list[Array] = []
    depths, shades, rims = [np.zeros(0)], [np.zeros((0, 3))], [np.zeros((0, 3))]
    # Edges in the color of the face close the gaps that smoothing leaves between neighbors.
    fine = sum(len(patch.facets) for patch in scene.patches) > 2 * MAX_EDGED_FACETS
    for patch in scene.patches:
        areas = _area_vectors(patch.facets) @ view.camera.axes.T
        seen = areas[:, 2] > 0.0
        normals = areas[seen] / np.linalg.norm(areas[seen], axis=1)[:, None]
        brightness = AMBIENT_LIGHT + (1.0 - AMBIENT_LIGHT) * np.clip(
            normals @ TOWARDS_LIGHT, 0.0, 1.0
        )
        polygons.extend(view.on_paper(patch.facets[seen]))
        depths.append((patch.facets[seen] @ view.camera.axes[2]).mean(axis=1))
        shade = base[patch.markers] if patch.colors is None else patch.colors
        shades.append(shade[seen] * brightness[:, None])
        rims.append(shades[-1] * (1.0 if fine or patch.colors is not None else 0.75))
    order = np.argsort(np.concatenate(depths))
    faces, edges = (np.concatenate(parts)[order] for parts in (shades, rims))
    facets = PolyCollection(
        [polygons[i] for i in order], facecolors=faces, edgecolors=edges, linewidths=0.3
    )
    facets.set_rasterized(len(polygons) > MAX_VECTOR_FACETS)
    axes.add_collection(facets, autolim=False)
    axes.add_collection(
        LineCollection(list(view.on_paper(scene.lines)), colors="0.45", linewidths=1.8),
        autolim=False,
    )


def _name(
    axes: Axes, marks: Sequence[Marker], shades: Sequence[tuple[float, float, float]], view: View
) -> None:
    """Dots and small axes at markers, and names in columns on both sides, with a line to each."""
    points = view.on_paper(np.array([mark.point for mark in marks]).reshape(-1, 3))
    for side in (-1.0, 1.0):
        column = np.flatnonzero((points[:, 0] >= 0.0) == (side > 0.0))
        heights = apart(
            points[column, 1], TEXT_LINE_HEIGHT, 0.5 * view.size[1] - 0.5 * TEXT_LINE_HEIGHT
        )
        x = side * (0.5 * view.body[0] + 0.6 * PLAN_MARGIN)
        for n, height in zip(column.tolist(), heights.tolist(), strict=True):
            axes.plot(
                [points[n, 0], x], [points[n, 1], height], color=shades[n], linewidth=0.8, zorder=4
            )
            align = "left" if side > 0.0 else "right"
            axes.text(
                x + 0.06 * side, height, marks[n].name, ha=align, va="center", fontsize=9, zorder=6
            )
    for mark, point, shade in zip(marks, points, shades, strict=True):
        if mark.has_axes:
            for direction, (_, axis_color) in zip(view.camera.axes[:2].T, AXIS_COLORS, strict=True):
                axes.plot(
                    *zip(point, point + 0.28 * direction, strict=True),
                    color=axis_color,
                    linewidth=1.4,
                    zorder=4,
                )
        size = 5.0 if shade is not MASS_COLOR else 7.0
        axes.plot(
            *point,
            "o",
            color=shade,
            markersize=size,
            markeredgecolor="white",
            markeredgewidth=0.8,
            zorder=5,
        )


def apart(heights: Array, distance: float, limit: float) -> Array:
    """Heights (n,) in [-limit, limit] near the given ones, `distance` apart, in the same order.

    Less apart if they do not fit. Of all such heights these are the nearest to the given ones, in
    the sense of least squares.
    """
    from scipy.optimize import isotonic_regression  # takes 0.2 s, of pictures of bodies alone

    order = np.argsort(heights, kind="stable")
    distance = min(distance, 2.0 * limit / max(len(heights) - 1, 1))
    steps = distance * (np.arange(len(heights)) - 0.5 * (len(heights) - 1))
    # Less the steps, heights that are far enough apart rise.
    rising = isotonic_regression(heights[order] - steps).x
    reach = limit - 0.5 * distance * (len(heights) - 1)
    fitted = np.empty(len(heights))
    fitted[order] = np.clip(rising, -reach, reach) + steps
    return fitted


def draw_triad(
    axes: Axes, camera: Array, at: Array, length: float, linewidth: float, fontsize: float
) -> None:
    """The directions x, y, z as a camera (3, 3) sees them, but for those along its line of sight.

    at (2,), length: where they start and how long they are, in units of the axes.
    """
    for direction, (name, shade) in zip(camera[:2].T, AXIS_COLORS, strict=True):
        seen = float(np.linalg.norm(direction))
        if seen < LEAST_SEEN_AXIS:
            continue
        tip = at + length * direction
        axes.plot(*zip(at, tip, strict=True), color=shade, linewidth=linewidth)
        x, y = tip + 0.32 * length * direction / seen
        axes.text(x, y, name, color=shade, ha="center", va="center", fontsize=fontsize)


def _axes_of_sections(axes: Axes, sections: Sequence[Cross], view: View) -> None:
    """Dashed lines along local y and z, as long as they are seen; a middle one has names."""
    for number, section in enumerate(sections):
        point = view.on_paper(section.point)
        for direction, (name, shade) in zip((section.y, section.z), AXIS_COLORS[1:], strict=True):
            tip = point + SECTION_AXIS_LENGTH * (view.camera.axes[:2] @ direction)
            axes.plot(
                *zip(point, tip, strict=True),
                color=shade,
                linewidth=1.2,
                linestyle=(0, (2, 1)),
                zorder=3,
            )
            if number == len(sections) // 2:
                x, y = point + 1.35 * (tip - point)
                axes.text(x, y, f"local {name}", color=shade, ha="center", va="center", fontsize=8)
