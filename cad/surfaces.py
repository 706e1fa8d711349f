"""Planes and cylinders that points with normals lie on, however a CAD file describes them."""

from dataclasses import dataclass

import numpy as np

from ..superelement.validation import Array

NORMAL_TOLERANCE = 1e-5
"""How far normals of one plane may differ, and how far those of a cylinder may lean to its axis."""
POSITION_TOLERANCE = 1e-5
"""Distance of points from their surface, relative to the size of the part; IGES is as rough."""
LEAST_ARC = 1e-3
"""Spread of the normals across the axis below which a strip tells no axis."""


@dataclass(frozen=True, eq=False)
class FlatSurface:
    """normal (3,): outward; offset: normal . X of its points."""

    normal: Array
    offset: float


@dataclass(frozen=True, eq=False)
class RoundSurface:
    """point (3,): on the axis; axis (3,): a unit vector; radius: negative if seen from inside."""

    point: Array
    axis: Array
    radius: float


Simple = FlatSurface | RoundSurface


def fitted_surface(points: Array, normals: Array, size: float) -> Simple | None:
    """The plane or cylinder of points (n, 3) with outward normals (n, 3); None for other surfaces.

    size: of the part, which positions are compared with.
    """
    sound = np.isfinite(points).all(axis=1) & np.isfinite(normals).all(axis=1)
    X, N = points[sound], normals[sound]
    if len(X) < 3:
        return None
    if np.linalg.norm(N - N[0], axis=1).max() <= NORMAL_TOLERANCE:
        heights = X @ N[0]
        flat = np.ptp(heights) <= POSITION_TOLERANCE * size
        return FlatSurface(N[0], float(heights.mean())) if flat else None
    return _cylinder(X, N, size)


def _cylinder(X: Array, N: Array, size: float) -> RoundSurface | None:
    """X = point + radius n + z axis, with n the normals, all across the axis."""
    _, spread, directions = np.linalg.svd(N)
    # Normals of a cylinder fill a plane: what is across of it is the axis.
    axis = directions[2]
    if spread[1] < LEAST_ARC * spread[0] or np.abs(N @ axis).max() > NORMAL_TOLERANCE:
        return None
    across = directions[:2]
    x, n = (X @ across.T).ravel(), (N @ across.T).ravel()
    # Linear in center and radius, which the normals allow; its sign tells inside from outside.
    rows = np.column_stack([np.tile(np.eye(2), (len(X), 1)), n])
    found, *_ = np.linalg.lstsq(rows, x, rcond=None)
    if np.abs(rows @ found - x).max() > POSITION_TOLERANCE * size:
        return None
    return RoundSurface(found[:2] @ across, _signed(axis), float(found[2]))


def _signed(axis: Array) -> Array:
    """The same axis with its largest component positive: axes have no sign of their own."""
    clean = np.where(np.abs(axis) < NORMAL_TOLERANCE, 0.0, axis)
    clean /= np.linalg.norm(clean)
    return np.asarray(clean * np.sign(clean[np.argmax(np.abs(clean))]))


def same(one: Simple | None, other: Simple | None, size: float) -> bool:
    """Whether two surfaces are one that was split."""
    if isinstance(one, FlatSurface) and isinstance(other, FlatSurface):
        parallel = np.linalg.norm(one.normal - other.normal) <= NORMAL_TOLERANCE
        return bool(parallel and abs(one.offset - other.offset) <= POSITION_TOLERANCE * size)
    if isinstance(one, RoundSurface) and isinstance(other, RoundSurface):
        between = other.point - one.point
        apart = float(np.linalg.norm(between - (between @ one.axis) * one.axis))
        parallel = np.linalg.norm(one.axis - other.axis) <= NORMAL_TOLERANCE
        difference = max(abs(one.radius - other.radius), apart)
        return bool(parallel and difference <= POSITION_TOLERANCE * size)
    return False


def largest_gap(points: Array, cylinder: RoundSurface) -> float:
    """The largest angle [rad] about the axis in which none of the points (n, 3) is."""
    # Any direction across the axis serves as zero.
    across = np.linalg.svd(cylinder.axis[None])[2][1:]
    x, y = ((points - cylinder.point) @ across.T).T
    angles = np.sort(np.arctan2(y, x))
    return float(np.diff(angles, append=angles[0] + 2.0 * np.pi).max())
