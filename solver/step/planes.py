"""Planes of targets: what is below each point of the facets of a contact, and its gap.

At the points of a facet the gap is measured along the normal of the target. The plane there is kept
for the rest of the step, in which it moves with the target.
"""

import math

from ..compiler.marks import compiled
from .facets import (
    QUAD,
    TRIANGLE,
    facet_functions,
    is_triangle,
    normal_of_facet,
    point_of_facet,
    seek_facet,
    shape_target,
    walk_to_foot,
)
from .far_facets import distance_from_shape, find_far_facets
from .records.surfaces import Facets, Surfaces, SurfaceWork
from .rims import NOTHING_LEFT, Cut, cut_at_rim
from .system import State, System, Workspace
from .vectors import ZERO_VECTOR, Vector, add, cross, dot, rotate, rotate_back, row, scale, subtract
from .weights import ALONG_A, ALONG_B, BY_COVER, weigh_cut, weigh_whole

FACETS_AROUND = 3.0
"""radii of a facet, beyond the margin, within which it is looked at"""


@compiled
def target_axes(
    system: System, c: int, v: Vector, back: bool, state: State, work: Workspace
) -> Vector:
    """A vector in the axes of the target of contact c, in space; back: the other way."""
    f = system.surfaces.contacts.frame[c]
    if f >= 0:
        return rotate_back(work.frames.D, f, v) if back else rotate(work.frames.D, f, v)
    b = system.surfaces.patches.body[system.surfaces.contacts.target[c]]
    return rotate_back(state.bodies.R, b, v) if back else rotate(state.bodies.R, b, v)


@compiled
def target_origin(system: System, c: int, state: State, work: Workspace) -> Vector:
    """The origin of the axes of the target of contact c, in space."""
    f = system.surfaces.contacts.frame[c]
    if f >= 0:
        return row(work.frames.r, f)
    return row(state.bodies.x, system.surfaces.patches.body[system.surfaces.contacts.target[c]])


@compiled
def place_nodes(system: System, c: int, state: State, work: Workspace) -> None:
    """The nodes of contact c in the axes of its target."""
    surfaces, out = system.surfaces, work.surfaces
    patches, p = surfaces.patches, surfaces.contacts.patch[c]
    b = patches.body[p]
    # the difference of positions first, for it is small
    apart = subtract(row(state.bodies.x, b), target_origin(system, c, state, work))
    for k in range(patches.node[p], patches.node[p + 1]):
        lever = rotate(state.bodies.R, b, deformed(surfaces, k, work))
        y = target_axes(system, c, add(apart, lever), True, state, work)
        for x in range(3):
            out.place[k, x] = y[x]
    t = surfaces.contacts.target[c]
    if t >= 0:
        for k in range(patches.node[t], patches.node[t + 1]):
            y = deformed(surfaces, k, work)
            for x in range(3):
                out.place[k, x] = y[x]


@compiled
def deformed(surfaces: Surfaces, k: int, work: Workspace) -> Vector:
    """X + u of node k."""
    u = add(row(work.surfaces.base, k), row(work.surfaces.by_load, k))
    return add(row(surfaces.patches.X, k), u)


@compiled
def look_at_target(system: System, c: int, margin: float, work: Workspace) -> None:
    """Planes and gaps of the points of contact c, whose nodes are placed, and their weights."""
    surfaces, out = system.surfaces, work.surfaces
    contacts, facets, patches = surfaces.contacts, surfaces.facets, surfaces.patches
    p, t = contacts.patch[c], contacts.target[c]
    if t >= 0:
        shape_target(facets, t, out.place, out)
    for f in range(facets.range[p], facets.range[p + 1]):
        out.below[f] = out.is_far[f] = 0
        if t >= 0:
            center, radius = _sphere(surfaces, p, f, work)
            limit = margin + FACETS_AROUND * radius
            out.below[f], distance = _seek(surfaces, c, f, center, limit, work)
            out.is_far[f] = int(distance > limit)
    find_far_facets(surfaces, c, margin, work)
    per = facets.points[p]
    for f in range(facets.range[p], facets.range[p + 1]):
        first = (f - facets.range[p]) * per
        # What is not covered must not keep the weights of another contact.
        for q in range(first, first + per):
            for z in range(4):
                out.weight[q, z] = 0.0
        if out.is_far[f]:
            continue
        area, covered, whole = 0.0, 0.0, True
        for q in range(first, first + per):
            area += patches.weight[patches.point[p] + q]
        for q in range(first, first + per):
            w = patches.weight[patches.point[p] + q]
            out.cover[q] = _look(surfaces, c, q, (f, out.below[f]), math.sqrt(w / area), work)
            covered += out.cover[q] * w / area
            whole = whole and out.cover[q] == 1.0
        if whole:
            weigh_whole(surfaces, p, f, out)
        elif covered > 0.0:
            weigh_cut(surfaces, p, f, covered, out)


@compiled
def _sphere(surfaces: Surfaces, p: int, f: int, work: Workspace) -> tuple[Vector, float]:
    """A sphere around facet f of patch p."""
    facets, place = surfaces.facets, work.surfaces.place
    center, radius = (0.0, 0.0, 0.0), 0.0
    for z in range(facets.corners[p]):
        center = add(center, scale(1.0 / facets.corners[p], row(place, facets.nodes[f, z])))
    for z in range(facets.n_nodes[p]):
        apart = subtract(row(place, facets.nodes[f, z]), center)
        radius = max(radius, math.sqrt(dot(apart, apart)))
    return center, radius


@compiled
def _seek(
    surfaces: Surfaces, c: int, f: int, center: Vector, limit: float, work: Workspace
) -> tuple[int, float]:
    """The facet of the target below the center of facet f, -1: none; a bound of its distance.

    limit: that beyond which any facet will do.
    """
    facets, out, p = surfaces.facets, work.surfaces, surfaces.contacts.patch[c]
    corners, last = facets.nodes[f], facets.corners[p] - 1
    # The normal of facet f itself, which the facets below it face.
    a = subtract(row(out.place, corners[1]), row(out.place, corners[0]))
    b = subtract(row(out.place, corners[last]), row(out.place, corners[0]))
    return seek_facet(facets, surfaces.contacts.target[c], center, cross(a, b), limit, out)


@compiled
def _look(
    surfaces: Surfaces, c: int, q: int, facet: tuple[int, int], size: float, work: Workspace
) -> float:
    """The plane below point q of contact c, and the part of its cell that is covered.

    facet: that of the point, and that of the target below the center of it; size: of the cell, over
    that of its facet.
    """
    patches, facets, out = surfaces.patches, surfaces.facets, work.surfaces
    p, f = surfaces.contacts.patch[c], facet[0]
    at, y = patches.point[p] + q, ZERO_VECTOR
    for z in range(facets.corners[p]):
        out.point_L[q, z] = patches.corner[at, z]
    for z in range(facets.n_nodes[p]):
        out.point_N[q, z] = patches.N[at, z]
        y = add(y, scale(patches.N[at, z], row(out.place, facets.nodes[f, z])))
    L, triangular = patches.corner[at], is_triangle(facets.kind[p])
    a = L[1] if triangular else L[1] + L[2] - L[0] - L[3]
    b = L[2] if triangular else L[2] + L[3] - L[0] - L[1]
    point = a, b, size
    part, way, by_part = _lay(surfaces, c, q, y, facet, point, work)
    if 0.0 < part < 1.0 and surfaces.contacts.target[c] >= 0:
        # What is covered has the gap of its middle: that of the point may be beyond the rim.
        for x in range(3):
            out.by_motion[q, BY_COVER, x] = by_part[x]
        y = _move_point(surfaces, (p, f), q, (a, b), way, work)
        _lay(surfaces, c, q, y, facet, point, work)
        for k in range(2):
            out.slope_gap[q, k] = dot(row(out.plane, q), row(out.tangent, k))
        for x in range(3):
            out.apart[q, x] = y[x]
        for m in range(facets.n_nodes[surfaces.contacts.target[c]]):
            below = row(out.facet_place[out.foot[q]], m)
            for x in range(3):
                out.apart[q, x] -= out.foot_N[q, m] * below[x]
    return part


@compiled
def _move_point(
    surfaces: Surfaces,
    facet: tuple[int, int],
    q: int,
    at: tuple[float, float],
    way: Vector,
    work: Workspace,
) -> Vector:
    """Take a point to the middle of what is left of its cell, as far as that is on its facet.

    With the slopes of its place in `tangent`, and the gradients of its reference coordinates.
    facet: the patch and the facet; at: reference coordinates of the point.
    """
    facets, out = surfaces.facets, work.surfaces
    p, f, a, b = facet[0], facet[1], at[0], at[1]
    _, t_a, t_b = _point_at(facets, p, f, a, b, out)
    aa, ab, bb = dot(t_a, t_a), dot(t_a, t_b), dot(t_b, t_b)
    det = aa * bb - ab * ab
    by_a = scale(1.0 / det, subtract(scale(bb, t_a), scale(ab, t_b)))
    by_b = scale(1.0 / det, subtract(scale(aa, t_b), scale(ab, t_a)))
    a, b = a + dot(by_a, way), b + dot(by_b, way)
    for x in range(3):
        out.by_motion[q, ALONG_A, x] = out.by_motion[q, ALONG_B, x] = 0.0
    for i in range(4):
        across = row(out.rim, i)
        # The middle of what is left moves half as fast as the rim, the other way.
        on_a, on_b = -0.5 * dot(by_a, across), -0.5 * dot(by_b, across)
        for x in range(3):
            out.by_motion[q, ALONG_A, x] += on_a * across[x]
            out.by_motion[q, ALONG_B, x] += on_b * across[x]
    n = facet_functions(TRIANGLE if is_triangle(facets.kind[p]) else QUAD, a, b, out.N, out.dN)
    for z in range(n):
        out.point_L[q, z] = out.N[z]
        out.slope_L[q, 0, z], out.slope_L[q, 1, z] = out.dN[0, z], out.dN[1, z]
    y, t_a, t_b = _point_at(facets, p, f, a, b, out)
    for x in range(3):
        out.tangent[0, x], out.tangent[1, x] = t_a[x], t_b[x]
    for z in range(facets.n_nodes[p]):
        out.point_N[q, z] = out.N[z]
    return y


@compiled
def _point_at(
    facets: Facets, p: int, f: int, a: float, b: float, out: SurfaceWork
) -> tuple[Vector, Vector, Vector]:
    """The point of facet f, whose nodes are placed, at (a, b), and both tangents."""
    n = facet_functions(facets.kind[p], a, b, out.N, out.dN)
    y = t_a = t_b = ZERO_VECTOR
    for z in range(n):
        place = row(out.place, facets.nodes[f, z])
        y = add(y, scale(out.N[z], place))
        t_a = add(t_a, scale(out.dN[0, z], place))
        t_b = add(t_b, scale(out.dN[1, z], place))
    return y, t_a, t_b


@compiled
def _lay(
    surfaces: Surfaces,
    c: int,
    q: int,
    y: Vector,
    facet: tuple[int, int],
    point: tuple[float, float, float],
    work: Workspace,
) -> Cut:
    """The plane below point q at y, and what the rim of the target leaves of its cell."""
    out, contacts = work.surfaces, surfaces.contacts
    t = contacts.target[c]
    if t < 0:
        gap, n, beyond = distance_from_shape(surfaces, c, y)
        _lay_plane(q, gap, n, y, work)
        width = math.sqrt(surfaces.patches.weight[surfaces.patches.point[contacts.patch[c]] + q])
        return min(max(0.5 - beyond / width, 0.0), 1.0), ZERO_VECTOR, ZERO_VECTOR
    facets = surfaces.facets
    if facet[1] < 0:
        return NOTHING_LEFT
    f, a, b, to_a, to_b = walk_to_foot(facets, t, y, facet[1], out)
    n = normal_of_facet(facets, t, f, a, b, out)
    foot, _, _ = point_of_facet(facets, t, f, a, b, out)
    gap = dot(n, subtract(y, foot))
    # Far behind the target a point is on the other side of its body, not in it.
    if gap < -contacts.size[c]:
        return NOTHING_LEFT
    out.foot[q] = f
    # Middle nodes that the mesh does not have move with the corners of their edge.
    n_nodes, n_corners = facets.n_nodes[t], facets.corners[t]
    for m in range(n_nodes):
        out.foot_N[q, m] = out.N[m]
    on_nodes = (0.0, 0.0, 0.0)
    if facets.kind[t] != facets.shaped[t]:
        for i in range(n_corners):
            half = 0.5 * out.N[n_corners + i]
            out.foot_N[q, i] += half
            out.foot_N[q, (i + 1) % n_corners] += half
    for m in range(n_nodes):
        on_nodes = add(on_nodes, scale(out.foot_N[q, m], row(out.facet_place[f], m)))
    # The plane is seen from the nodes below: its offset is what the arcs rise above them.
    for x in range(3):
        out.plane[q, x] = n[x]
    out.plane[q, 3] = dot(n, subtract(on_nodes, foot))
    out.gap[q] = gap
    # The cell is on the facet of the point, its rim on that below it.
    above = contacts.patch[c], facet[0]
    return cut_at_rim(facets, t, f, (a, b, to_a, to_b), above, point, out)


@compiled
def _lay_plane(q: int, gap: float, n: Vector, y: Vector, work: Workspace) -> None:
    out = work.surfaces
    for x in range(3):
        out.plane[q, x] = n[x]
    out.plane[q, 3] = gap - dot(n, y)
    out.gap[q] = gap
