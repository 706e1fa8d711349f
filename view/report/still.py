"""A picture of the middle of a motion, for paper and for browsers that cannot draw in space."""

import base64
import io

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from ...superelement.cells import IntArray
from ...superelement.validation import Array
from ..camera import Fitting
from ..field_kinds import COLOR_MAP
from ..scene import Patch, Scene, View, paint, pane
from ..space.marks import SHAPE_OPACITY
from .motion import Motion, Shape
from .scene import cameras

STILL_WIDTH = 9.0  # [inch]
STILL_HEIGHT = 4.8  # [inch]
STILL_DOTS_PER_INCH = 100
# Large triangles are divided until so many fit into the height: painted by their distance, they
# would hide each other wrongly.
STILL_FINENESS = 25.0
MAX_DIVISIONS = 5


def still(motion: Motion) -> str:
    """The bodies and marks at the middle instant, as PNG in an address that holds it."""
    middle = len(motion.time) // 2
    drawn = [
        (_seen(motion, shape), shape.triangles, shape.lines, shape.color, _shares(motion, shape))
        for shape in motion.shapes
    ]
    around = []
    for mark in motion.moving.marks:
        seen = mark.position(slice(middle, middle + 1))[0] - motion.origin
        if mark.kind == "shapes":
            around.append((seen, mark))
        elif mark.before:
            drawn.append((seen, mark.glyph.triangles, mark.glyph.lines, mark.color, None))
    fitting = Fitting(cameras(motion)["Overview"].axes)
    for seen in (*(part[0] for part in drawn), *(part[0] for part in around)):
        fitting.take(seen)
    camera, size = fitting.camera(STILL_WIDTH / STILL_HEIGHT), np.array([STILL_WIDTH, STILL_HEIGHT])
    view = View(camera, size, size)
    figure = Figure(figsize=(STILL_WIDTH, STILL_HEIGHT))
    axes = pane(figure, (0.0, 0.0, 1.0, 1.0), view)
    for seen, mark in around:
        corners, tint = view.on_paper(seen[mark.glyph.triangles]), to_rgb(mark.color)
        faint = PolyCollection([*corners], facecolors=[tint], linewidths=0.0, alpha=SHAPE_OPACITY)
        axes.add_collection(faint)
    longest = camera.height / STILL_FINENESS
    patches = [
        _patch(seen, triangles, color, shares, longest)
        for seen, triangles, _, color, shares in drawn
    ]
    lines = np.concatenate([seen[lines] for seen, _, lines, *_ in drawn])
    paint(axes, Scene(patches, lines), view)
    image = io.BytesIO()
    figure.savefig(image, format="png", dpi=STILL_DOTS_PER_INCH)
    return f"data:image/png;base64,{base64.b64encode(image.getvalue()).decode('ascii')}"


def _patch(
    points: Array, triangles: IntArray, color: str, shares: Array | None, longest: float
) -> Patch:
    """A surface that is seen from both sides, of one color or of those of its values."""
    values = np.zeros(len(points)) if shares is None else shares
    corners = _divided(np.column_stack([points, values])[triangles], longest)
    both = np.concatenate([corners, corners[:, ::-1]])
    colors = np.tile(to_rgb(color), (len(both), 1))
    if shares is not None:
        colors = COLOR_MAP(both[..., 3].mean(axis=1))[:, :3]
    return Patch(both[..., :3], np.full(len(both), -1), colors)


def _divided(corners: Array, longest: float) -> Array:
    """Triangles (m, 3, 3 and values) with sides of at most about this length.

    Large ones hide wrongly.
    """
    for _ in range(MAX_DIVISIONS):
        edges = (corners - np.roll(corners, 1, axis=1))[..., :3]
        sides = np.linalg.norm(edges, axis=2).max(axis=1)
        large = corners[sides > longest]
        if not len(large):
            break
        a, b, c = large.transpose(1, 0, 2)
        p, q, r = 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)
        quarters = [(a, p, r), (p, b, q), (r, q, c), (p, q, r)]
        parts = [np.stack(quarter, axis=1) for quarter in quarters]
        corners = np.concatenate([corners[sides <= longest], *parts])
    return corners


def _seen(motion: Motion, shape: Shape) -> Array:
    """The points of a body in space at the middle instant (m, 3)."""
    points = shape.points if shape.u is None else shape.points + shape.u[_deformed_at(motion)]
    pose = shape.poses[len(motion.time) // 2]
    placed: Array = points @ pose[:3, :3].T + pose[:3, 3]
    return placed


def _shares(motion: Motion, shape: Shape) -> Array | None:
    """The values (m,) of a body then, over the end of the scale of colors."""
    if shape.values is None:
        return None
    shares: Array = shape.values[_deformed_at(motion)] / (motion.largest or 1.0)
    return shares


def _deformed_at(motion: Motion) -> int:
    """The instant of deformation that is nearest to the middle one."""
    middle = motion.time[len(motion.time) // 2]
    return int(np.abs(motion.deforming.times - middle).argmin())
