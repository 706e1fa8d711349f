"""The shapes of marks, of unit size about the origin, with z as their axis."""

import numpy as np

from ...superelement import Outline
from ...superelement.validation import Array

# A mark is a few pixels wide: more corners would not be seen.
CIRCLE_CORNERS = 16
SPRING_COILS = 6


def turned(profile: Array, around: int = CIRCLE_CORNERS) -> Outline:
    """A surface of revolution.   profile (k, 2): radii and heights, from below to above"""
    angles = 2.0 * np.pi * np.arange(around) / around
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    rings = [np.column_stack([r * ring, np.full(around, z)]) for r, z in profile]
    here = np.arange(around)
    beside = (here + 1) % around
    triangles = []
    for k in range(len(profile) - 1):
        low, high = k * around, (k + 1) * around
        triangles.append(np.column_stack([low + here, low + beside, high + beside]))
        triangles.append(np.column_stack([low + here, high + beside, high + here]))
    return Outline(np.concatenate(rings), np.concatenate(triangles))


def tube() -> Outline:
    """An open cylinder of radius 1 from z = -0.5 to 0.5."""
    return turned(np.array([(1.0, -0.5), (1.0, 0.5)]), 2 * CIRCLE_CORNERS)


def extruded(curve: Array) -> Outline:
    """A strip along a curve (n, 2) in the plane of x and y, from z = -0.5 to 0.5."""
    n = len(curve)
    points = np.vstack([np.column_stack([curve, np.full(n, z)]) for z in (-0.5, 0.5)])
    here = np.arange(n - 1)
    lower = np.column_stack([here, here + 1, here + n + 1])
    upper = np.column_stack([here, here + n + 1, here + n])
    return Outline(points, np.concatenate([lower, upper]))


def arrow() -> Outline:
    """From the origin to z = 1."""
    return turned(np.array([(0, 0), (0.025, 0), (0.025, 0.75), (0.07, 0.75), (0, 1)]))


def triad() -> Outline:
    """Three lines of length 1 along the axes."""
    return Outline(np.vstack([np.zeros(3), np.eye(3)]), np.array([(0, 1), (0, 2), (0, 3)]))


def coil() -> Outline:
    """A zigzag from the origin to z = 1, half as wide as 1 in x, for springs."""
    turns = np.arange(1, 2 * SPRING_COILS) / (2 * SPRING_COILS)
    heights = np.concatenate([[0.0, 0.15], 0.15 + 0.7 * turns, [0.85, 1.0]])
    across = np.zeros(len(heights))
    across[2:-2] = 0.5 * (-1.0) ** np.arange(2 * SPRING_COILS - 1)
    points = np.column_stack([across, np.zeros(len(heights)), heights])
    here = np.arange(len(heights) - 1)
    return Outline(points, np.column_stack([here, here + 1]))


def segment() -> Outline:
    """A line from the origin to z = 1."""
    return Outline(np.array([(0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]), np.array([(0, 1)]))
