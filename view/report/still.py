"""A picture of the middle of a motion, for paper and for browsers that cannot draw in space."""

import base64
import io

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from ...superelement.validation import Array
from ..camera import axes_towards
from ..space.marks import SEEN_THROUGH
from .motion import Motion, Shape
from .scene import SURROUNDINGS, body_colors, bounds, cameras

WIDTH, HEIGHT, DOTS = 9.0, 4.8, 100
"""[inch], per inch"""
FINE, MOST_DIVISIONS = 25.0, 5
"""of triangles, in the size of the picture"""
LIGHT, AMBIENT = np.array([-0.35, 0.55, 0.76]), 0.62


def still(motion: Motion) -> str:
    """The bodies at the middle instant, as PNG in an address that holds it."""
    figure = Figure(figsize=(WIDTH, HEIGHT))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_aspect("equal")
    axes.set_axis_off()
    view = _axes(cameras(motion)["Overview"])
    facets, colors = [], []
    for shape, color in zip(motion.shapes, body_colors(motion.shapes), strict=True):
        seen = _seen(motion, shape) @ view.T
        if len(shape.triangles):
            corners = _divided(seen[shape.triangles], _extent(motion) / FINE)
            facets.append(corners)
            colors.append(_shaded(corners, color))
        if len(shape.lines):
            axes.add_collection(LineCollection(list(seen[shape.lines][..., :2]), colors=[color]))
    around = [(_seen(motion, s) @ view.T)[s.triangles][..., :2] for s in motion.surroundings]
    if around:
        tint = (*to_rgb(SURROUNDINGS), 0.5 * SEEN_THROUGH)
        faint = PolyCollection([*np.concatenate(around)], facecolors=[tint], linewidths=0.0)
        axes.add_collection(faint)
    if facets:
        corners, shades = np.concatenate(facets), np.concatenate(colors)
        order = np.argsort(corners[..., 2].mean(axis=1))
        polygons = list(corners[order][..., :2])
        ordered = shades[order]
        shown = PolyCollection(polygons, facecolors=ordered, edgecolors=ordered, linewidths=0.3)
        axes.add_collection(shown)
    axes.autoscale_view()
    image = io.BytesIO()
    figure.savefig(image, format="png", dpi=DOTS)
    return f"data:image/png;base64,{base64.b64encode(image.getvalue()).decode('ascii')}"


def _extent(motion: Motion) -> float:
    low, high = bounds(motion)
    return float(np.linalg.norm(high - low))


def _divided(corners: Array, longest: float) -> Array:
    """Triangles (m, 3, 3) with sides of at most about this length, for large ones hide wrongly."""
    for _ in range(MOST_DIVISIONS):
        sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
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
    middle = len(motion.time) // 2
    points = shape.points
    if shape.u is not None:
        nearest = int(np.abs(motion.deforming - motion.time[middle]).argmin())
        points = points + shape.u[nearest]
    pose = shape.poses[middle]
    placed: Array = points @ pose[:3, :3].T + pose[:3, 3]
    return placed


def _axes(camera: list[float]) -> Array:
    """To the right, up and towards the eye (3, 3)."""
    place, target, up = np.reshape(camera, (3, 3))
    return axes_towards(place - target, up)


def _shaded(corners: Array, color: str) -> Array:
    a, b, c = corners.transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    facing = np.abs(normals @ LIGHT) / np.where(lengths > 0.0, lengths, 1.0)
    bright = AMBIENT + (1.0 - AMBIENT) * np.minimum(facing / np.linalg.norm(LIGHT), 1.0)
    shades: Array = bright[:, None] * np.array(to_rgb(color))
    return shades
