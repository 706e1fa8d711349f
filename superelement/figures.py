"""Outlines of simple figures: boxes, cylinders, spheres."""

from typing import Any

import numpy as np

from ..files.arrays import Array, IntArray
from .cells import padded
from .outline import Outline

# A polygon of 32 corners stays within 0.5 % of the circle.
POINTS_AROUND_AXIS = 32
# Between the poles: as far apart as the points around the axis.
RINGS_OF_SPHERE = 15
# Corners are counted along z first, then y, then x.
_FACES_OF_BOX = np.array(
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
)


def box(edges: Any, center: Any = (0.0, 0.0, 0.0), axes: Array | None = None) -> Outline:
    """A box with edges (3,) [m] along axes, the columns of (3, 3), about a center (3,)."""
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    turn = np.eye(3) if axes is None else axes
    return Outline(corners * np.array(edges) @ turn.T + np.array(center), _FACES_OF_BOX)


def cylinder(radius: float, length: float, axis: Array, center: Any = (0.0, 0.0, 0.0)) -> Outline:
    """A cylinder about a unit axis (3,), its middle at a center (3,) [m]."""
    angles = 2.0 * np.pi / POINTS_AROUND_AXIS * np.arange(POINTS_AROUND_AXIS)
    across = across_of(axis)
    rim = radius * (np.column_stack([np.cos(angles), np.sin(angles)]) @ across)
    ends = [rim - 0.5 * length * axis, rim + 0.5 * length * axis]
    # The last two points are the centers of the end faces, which are fans of triangles.
    caps = [-0.5 * length * axis[None], 0.5 * length * axis[None]]
    first = np.arange(POINTS_AROUND_AXIS)
    after = np.roll(first, -1)
    bottom, top = (
        np.full(POINTS_AROUND_AXIS, 2 * POINTS_AROUND_AXIS),
        np.full(POINTS_AROUND_AXIS, 2 * POINTS_AROUND_AXIS + 1),
    )
    sides = np.column_stack([first, after, after + POINTS_AROUND_AXIS, first + POINTS_AROUND_AXIS])
    fans = [
        np.column_stack([bottom, after, first]),
        np.column_stack([top, first + POINTS_AROUND_AXIS, after + POINTS_AROUND_AXIS]),
    ]
    return Outline(np.concatenate([*ends, *caps]) + np.array(center), padded([sides, *fans]))


def sphere(radius: float, center: Any = (0.0, 0.0, 0.0)) -> Outline:
    """A sphere about a center (3,) [m]."""
    polar = np.pi / (RINGS_OF_SPHERE + 1) * np.arange(1, RINGS_OF_SPHERE + 1)
    angles = 2.0 * np.pi / POINTS_AROUND_AXIS * np.arange(POINTS_AROUND_AXIS)
    theta, phi = np.meshgrid(polar, angles, indexing="ij")
    rings = np.stack(
        [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1
    ).reshape(-1, 3)
    points = radius * np.vstack([rings, [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]])
    return Outline(points + np.array(center), padded(_of_sphere(len(rings))))


def across_of(axis: Array) -> Array:
    """Two unit vectors (2, 3) across a unit axis, which with it turn to the right."""
    # The coordinate axis that is farthest from parallel, so that the cross product is well
    # conditioned.
    least = np.eye(3)[np.argmin(np.abs(axis))]
    one = np.cross(axis, least)
    one /= np.linalg.norm(one)
    return np.array([one, np.cross(axis, one)])


def _of_sphere(n: int) -> list[IntArray]:
    """Quads between the rings of a sphere of n points, and triangles at its poles."""
    number = np.arange(n).reshape(RINGS_OF_SPHERE, POINTS_AROUND_AXIS)
    after = np.roll(number, -1, axis=1)
    sides = np.stack([number[:-1], number[1:], after[1:], after[:-1]], axis=-1).reshape(-1, 4)
    north, south = np.full(POINTS_AROUND_AXIS, n), np.full(POINTS_AROUND_AXIS, n + 1)
    return [
        sides,
        np.column_stack([north, number[0], after[0]]),
        np.column_stack([south, after[-1], number[-1]]),
    ]
