"""Rows of contacts of surfaces: means of the gaps of their points, with gradients, and slips.

The points are weighed by weights.py, and face the planes that planes.py has laid.
"""

import math

from ..compiler.marks import compiled
from .records.surfaces import Surfaces
from .system import State, Workspace
from .vectors import ZERO_VECTOR, Vector, add, cross, dot, row, scale, subtract
from .weights import OF_AREA, OF_SUM

COVERED_PART = 3e-3
"""part of the area of a row below which it does not act"""
MAX_COMPONENT = 0.9
"""component of a normal above which tangents are not taken from this axis"""


@compiled
def set_row_gaps(surfaces: Surfaces, c: int, state: State, work: Workspace) -> None:
    """Weighted gaps of the rows of contact c; not a number where they do not act."""
    contacts, facets, patches = surfaces.contacts, surfaces.facets, surfaces.patches
    out, gaps, p = work.surfaces, state.surfaces.gap, contacts.patch[c]
    shift = contacts.row[c] - patches.row[p]
    per = facets.points[p]
    for i in range(contacts.row[c], contacts.row[c + 1]):
        gaps[i], out.area[i] = 0.0, 0.0
    for f in range(facets.range[p], facets.range[p + 1]):
        first = (f - facets.range[p]) * per
        for z in range(facets.corners[p]):
            i = facets.rows[f, z] + shift
            # Sums with it remain no number: one far facet leaves the gap of a row unknown.
            if out.is_far[f]:
                gaps[i] = math.nan
            for q in range(first, first + per):
                if out.weight[q, z] != 0.0:
                    gaps[i] += out.weight[q, z] * out.gap[q]
                    out.area[i] += out.weight[q, z]
    for i in range(contacts.row[c], contacts.row[c + 1]):
        # Next to no area would be divided by.
        if out.area[i] < COVERED_PART * patches.area[i - shift]:
            gaps[i] = math.nan
        else:
            gaps[i] /= out.area[i]
        out.mean_gap[i] = gaps[i]


@compiled
def face_target(surfaces: Surfaces, c: int, i: int, work: Workspace) -> None:
    """The gradient of row i of contact c by the nodes around it and below it, and its offset."""
    _spread(surfaces, c, i, 0, (0.0, 0.0, 0.0), work)


@compiled
def face_slips(surfaces: Surfaces, c: int, i: int, work: Workspace) -> None:
    """The gradients of the slips along two tangents at row i, and their offsets.

    A slip is the way of the points around the row, in the axes of the target and since the start
    of the step, less that of the points that they face now.
    """
    contacts, patches, out = surfaces.contacts, surfaces.patches, work.surfaces
    p, t = contacts.patch[c], contacts.target[c]
    local = i - contacts.row[c] + patches.row[p]
    first = support_of(surfaces, c, i, 0)
    n_supports = patches.support_range[local + 1] - patches.support_range[local]
    n = (0.0, 0.0, 0.0)
    for j in range(first, first + n_supports):
        n = add(n, row(out.facing, j))
    n = scale(1.0 / math.sqrt(dot(n, n)), n)
    # Coulomb's law knows no direction: any pair of tangents serves, and none is carried on.
    e = (1.0, 0.0, 0.0) if abs(n[0]) < MAX_COMPONENT else (0.0, 1.0, 0.0)
    first_tangent = subtract(e, scale(dot(e, n), n))
    size = math.sqrt(dot(first_tangent, first_tangent))
    first_tangent = scale(1.0 / size, first_tangent)
    for kind in range(1, 3):
        tangent = first_tangent if kind == 1 else cross(n, first_tangent)
        _spread(surfaces, c, i, kind, tangent, work)
        k = slip_row(surfaces, c, i, kind)
        first, offset = support_of(surfaces, c, i, kind), 0.0
        begin = contacts.start[c] - patches.node[p]
        for j in range(n_supports):
            node = patches.support[patches.support_range[local] + j]
            offset -= dot(row(out.facing, first + j), row(out.start, begin + node))
        if t >= 0:
            begin = contacts.start[c] + patches.node[p + 1] - patches.node[p] - patches.node[t]
            for j in range(contacts.other[k], contacts.other[k] + out.other_count[k]):
                there = row(out.start, begin + out.other[j])
                offset -= dot(row(out.other_gradient, j), there)
        out.offset[k] = offset


@compiled
def slip_row(surfaces: Surfaces, c: int, i: int, kind: int) -> int:
    """The number of the row of the slip along tangent 1 or 2 at row i of contact c; 0: i."""
    contacts = surfaces.contacts
    if kind == 0:
        return i
    n = contacts.row[c + 1] - contacts.row[c]
    return int(contacts.slip_row[c] + (kind - 1) * n + i - contacts.row[c])


@compiled
def support_of(surfaces: Surfaces, c: int, i: int, kind: int) -> int:
    """The place of the first node around row i of contact c, or of its slips, in `gradient`."""
    contacts, patches, p = surfaces.contacts, surfaces.patches, surfaces.contacts.patch[c]
    before = patches.support_range[patches.row[p]]
    n = patches.support_range[patches.row[p + 1]] - before
    local = i - contacts.row[c] + patches.row[p]
    return int(contacts.support[c] + kind * n + patches.support_range[local] - before)


@compiled
def _spread(
    surfaces: Surfaces, c: int, i: int, kind: int, tangent: Vector, work: Workspace
) -> None:
    """The gradient and the offset of the gap at row i, or of its slip along a tangent."""
    contacts, facets, patches = surfaces.contacts, surfaces.facets, surfaces.patches
    out, p, t = work.surfaces, contacts.patch[c], contacts.target[c]
    local = i - contacts.row[c] + patches.row[p]
    first, k = support_of(surfaces, c, i, kind), slip_row(surfaces, c, i, kind)
    n_supports = patches.support_range[local + 1] - patches.support_range[local]
    for j in range(first, first + n_supports):
        for x in range(3):
            out.facing[j, x] = 0.0
    offset, per = 0.0, facets.points[p]
    out.other_count[k] = 0
    for w in range(patches.around_range[local], patches.around_range[local + 1]):
        f, corner = patches.around[w, 0], patches.around[w, 1]
        start = (f - facets.range[p]) * per
        for q in range(start, start + per):
            weight = out.weight[q, corner] / out.area[i]
            if weight == 0.0:
                continue
            n = scale(weight, row(out.plane, q) if kind == 0 else tangent)
            offset += weight * out.plane[q, 3]
            # Slips have no such part: friction does its work by the points that are in contact.
            if kind == 0 and t >= 0 and 0.0 < out.cover[q] < 1.0:
                turn = _by_cut(i, q, corner, work)
                n = add(n, turn)
                offset -= dot(turn, row(out.apart, q))
            for z in range(facets.n_nodes[p]):
                j = first + patches.slot[w, z]
                N = out.point_N[q, z]
                for x in range(3):
                    out.facing[j, x] += N * n[x]
            if t >= 0:
                _push_back(surfaces, c, k, q, n, work)
    out.offset[k] = offset
    # All rows share `listed`: it is left as it was found.
    for j in range(contacts.other[k], contacts.other[k] + out.other_count[k]):
        out.listed[out.other[j]] = -1


@compiled
def _by_cut(i: int, q: int, corner: int, work: Workspace) -> Vector:
    """How the gap of row i changes with the weights of point q by its motion over the rim."""
    out, turn = work.surfaces, ZERO_VECTOR
    y, A, by = out.mean_gap[i], out.area[i], out.by_rim[q, corner]
    for k in range(3):
        slope = (by[k, OF_SUM] - y * by[k, OF_AREA]) / A
        turn = add(turn, scale(slope, row(out.by_motion[q], k)))
    return turn


@compiled
def _push_back(surfaces: Surfaces, c: int, i: int, q: int, n: Vector, work: Workspace) -> None:
    """The nodes below point q join those of row i with -N n."""
    facets, out, t = surfaces.facets, work.surfaces, surfaces.contacts.target[c]
    start = surfaces.contacts.other[i]
    for m in range(facets.n_nodes[t]):
        k = facets.nodes[out.foot[q], m]
        # A node below several points of a row is listed once.
        if out.listed[k] < 0:
            out.listed[k] = start + out.other_count[i]
            out.other_count[i] += 1
            out.other[out.listed[k]] = k
            for x in range(3):
                out.other_gradient[out.listed[k], x] = 0.0
        for x in range(3):
            out.other_gradient[out.listed[k], x] -= out.foot_N[q, m] * n[x]
