"""Rims of targets: what they leave of the cells of points above them.

A point stands for a cell of its facet. Of one that is cut the part that is left counts, by the gap
in its middle (weights.py).
"""

import math

from ..compiler.marks import compiled
from .facets import ON_EDGE, excess_of, point_of_facet
from .records.surfaces import Facets, SurfaceWork
from .vectors import ZERO_VECTOR, Vector, add, dot, row, scale, subtract

Cut = tuple[float, Vector, Vector]
"""part of a cell that is left, the way from its point to the middle of this part, and the gradient
of the part by the motion of the point"""
ALL_LEFT: Cut = 1.0, ZERO_VECTOR, ZERO_VECTOR
NOTHING_LEFT: Cut = 0.0, ZERO_VECTOR, ZERO_VECTOR
MIDDLE_CELL = 4.0 / 9.0
"""up to where the cell of the middle one of three points of Gauss is: half its weight"""


@compiled
def cut_at_rim(
    facets: Facets,
    p: int,
    f: int,
    at: tuple[float, float, float, float],
    above: tuple[int, int],
    point: tuple[float, float, float],
    work: SurfaceWork,
) -> Cut:
    """What the rim of patch p, along its facet f, leaves of the cell of a point.

    The unit vectors across its edges that cut the cell are in `rim`, and else zero. at: reference
    coordinates below the point (`walk_to_foot`); above: the patch and the facet of the point;
    point: its own reference coordinates, and the root of its part of the area of its facet.
    """
    work.rim[:] = 0.0
    n = facets.corners[p]
    on_rim = False
    for i in range(n):
        on_rim = on_rim or facets.beside[f, i] < 0
    if not on_rim:
        return ALL_LEFT
    a, b, to_a, to_b = at
    _, t_a, t_b = point_of_facet(facets, p, f, a, b, work)
    aa, ab, bb = dot(t_a, t_a), dot(t_a, t_b), dot(t_b, t_b)
    det = aa * bb - ab * ab
    if not det > 0.0:
        return NOTHING_LEFT
    # Gradients of the reference coordinates in the plane of the facet.
    by_a = scale(1.0 / det, subtract(scale(bb, t_a), scale(ab, t_b)))
    by_b = scale(1.0 / det, subtract(scale(aa, t_b), scale(ab, t_a)))
    t_a, t_b = _mean_tangents(facets, above[0], above[1], work)
    reach = math.sqrt(dot(t_a, t_a)) + math.sqrt(dot(t_b, t_b))
    excess = excess_of(n == 3, to_a, to_b)
    part, way, by_part = 1.0, ZERO_VECTOR, ZERO_VECTOR
    for i in range(n):
        if facets.beside[f, i] >= 0:
            continue
        outwards = _gradient_of_excess(n == 3, i, by_a, by_b)
        size_squared = dot(outwards, outwards)
        # Most points are too far from the rim for their cells to reach it.
        if excess[i] + reach * math.sqrt(size_squared) <= 0.0:
            continue
        slopes = dot(outwards, t_a), dot(outwards, t_b)
        low, high = _range_of_cell(facets.corners[above[0]] == 3, point, slopes)
        # Up to the opposite edge, behind which another facet may be.
        low = max(low, -1.0 if n == 3 else -2.0)
        extent = max(high - low, ON_EDGE)
        within = min(max(1.0 - (excess[i] + high) / extent, 0.0), 1.0)
        by_part = scale(within, by_part)
        if 0.0 < within < 1.0:
            by_part = subtract(by_part, scale(part / extent, outwards))
            way = subtract(way, scale(0.5 * (1.0 - within) * extent / size_squared, outwards))
            for x in range(3):
                work.rim[i, x] = outwards[x] / math.sqrt(size_squared)
        part *= within
    return part, way, by_part


@compiled
def _mean_tangents(facets: Facets, p: int, f: int, work: SurfaceWork) -> tuple[Vector, Vector]:
    """Tangents in the middle of a facet that is placed, by its corners."""
    n = facets.corners[p]
    a, b = row(work.place, facets.nodes[f, 0]), row(work.place, facets.nodes[f, 1])
    c = row(work.place, facets.nodes[f, 2])
    if n == 3:
        return subtract(b, a), subtract(c, a)
    d = row(work.place, facets.nodes[f, 3])
    along, across = subtract(c, a), subtract(b, d)
    return scale(0.25, add(along, across)), scale(0.25, subtract(along, across))


@compiled
def _range_of_cell(
    triangular: bool, point: tuple[float, float, float], slopes: tuple[float, float]
) -> tuple[float, float]:
    """The least and largest value that a function has over the cell of a point, from that there on.

    slopes: of the function by the reference coordinates. The cells of quadrilaterals are those to
    which the rule of Gauss gives its weights; those of triangles are triangles around the point.
    """
    a, b, size = point
    if triangular:
        at = slopes[0] * a + slopes[1] * b
        low = min(0.0, min(slopes[0], slopes[1])) - at
        return size * low, size * (max(0.0, max(slopes[0], slopes[1])) - at)
    low_a, high_a = _range_along(a, slopes[0])
    low_b, high_b = _range_along(b, slopes[1])
    return low_a + low_b, high_a + high_b


@compiled
def _range_along(t: float, slope: float) -> tuple[float, float]:
    """The same in one direction, at a point of Gauss from -1 to 1."""
    low, high = -MIDDLE_CELL - t, MIDDLE_CELL - t
    if t > MIDDLE_CELL:
        low, high = high, 1.0 - t
    elif t < -MIDDLE_CELL:
        low, high = -1.0 - t, low
    return min(slope * low, slope * high), max(slope * low, slope * high)


@compiled
def _gradient_of_excess(triangular: bool, i: int, by_a: Vector, by_b: Vector) -> Vector:
    """That of the i-th value of `excess_of`, by the gradients of the reference coordinates."""
    if i == 0:
        return scale(-1.0, by_b)
    if triangular:
        return add(by_a, by_b) if i == 1 else scale(-1.0, by_a)
    if i == 3:
        return scale(-1.0, by_a)
    return by_a if i == 1 else by_b
