"""Shapes that a ball touches, an open set: the distance of a point from a surface.

At a point y, in the axes of the frame that carries the shape, a shape gives

    s           signed distance, positive outside
    n           its gradient, the unit normal
    K           its second derivatives (xx, yy, zz, yz, xz, xy), which are the curvatures
    beyond      how far y is past an end of the shape, negative before it; -inf: there is none

`axis` (3,): normal of a plane, axis of a cylinder; `across` (3,): a unit vector perpendicular to
it, the normal where the distance has none of its own. A shape is a class with `@shape`.
"""

import math
from collections.abc import Callable
from typing import Any, TypeVar

from ..arrays import Array
from ..compiler.dispatch import dispatcher
from ..compiler.marks import compiled
from .vectors import Vector, add, cross, dot, scale, subtract

Curvature = tuple[float, float, float, float, float, float]
Surface = tuple[float, Vector, Curvature, float]
"""distance, normal, curvature and how far beyond the ends"""

NO_CURVATURE = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
NUMBERS_PER_PIECE = 9
"""length of a piece of a profile, and the four coefficients of both coordinates"""
SAMPLES_PER_PIECE = 5
"""points of a piece from which the nearest one is chosen to start with"""
MAX_POINT_CORRECTIONS = 50
"""iterations of Newton's method for the nearest point of a profile"""
POINT_PRECISION = 1e-15
"""correction of the nearest point, over the length of its piece, that counts as none"""
MIN_CENTER_DISTANCE = 1e-3
"""least distance from a center of curvature, where normals cross, over the radius"""
NEGLIGIBLE_OVERRUN = 1e-9
"""distance past an end, over the length of a piece, that counts as none"""
RADIUS, HALF_LENGTH = 0, 1
"""places of the parameters of a sphere, which has the first alone, and of a cylinder"""
SHAPE_KINDS: list[Any] = []
"""shapes, in the order of their numbers"""
AnyShape = TypeVar("AnyShape", bound=type)


def shape(kind: AnyShape) -> AnyShape:
    """Register a shape: a class with a compiled function `at`."""
    registered: Any = kind
    registered.number = len(SHAPE_KINDS)
    compiled(registered.at)
    SHAPE_KINDS.append(registered)
    return kind


@compiled
def _round(R: float, p: Vector, axis: Vector, across: Vector) -> tuple[float, Vector, Curvature]:
    """|p| - R about an axis, or about a point where that is zero."""
    length = math.sqrt(dot(p, p))
    # At the center every direction is normal; a fixed one keeps the force finite.
    if length == 0.0:
        return -R, across, NO_CURVATURE
    n = scale(1.0 / length, p)
    a = axis
    return (
        length - R,
        n,
        (
            (1.0 - n[0] * n[0] - a[0] * a[0]) / length,
            (1.0 - n[1] * n[1] - a[1] * a[1]) / length,
            (1.0 - n[2] * n[2] - a[2] * a[2]) / length,
            -(n[1] * n[2] + a[1] * a[2]) / length,
            -(n[0] * n[2] + a[0] * a[2]) / length,
            -(n[0] * n[1] + a[0] * a[1]) / length,
        ),
    )


@shape
class Plane:
    """s = axis . y"""

    number: int

    @staticmethod
    def at(parameters: Array, axis: Vector, across: Vector, y: Vector) -> Surface:
        return dot(axis, y), axis, NO_CURVATURE, -math.inf


@shape
class Sphere:
    """s = |y| - R; parameter: R."""

    number: int

    @staticmethod
    def at(parameters: Array, axis: Vector, across: Vector, y: Vector) -> Surface:
        s, n, K = _round(parameters[RADIUS], y, (0.0, 0.0, 0.0), across)
        return s, n, K, -math.inf


@shape
class Cylinder:
    """s = |y - (axis . y) axis| - R; parameters: R and half the length."""

    number: int

    @staticmethod
    def at(parameters: Array, axis: Vector, across: Vector, y: Vector) -> Surface:
        along = dot(axis, y)
        s, n, K = _round(parameters[RADIUS], subtract(y, scale(along, axis)), axis, across)
        return s, n, K, abs(along) - parameters[HALF_LENGTH]


@shape
class Profile:
    """s = (p - c) . n at the point c of a plane spline that is nearest to p = (across, up) . y.

    The outside is to the right of the curve. Parameters: number of pieces, then of each piece its
    length and the coefficients of both coordinates, from the cube to the constant.
    """

    number: int

    @staticmethod
    def at(parameters: Array, axis: Vector, across: Vector, y: Vector) -> Surface:
        up = cross(axis, across)
        px, py = dot(across, y), dot(up, y)
        piece, t = nearest(parameters, px, py)
        x, dx, ddx = cubic(parameters, piece, 1, t)
        z, dz, ddz = cubic(parameters, piece, 5, t)
        speed = math.sqrt(dx * dx + dz * dz)
        tx, tz = dx / speed, dz / speed
        s = (px - x) * tz - (py - z) * tx
        beyond = abs((px - x) * tx + (py - z) * tz)
        bend = (dx * ddz - dz * ddx) / (speed * speed * speed)
        # Beyond the center of curvature the formula changes sign: the bound keeps the tangent
        # finite.
        k = bend / max(1.0 + bend * s, MIN_CENTER_DISTANCE)
        t_ = add(scale(tx, across), scale(tz, up))
        n = subtract(scale(tz, across), scale(tx, up))
        K = (
            k * t_[0] * t_[0],
            k * t_[1] * t_[1],
            k * t_[2] * t_[2],
            k * t_[1] * t_[2],
            k * t_[0] * t_[2],
            k * t_[0] * t_[1],
        )
        if not beyond > NEGLIGIBLE_OVERRUN * speed:
            beyond = -_distance_from_ends(parameters, x, z)
        return s, n, K, beyond


@compiled
def _distance_from_ends(parameters: Array, x: float, z: float) -> float:
    """The distance of a point of a profile from the nearer of its ends."""
    last = int(parameters[0]) - 1
    if parameters[1 + NUMBERS_PER_PIECE * (last + 1)] > 0.0:
        return math.inf  # it is closed
    first_x, _, _ = cubic(parameters, 0, 1, 0.0)
    first_z, _, _ = cubic(parameters, 0, 5, 0.0)
    length = parameters[1 + NUMBERS_PER_PIECE * last]
    last_x, _, _ = cubic(parameters, last, 1, length)
    last_z, _, _ = cubic(parameters, last, 5, length)
    return math.sqrt(
        min(
            (x - first_x) * (x - first_x) + (z - first_z) * (z - first_z),
            (x - last_x) * (x - last_x) + (z - last_z) * (z - last_z),
        )
    )


@compiled
def cubic(parameters: Array, piece: int, coordinate: int, t: float) -> tuple[float, float, float]:
    """A coordinate of a piece at t, and its derivatives."""
    k = 1 + NUMBERS_PER_PIECE * piece + coordinate
    a, b, c, d = parameters[k], parameters[k + 1], parameters[k + 2], parameters[k + 3]
    return ((a * t + b) * t + c) * t + d, (3.0 * a * t + 2.0 * b) * t + c, 6.0 * a * t + 2.0 * b


@compiled
def nearest(parameters: Array, px: float, py: float) -> tuple[int, float]:
    """The piece and its parameter of the point that is nearest to (px, py)."""
    best, piece, at = math.inf, 0, 0.0
    n = int(parameters[0])
    for i in range(n):
        square = _square_from_start(parameters, i, px, py)
        if square < best:
            best, piece = square, i
    for i in range(n):
        length = parameters[1 + NUMBERS_PER_PIECE * i]
        # Most pieces are too far, from their start on, to come nearer than the nearest start.
        near = math.sqrt(best) + length * _top_speed(parameters, i, length)
        if _square_from_start(parameters, i, px, py) > near * near:
            continue
        # Newton's method finds a near extremum only: samples keep it from a farther one.
        for sample in range(SAMPLES_PER_PIECE):
            t = length * sample / (SAMPLES_PER_PIECE - 1.0)
            x, _, _ = cubic(parameters, i, 1, t)
            z, _, _ = cubic(parameters, i, 5, t)
            square = (px - x) * (px - x) + (py - z) * (py - z)
            if square < best:
                best, piece, at = square, i, t
    return polished(parameters, n, piece, at, px, py)


@compiled
def _square_from_start(parameters: Array, i: int, px: float, py: float) -> float:
    """The squared distance of a point from the start of piece i."""
    first = 1 + NUMBERS_PER_PIECE * i
    x, z = px - parameters[first + 4], py - parameters[first + 8]
    return float(x * x + z * z)


@compiled
def _top_speed(parameters: Array, i: int, length: float) -> float:
    """A bound of the way along piece i per its parameter."""
    total, first = 0.0, 1 + NUMBERS_PER_PIECE * i
    for k in (first + 1, first + 5):
        a, b, c = parameters[k], parameters[k + 1], parameters[k + 2]
        total += (3.0 * length * abs(a) + 2.0 * abs(b)) * length + abs(c)
    return total


@compiled
def polished(
    parameters: Array, n: int, piece: int, t: float, px: float, py: float
) -> tuple[int, float]:
    """Newton's method for (p - c) . c' = 0, over the ends of pieces that go on."""
    closed = parameters[1 + NUMBERS_PER_PIECE * n] > 0.0
    for _ in range(MAX_POINT_CORRECTIONS):
        x, dx, ddx = cubic(parameters, piece, 1, t)
        z, dz, ddz = cubic(parameters, piece, 5, t)
        slope = dx * dx + dz * dz
        # Beyond a center of curvature the second derivative is negative, and Newton's method would
        # go to the farthest point: so a part of the slope bounds it from below.
        curvature = slope - (px - x) * ddx - (py - z) * ddz
        change = ((px - x) * dx + (py - z) * dz) / max(curvature, 0.2 * slope)
        t += change
        length = parameters[1 + NUMBERS_PER_PIECE * piece]
        # A point beyond an end of its piece goes on in the neighbor, or stays at a free end.
        if t < 0.0:
            if piece == 0 and not closed:
                t = 0.0
            else:
                piece = piece - 1 if piece > 0 else n - 1
                t = max(t + parameters[1 + NUMBERS_PER_PIECE * piece], 0.0)
        elif t > length:
            if piece == n - 1 and not closed:
                t = length
            else:
                piece = piece + 1 if piece < n - 1 else 0
                t = min(t - length, parameters[1 + NUMBERS_PER_PIECE * piece])
        if abs(change) <= POINT_PRECISION * length:
            break
    return piece, t


CYLINDER, PROFILE = Cylinder.number, Profile.number
_at: Callable[..., Surface] = dispatcher(
    "surface_at",
    "parameters, axis, across, y",
    [kind.at for kind in SHAPE_KINDS],
    otherwise="0.0, axis, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 0.0",
)


@compiled
def surface_at(number: int, parameters: Array, axis: Vector, across: Vector, y: Vector) -> Surface:
    """The shape of a number at y."""
    return _at(number, parameters, axis, across, y)


@compiled
def curve(K: Curvature, m: Vector) -> Vector:
    """K m"""
    return (
        K[0] * m[0] + K[5] * m[1] + K[4] * m[2],
        K[5] * m[0] + K[1] * m[1] + K[3] * m[2],
        K[4] * m[0] + K[3] * m[1] + K[2] * m[2],
    )
