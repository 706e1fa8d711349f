"""What surfaces face: tangent planes of targets, and rows that average the gaps of their points.

At the points of a facet the gap is measured along the normal of the target; rows weigh it with dual
functions psi = D M^-1 L of the corners, so that uniform pressures are exact. On facets that their
target covers in part, psi is made anew over the covered points: M = sum w L L^T, D = diag(sum w L).
Source: S. Hartmann, S. Brunssen, E. Ramm, B. Wohlmuth: Unilateral non-linear dynamic contact of
thin-walled structures using a primal-dual active set strategy (2007); T. Cichosz, M. Bischoff:
Consistent treatment of boundaries with mortar contact formulations using dual Lagrange multipliers
(2011).
"""

import math

from ..compiler.marks import compiled
from .facets import normal_of_facet, point_of_facet, seek_facet, shape_target, walk_to_foot
from .records.surfaces import Surfaces
from .surface_shapes import distance_from_shape, find_far_facets
from .system import State, System, Workspace
from .vectors import Vector, add, cross, dot, rotate, rotate_back, row, scale, subtract

COVERED_PART = 1e-2
"""part of the area of a row below which it does not act"""
MAX_CONDITION = 1e3
"""condition of M, scaled by its diagonal, above which psi is L"""
MAX_COMPONENT = 0.9
"""component of a normal above which tangents are not taken from this axis"""
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
    else:
        find_far_facets(surfaces, c, margin, work)
    per, n_nodes = facets.points[p], facets.n_nodes[p]
    for f in range(facets.range[p], facets.range[p + 1]):
        below, first = 0, (f - facets.range[p]) * per
        if t >= 0:
            center, radius = _sphere(surfaces, p, f, work)
            below, distance = _seek(surfaces, c, f, center, radius, work)
            out.is_far[f] = int(distance > margin + FACETS_AROUND * radius)
        # What is not covered must not keep the weights of another contact.
        for q in range(first, first + per):
            for z in range(4):
                out.weight[q, z] = 0.0
        if out.is_far[f]:
            continue
        covered = 0
        for q in range(first, first + per):
            y = (0.0, 0.0, 0.0)
            for z in range(n_nodes):
                N = patches.N[patches.point[p] + q, z]
                y = add(y, scale(N, row(out.place, facets.nodes[f, z])))
            covered += int(_look(surfaces, c, q, y, below, work))
        _weigh(surfaces, p, f, first, covered, work)


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
    surfaces: Surfaces, c: int, f: int, center: Vector, radius: float, work: Workspace
) -> tuple[int, float]:
    """The facet of the target below the center of facet f, -1: none; and a bound of its distance.

    radius: of a sphere around facet f.
    """
    facets, out, t = surfaces.facets, work.surfaces, surfaces.contacts.target[c]
    # Facets that begin beyond the end of another one cannot be nearest to a point of facet f.
    least, farthest = math.inf, math.inf
    for m in range(facets.range[t], facets.range[t + 1]):
        apart = subtract(center, row(out.facet_center, m))
        length = math.sqrt(dot(apart, apart))
        farthest = min(farthest, length + out.facet_radius[m])
        least = min(least, length - out.facet_radius[m])
    n_near = 0
    for m in range(facets.range[t], facets.range[t + 1]):
        apart = subtract(center, row(out.facet_center, m))
        if math.sqrt(dot(apart, apart)) - out.facet_radius[m] <= farthest + radius:
            out.near_facet[n_near] = m
            n_near += 1
    p = surfaces.contacts.patch[c]
    corners = facets.nodes[f]
    last = facets.corners[p] - 1
    # The normal of facet f itself, which the facets below it face.
    a = subtract(row(out.place, corners[1]), row(out.place, corners[0]))
    b = subtract(row(out.place, corners[last]), row(out.place, corners[0]))
    return seek_facet(facets, t, center, cross(a, b), n_near, out), least


@compiled
def _look(surfaces: Surfaces, c: int, q: int, y: Vector, below: int, work: Workspace) -> bool:
    """The plane below point q of contact c, which is at y; False where nothing is below it.

    below: the facet of the target below the center of its facet.
    """
    out, t = work.surfaces, surfaces.contacts.target[c]
    if t < 0:
        gap, n, beyond = distance_from_shape(surfaces, c, y)
        _lay_plane(q, gap, n, y, work)
        out.foot[q] = -1 if beyond > 0.0 else 0
        return beyond <= 0.0
    facets = surfaces.facets
    if below < 0:
        out.foot[q] = -1
        return False
    f, a, b, covered = walk_to_foot(facets, t, y, below, out)
    n = normal_of_facet(facets, t, f, a, b, out)
    foot, _, _ = point_of_facet(facets, t, f, a, b, out)
    gap = dot(n, subtract(y, foot))
    # Far behind the target a point is on the other side of its body, not in it.
    if not covered or gap < -surfaces.contacts.size[c]:
        out.foot[q] = -1
        return False
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
    return True


@compiled
def _lay_plane(q: int, gap: float, n: Vector, y: Vector, work: Workspace) -> None:
    out = work.surfaces
    for x in range(3):
        out.plane[q, x] = n[x]
    out.plane[q, 3] = gap - dot(n, y)
    out.gap[q] = gap


@compiled
def _weigh(surfaces: Surfaces, p: int, f: int, first: int, covered: int, work: Workspace) -> None:
    """w psi at the points of facet f of patch p, from the first on, of which some are covered."""
    facets, patches, out = surfaces.facets, surfaces.patches, work.surfaces
    per, n = facets.points[p], facets.corners[p]
    start = patches.point[p]
    if covered == 0:
        return
    if covered == per:
        for q in range(first, first + per):
            for z in range(n):
                out.weight[q, z] = patches.weight[start + q] * patches.dual[start + q, z]
        return
    # A few covered points at a corner may leave M singular: psi is then L.
    regular = _invert_mass(surfaces, p, first, work)
    for q in range(first, first + per):
        if out.foot[q] < 0:
            continue
        for z in range(n):
            psi = patches.corner[start + q, z]
            if regular:
                psi = 0.0
                for y in range(n):
                    psi += out.M[z, 4 + y] * patches.corner[start + q, y]
            out.weight[q, z] = patches.weight[start + q] * psi


@compiled
def _invert_mass(surfaces: Surfaces, p: int, first: int, work: Workspace) -> bool:
    """D M^-1 of the covered points of a facet in the right half of `M`; False if M is singular."""
    patches, facets, out = surfaces.patches, surfaces.facets, work.surfaces
    n, start, M = facets.corners[p], patches.point[p], work.surfaces.M
    M[:] = 0.0
    for q in range(first, first + facets.points[p]):
        if out.foot[q] >= 0:
            for y in range(n):
                for z in range(n):
                    L = patches.corner[start + q, y] * patches.corner[start + q, z]
                    M[y, z] += patches.weight[start + q] * L
    norm = 0.0
    for z in range(n):
        M[z, 4 + z] = 1.0
        for y in range(n):
            norm += M[y, z] * M[y, z] / (M[y, y] * M[z, z])
    # Before the elimination, which overwrites the diagonal.
    D0, D1, D2, D3 = M[0, 0], M[1, 1], M[2, 2], M[3, 3]
    scales = D0, D1, D2, D3
    sums = _corner_sums(surfaces, p, first, work)
    for z in range(n):  # Gauss-Jordan, for M is positive definite where it is regular
        if not M[z, z] > 0.0:
            return False
        pivot = 1.0 / M[z, z]
        for x in range(8):
            M[z, x] *= pivot
        for y in range(n):
            if y != z:
                factor = M[y, z]
                for x in range(8):
                    M[y, x] -= factor * M[z, x]
    inverse = 0.0
    for y in range(n):
        for z in range(n):
            inverse += M[y, 4 + z] * M[y, 4 + z] * scales[y] * scales[z]
    for y in range(n):
        for z in range(n):
            M[y, 4 + z] *= sums[y]
    return norm * inverse < MAX_CONDITION * MAX_CONDITION


@compiled
def _corner_sums(
    surfaces: Surfaces, p: int, first: int, work: Workspace
) -> tuple[float, float, float, float]:
    """sum w L of the covered points, of each corner."""
    patches, start = surfaces.patches, surfaces.patches.point[p]
    a = b = c = d = 0.0
    for q in range(first, first + surfaces.facets.points[p]):
        if work.surfaces.foot[q] >= 0:
            w = patches.weight[start + q]
            a += w * patches.corner[start + q, 0]
            b += w * patches.corner[start + q, 1]
            c += w * patches.corner[start + q, 2]
            d += w * patches.corner[start + q, 3]
    return a, b, c, d


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
            for z in range(facets.n_nodes[p]):
                j = first + patches.slot[w, z]
                N = patches.N[patches.point[p] + q, z]
                for x in range(3):
                    out.facing[j, x] += N * n[x]
            if t >= 0:
                _push_back(surfaces, c, k, q, n, work)
    out.offset[k] = offset
    # All rows share `listed`: it is left as it was found.
    for j in range(contacts.other[k], contacts.other[k] + out.other_count[k]):
        out.listed[out.other[j]] = -1


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
