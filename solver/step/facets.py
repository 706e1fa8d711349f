"""Targets of facets: the point of a surface that is nearest to another point, and its normal.

Corner normals are means over the facets around a corner that turn by less than the feature angle.
On smooth targets edges between corners are arcs, so that facets are quadratic: their middle nodes
rise above the chord as those of the undeformed surface do (solver/lower/patches.py), whatever the
waves of the deformed one.
"""

import math

from ..arrays import Array
from ..compiler.marks import compiled
from .records.surfaces import Facets, SurfaceWork
from .vectors import Vector, add, cross, dot, row, scale, subtract

BLOCK_FACETS = 16
"""facets with a box around all of them; mostly they are beside one another in a mesh"""
MAX_ITERATIONS = 20
"""iterations of the projection on a facet, of which some five are needed"""
MAX_WALK = 10
"""facets over which the foot of a point may move from that of the center of its facet"""
NEGLIGIBLE_STEP = 1e-13
"""change of reference coordinates that counts as none"""
ROUGH_STEP = 1e-2
"""likewise, where facets are compared by their distances, whose errors are of its square"""
ON_EDGE = 1e-9
"""distance to an edge, in reference coordinates, that counts as on it"""
INSIDE, RIM = -2, -1
"""in place of a facet: none is behind an edge, for a point is inside or beyond the rim"""
TRIANGLE, QUAD, TRIANGLE6, QUAD8, QUAD9 = 0, 1, 2, 3, 4
"""types of facets by number"""


@compiled
def is_triangle(kind: int) -> bool:
    return kind in (TRIANGLE, TRIANGLE6)


@compiled
def facet_functions(kind: int, x: float, y: float, N: Array, dN: Array) -> int:
    """Shape functions N (9,) and derivatives dN (2, 9) at (x, y); the number of nodes."""
    if is_triangle(kind):
        z = 1.0 - x - y
        if kind == TRIANGLE:
            N[0], N[1], N[2] = z, x, y
            dN[0, 0], dN[0, 1], dN[0, 2] = -1.0, 1.0, 0.0
            dN[1, 0], dN[1, 1], dN[1, 2] = -1.0, 0.0, 1.0
            return 3
        N[0], N[1], N[2] = z * (2.0 * z - 1.0), x * (2.0 * x - 1.0), y * (2.0 * y - 1.0)
        N[3], N[4], N[5] = 4.0 * z * x, 4.0 * x * y, 4.0 * y * z
        dN[0, 0], dN[0, 1], dN[0, 2] = 1.0 - 4.0 * z, 4.0 * x - 1.0, 0.0
        dN[1, 0], dN[1, 1], dN[1, 2] = 1.0 - 4.0 * z, 0.0, 4.0 * y - 1.0
        dN[0, 3], dN[0, 4], dN[0, 5] = 4.0 * (z - x), 4.0 * y, -4.0 * y
        dN[1, 3], dN[1, 4], dN[1, 5] = -4.0 * x, 4.0 * x, 4.0 * (z - y)
        return 6
    if kind == QUAD9:
        for node in range(9):
            a, b = _corner(node)
            N[node] = _along(x, a) * _along(y, b)
            dN[0, node] = _slope_along(x, a) * _along(y, b)
            dN[1, node] = _along(x, a) * _slope_along(y, b)
        return 9
    for node in range(4):
        a, b = _corner(node)
        p, q = 1.0 + a * x, 1.0 + b * y
        if kind == QUAD:
            N[node] = 0.25 * p * q
            dN[0, node], dN[1, node] = 0.25 * a * q, 0.25 * b * p
        else:
            rest = a * x + b * y - 1.0
            N[node] = 0.25 * p * q * rest
            dN[0, node] = 0.25 * a * q * (rest + p)
            dN[1, node] = 0.25 * b * p * (rest + q)
    if kind == QUAD:
        return 4
    for node in range(4, 8):
        a, b = _corner(node)
        if a == 0.0:
            N[node] = 0.5 * (1.0 - x * x) * (1.0 + b * y)
            dN[0, node], dN[1, node] = -x * (1.0 + b * y), 0.5 * b * (1.0 - x * x)
        else:
            N[node] = 0.5 * (1.0 + a * x) * (1.0 - y * y)
            dN[0, node], dN[1, node] = 0.5 * a * (1.0 - y * y), -y * (1.0 + a * x)
    return 8


@compiled
def _corner(node: int) -> tuple[float, float]:
    """Reference coordinates of a node of a quadrilateral: corners, midsides, center."""
    if node == 8:
        return 0.0, 0.0
    if node >= 4:
        if node == 4:
            return 0.0, -1.0
        if node == 5:
            return 1.0, 0.0
        return (0.0, 1.0) if node == 6 else (-1.0, 0.0)
    a = 1.0 if node in (1, 2) else -1.0
    return a, 1.0 if node >= 2 else -1.0


@compiled
def _along(t: float, a: float) -> float:
    return 1.0 - t * t if a == 0.0 else 0.5 * t * (t + a)


@compiled
def _slope_along(t: float, a: float) -> float:
    return -2.0 * t if a == 0.0 else t + 0.5 * a


@compiled
def shape_target(facets: Facets, p: int, place: Array, work: SurfaceWork) -> None:
    """Nodes, middle nodes and corner normals of the facets of patch p, whose nodes are at place."""
    n_corners = facets.corners[p]
    for f in range(facets.range[p], facets.range[p + 1]):
        last = n_corners - 1
        first = row(place, facets.nodes[f, 0])
        # The diagonals of a quadrilateral, which need not be flat, or two sides of a triangle.
        a = subtract(row(place, facets.nodes[f, 2]), first)
        b = subtract(row(place, facets.nodes[f, last]), row(place, facets.nodes[f, 1]))
        if n_corners == 3:
            b = a
            a = subtract(row(place, facets.nodes[f, 1]), first)
        normal = cross(a, b)
        for x in range(3):
            work.facet_normal[f, x] = normal[x]
    for f in range(facets.range[p], facets.range[p + 1]):
        for i in range(n_corners):
            # Normals are as long as twice their areas: larger facets count more.
            mean = (0.0, 0.0, 0.0)
            for t in range(facets.around_range[4 * f + i], facets.around_range[4 * f + i + 1]):
                mean = add(mean, row(work.facet_normal, facets.around[t]))
            mean = scale(1.0 / math.sqrt(dot(mean, mean)), mean)
            for x in range(3):
                work.corner_normal[f, i, x] = mean[x]
        _shape_facet(facets, p, f, place, work)
    for start in range(facets.range[p], facets.range[p + 1], BLOCK_FACETS):
        for x in range(3):
            low, high = math.inf, -math.inf
            for f in range(start, min(start + BLOCK_FACETS, facets.range[p + 1])):
                low = min(low, work.facet_low[f, x])
                high = max(high, work.facet_high[f, x])
            work.block_low[start, x], work.block_high[start, x] = low, high


@compiled
def _shape_facet(facets: Facets, p: int, f: int, place: Array, work: SurfaceWork) -> None:
    """The nodes of facet f, with middle nodes on arcs where it is smooth, and its box."""
    n_corners, n_nodes = facets.corners[p], facets.n_nodes[p]
    for node in range(n_nodes):
        for c in range(3):
            work.facet_place[f, node, c] = place[facets.nodes[f, node], c]
    if facets.kind[p] != facets.shaped[p]:  # middle nodes that the mesh does not have
        for i in range(n_corners):
            k = (i + 1) % n_corners
            a, b = row(work.facet_place[f], i), row(work.facet_place[f], k)
            n = add(row(work.corner_normal[f], i), row(work.corner_normal[f], k))
            # By the undeformed rise: the arc turns with its edge, but has no waves of the mesh.
            n = scale(facets.rise[f, i] / math.sqrt(dot(n, n)), n)
            middle = add(scale(0.5, add(a, b)), n)
            for c in range(3):
                work.facet_place[f, n_corners + i, c] = middle[c]
        n_nodes = 2 * n_corners
    for x in range(3):
        work.facet_low[f, x] = work.facet_high[f, x] = work.facet_place[f, 0, x]
        for node in range(1, n_nodes):
            place = work.facet_place[f, node, x]
            work.facet_low[f, x] = min(work.facet_low[f, x], place)
            work.facet_high[f, x] = max(work.facet_high[f, x], place)
    _box_along_facet(f, n_nodes, work)


@compiled
def _box_along_facet(f: int, n_nodes: int, work: SurfaceWork) -> None:
    """The axes of facet f, and its nodes along these from the first one."""
    first, n = row(work.facet_place[f], 0), row(work.facet_normal, f)
    a = subtract(row(work.facet_place[f], 1), first)
    b = cross(n, a)
    axes = _unit(a), _unit(b), _unit(cross(a, b))
    for i in range(3):
        work.facet_from[f, i] = work.facet_to[f, i] = 0.0
        for x in range(3):
            work.facet_axes[f, i, x] = axes[i][x]
        for node in range(1, n_nodes):
            along = dot(axes[i], subtract(row(work.facet_place[f], node), first))
            work.facet_from[f, i] = min(work.facet_from[f, i], along)
            work.facet_to[f, i] = max(work.facet_to[f, i], along)


@compiled
def _unit(v: Vector) -> Vector:
    # Across a facet without area its cuboid has no end, and bounds nothing.
    size = math.sqrt(dot(v, v))
    return scale(1.0 / size, v) if size > 0.0 else v


@compiled
def seek_facet(
    facets: Facets, p: int, x: Vector, normal: Vector, limit: float, work: SurfaceWork
) -> tuple[int, float]:
    """The facet of patch p nearest to x of those that face a normal, -1: none does.

    And a bound of the distance of x from the patch, beyond a limit of which any facet will do.
    normal: that of the facet around x, of any length.
    """
    first, last = facets.range[p], facets.range[p + 1]
    nearest, best, bound = -1, math.inf, math.inf
    for start in range(first, last, BLOCK_FACETS):
        square = _square_from_box(work.block_low, work.block_high, start, x)
        if square >= best:
            bound = min(bound, square)
            continue
        for f in range(start, min(start + BLOCK_FACETS, last)):
            square = _square_from_box(work.facet_low, work.facet_high, f, x)
            bound = min(bound, square)
            if square < best and _faces(f, normal, work):
                square = _square_from_cuboid(f, x, work)
                if square < best:
                    nearest, best = f, square
    if nearest < 0 or bound > limit * limit:
        return nearest, math.sqrt(bound)
    # The facet whose cuboid is nearest leaves few whose cuboids are nearer than it is itself.
    begun = nearest
    best = _square_from_facet(facets, p, begun, x, work)
    for start in range(first, last, BLOCK_FACETS):
        if _square_from_box(work.block_low, work.block_high, start, x) >= best:
            continue
        for f in range(start, min(start + BLOCK_FACETS, last)):
            if (
                f != begun
                and _square_from_box(work.facet_low, work.facet_high, f, x) < best
                and _square_from_cuboid(f, x, work) < best
                and _faces(f, normal, work)
            ):
                square = _square_from_facet(facets, p, f, x, work)
                if square < best:
                    best, nearest = square, f
    return nearest, math.sqrt(bound)


@compiled
def _faces(f: int, normal: Vector, work: SurfaceWork) -> bool:
    # A facet whose normal points the same way is on the far side of its body.
    return dot(row(work.facet_normal, f), normal) < 0.0


@compiled
def _square_from_facet(facets: Facets, p: int, f: int, x: Vector, work: SurfaceWork) -> float:
    a, b, _, _ = _project(facets, p, f, x, ROUGH_STEP, work)
    there, _, _ = point_of_facet(facets, p, f, a, b, work)
    apart = subtract(x, there)
    return dot(apart, apart)


@compiled
def _square_from_box(low: Array, high: Array, f: int, x: Vector) -> float:
    """The squared distance of x from box f."""
    total = 0.0
    for i in range(3):
        apart = max(0.0, max(low[f, i] - x[i], x[i] - high[f, i]))
        total += apart * apart
    return total


@compiled
def _square_from_cuboid(f: int, x: Vector, work: SurfaceWork) -> float:
    """The squared distance of x from the cuboid around facet f along its own axes."""
    apart, total = subtract(x, row(work.facet_place[f], 0)), 0.0
    for i in range(3):
        along = dot(row(work.facet_axes[f], i), apart)
        beyond = max(0.0, max(work.facet_from[f, i] - along, along - work.facet_to[f, i]))
        total += beyond * beyond
    return total


@compiled
def walk_to_foot(
    facets: Facets, p: int, x: Vector, f: int, work: SurfaceWork
) -> tuple[int, float, float, float, float]:
    """The facet below x, and the reference coordinates there, within its edges and without regard.

    From facet f on, over edges behind which x lies; on an edge that is seen from both sides it
    ends.
    """
    before = -1
    a = b = to_a = to_b = 0.0
    for _ in range(MAX_WALK):
        a, b, to_a, to_b = _project(facets, p, f, x, NEGLIGIBLE_STEP, work)
        beyond = _facet_beyond(facets, p, f, to_a, to_b)
        # Back over the same edge: from both of its facets the other one seems nearer, at a ridge.
        if beyond < 0 or beyond == before:
            break
        before, f = f, beyond
    return f, a, b, to_a, to_b


@compiled
def excess_of(triangular: bool, a: float, b: float) -> tuple[float, float, float, float]:
    """How far reference coordinates are behind each edge."""
    if triangular:
        return -b, a + b - 1.0, -a, 0.0
    return -1.0 - b, a - 1.0, b - 1.0, -1.0 - a


@compiled
def _facet_beyond(facets: Facets, p: int, f: int, a: float, b: float) -> int:
    """The facet behind the edge of facet f behind which a point is farthest; `INSIDE`, `RIM`.

    At the rim of the surface it may also be behind another edge, which leads on.
    """
    excess = excess_of(is_triangle(facets.kind[p]), a, b)
    beyond, most = INSIDE, ON_EDGE
    for i in range(4):
        if excess[i] > ON_EDGE:
            if facets.beside[f, i] < 0:
                beyond = max(beyond, RIM)
            elif excess[i] > most:
                beyond, most = facets.beside[f, i], excess[i]
    return int(beyond)


@compiled
def _project(
    facets: Facets, p: int, f: int, x: Vector, negligible: float, work: SurfaceWork
) -> tuple[float, float, float, float]:
    """Reference coordinates of the point of facet f nearest to x, and without regard to its edges.

    By Gauss's method with steps that end at the edges, until one is negligible.
    """
    triangular = is_triangle(facets.kind[p])
    a = b = 1.0 / 3.0 if triangular else 0.0
    to_a, to_b = a, b
    for _ in range(MAX_ITERATIONS):
        there, t_a, t_b = point_of_facet(facets, p, f, a, b, work)
        apart = subtract(x, there)
        aa, ab, bb = dot(t_a, t_a), dot(t_a, t_b), dot(t_b, t_b)
        r_a, r_b = dot(apart, t_a), dot(apart, t_b)
        det = aa * bb - ab * ab
        # A facet without area, or a place that is not a number.
        if not det > 0.0:
            return a, b, to_a, to_b
        to_a, to_b = a + (bb * r_a - ab * r_b) / det, b + (aa * r_b - ab * r_a) / det
        new_a, new_b = _clip(triangular, to_a, to_b, aa, ab, bb)
        change = max(abs(new_a - a), abs(new_b - b))
        a, b = new_a, new_b
        if change < negligible:
            break
    return a, b, to_a, to_b


@compiled
def _clip(
    triangular: bool, a: float, b: float, aa: float, ab: float, bb: float
) -> tuple[float, float]:
    """The point of the facet nearest to (a, b) in the metric of its tangents."""
    low, high = (0.0, 1.0) if triangular else (-1.0, 1.0)
    if a >= low and b >= low and (a + b <= 1.0 if triangular else a <= high and b <= high):
        return a, b
    # Outside the nearest point is on an edge: the nearest of those on all edges.
    best, best_a, best_b = math.inf, a, b
    for edge in range(3 if triangular else 4):
        if triangular and edge == 2:
            # along (1 - t, t)
            u, v = a - 1.0, b
            t = (aa * -u + ab * (u - v) + bb * v) / max(aa - 2.0 * ab + bb, 1e-300)
            t = min(max(t, 0.0), 1.0)
            e_a, e_b = 1.0 - t, t
        elif edge % 2 == 0:
            e_b = low if edge == 0 else high
            e_a = min(max(a + ab / aa * (b - e_b), low), high)
        else:
            e_a = low if (edge == 3 or triangular) else high
            e_b = min(max(b + ab / bb * (a - e_a), low), high)
        u, v = a - e_a, b - e_b
        distance = aa * u * u + 2.0 * ab * u * v + bb * v * v
        if distance < best:
            best, best_a, best_b = distance, e_a, e_b
    return best_a, best_b


@compiled
def point_of_facet(
    facets: Facets, p: int, f: int, a: float, b: float, work: SurfaceWork
) -> tuple[Vector, Vector, Vector]:
    """The point of facet f at (a, b), and both tangents."""
    n = facet_functions(facets.shaped[p], a, b, work.N, work.dN)
    x = t_a = t_b = (0.0, 0.0, 0.0)
    for node in range(n):
        place = row(work.facet_place[f], node)
        x = add(x, scale(work.N[node], place))
        t_a = add(t_a, scale(work.dN[0, node], place))
        t_b = add(t_b, scale(work.dN[1, node], place))
    return x, t_a, t_b


@compiled
def normal_of_facet(
    facets: Facets, p: int, f: int, a: float, b: float, work: SurfaceWork
) -> Vector:
    """The normal of facet f at (a, b), between those of its corners."""
    # Not across the tangents, which differ on both sides of an edge: forces would jump there.
    linear = TRIANGLE if is_triangle(facets.kind[p]) else QUAD
    n = facet_functions(linear, a, b, work.N, work.dN)
    normal = (0.0, 0.0, 0.0)
    for node in range(n):
        normal = add(normal, scale(work.N[node], row(work.corner_normal[f], node)))
    return scale(1.0 / math.sqrt(dot(normal, normal)), normal)
