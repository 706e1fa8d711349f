"""Shapes that a ball touches, an open set: the distance of a point from a surface.

At a point y, in the axes of the frame that carries the shape, a shape gives

    s           signed distance, positive outside
    n           its gradient, the unit normal
    K           its second derivatives (xx, yy, zz, yz, xz, xy), which are the curvatures
    beyond      how far y is past an end of the shape, 0 where there are none

`axis` (3,): normal of a plane, axis of a cylinder; `across` (3,): a unit vector perpendicular to
it, the normal where the distance has none of its own. A shape is a class with `@shape`.
"""

import math
from collections.abc import Callable
from typing import Any, TypeVar

from ..arrays import Array
from ..compiler.dispatch import dispatcher
from ..compiler.marks import compiled
from .vectors import Vector, dot, scale, subtract

Curvature = tuple[float, float, float, float, float, float]
Surface = tuple[float, Vector, Curvature, float]
"""distance, normal, curvature and how far beyond the ends"""

FLAT = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
SHAPES: list[Any] = []
"""shapes by number"""
AnyShape = TypeVar("AnyShape", bound=type)


def shape(kind: AnyShape) -> AnyShape:
    """Register a shape: a class with a compiled function `at`."""
    registered: Any = kind
    registered.number = len(SHAPES)
    compiled(registered.at)
    SHAPES.append(registered)
    return kind


@compiled
def _round(R: float, p: Vector, axis: Vector, across: Vector) -> tuple[float, Vector, Curvature]:
    """|p| - R about an axis, or about a point where that is zero."""
    length = math.sqrt(dot(p, p))
    if length == 0.0:
        return -R, across, FLAT
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
        return dot(axis, y), axis, FLAT, 0.0


@shape
class Sphere:
    """s = |y| - R; parameters: R."""

    number: int

    @staticmethod
    def at(parameters: Array, axis: Vector, across: Vector, y: Vector) -> Surface:
        s, n, K = _round(parameters[0], y, (0.0, 0.0, 0.0), across)
        return s, n, K, 0.0


@shape
class Cylinder:
    """s = |y - (axis . y) axis| - R; parameters: R and half the length."""

    number: int

    @staticmethod
    def at(parameters: Array, axis: Vector, across: Vector, y: Vector) -> Surface:
        along = dot(axis, y)
        s, n, K = _round(parameters[0], subtract(y, scale(along, axis)), axis, across)
        return s, n, K, max(abs(along) - parameters[1], 0.0)


_at: Callable[..., Surface] = dispatcher(
    "surface_at",
    "parameters, axis, across, y",
    [kind.at for kind in SHAPES],
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
