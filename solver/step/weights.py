"""Weights of the points of facets in rows, also where the rim of a target cuts facets.

Dual functions psi of the corners make uniform pressures exact. A point whose cell is cut counts by
the part c of it that is left, with the functions and the gap of the middle (a, b) of this part.
With linear functions L of the corners, on facets that are cut

    M = sum c w L L^T,   D = diag(sum c w L),   s = sum c w / sum w
    M_e = (1 - e) M + e D,   psi = D M_e^-1 L,   e = (1 - s) / (3 - 2 s) + 2/3 (1 - s)^8

The sum of psi is 1 for every e, for M 1 = D 1. Where a rim parallel to an edge leaves the part s of
a facet over which the gap is linear, the first term gives the corners beyond the rim the gap at the
rim: with e = 0 it would be that at the corner, where nothing is. The second one makes psi L, which
has no large values, where next to nothing is left. Both are 0 where nothing is cut, so that facets
slide over the rim without jumps.

The gap y_i of a row also changes with its weights: at a rim on a sloping surface the points that
are left are nearer, or farther. This belongs to the gradient of y_i, and turns the force of an edge
from the normal of its own surface to that of the surface on which it slides. With G = sum c w L g
of the gaps g of a facet and D h = D M_e^-1 G

    dy_i = sum_f (d(D h)_i - y_i dD_i) / A_i,   d(D h) = dD h + D M_e^-1 (dG - dM_e h)

by c, a and b of each point (`cut_at_rim`). Source of the duals: S. Hartmann, S. Brunssen, E. Ramm,
B. Wohlmuth: Unilateral non-linear dynamic contact of thin-walled structures using a primal-dual
active set strategy (2007); T. Cichosz, M. Bischoff: Consistent treatment of boundaries with mortar
contact formulations using dual Lagrange multipliers (2011).
"""

from ..compiler.marks import compiled
from .records.surfaces import Surfaces, SurfaceWork

BY_COVER, ALONG_A, ALONG_B = 0, 1, 2
"""numbers of what a cut changes: the part of a cell, and the coordinates of its middle"""
OF_SUM, OF_AREA = 0, 1
"""places of derivatives of D h and of D by these"""
LUMPED_SLIVER = 2.0 / 3.0
"""second term of e where nothing is left"""


@compiled
def weigh_whole(surfaces: Surfaces, p: int, f: int, work: SurfaceWork) -> None:
    """w psi at the points of facet f of patch p, all of which is covered."""
    facets, patches = surfaces.facets, surfaces.patches
    per, start = facets.points[p], patches.point[p]
    first = (f - facets.range[p]) * per
    for q in range(first, first + per):
        for z in range(facets.corners[p]):
            work.weight[q, z] = patches.weight[start + q] * patches.dual[start + q, z]


@compiled
def weigh_cut(surfaces: Surfaces, p: int, f: int, covered: float, work: SurfaceWork) -> None:
    """c w psi at the points of facet f of patch p, of which a part is covered, and derivatives."""
    facets, patches = surfaces.facets, surfaces.patches
    per, start, n = facets.points[p], patches.point[p], facets.corners[p]
    first = (f - facets.range[p]) * per
    e, _ = _lumped_part(covered)
    _invert(surfaces, p, first, e, work)
    for z in range(n):
        work.summed[z] = 0.0
    for q in range(first, first + per):
        for z in range(n):
            # M_e^-1 D is the transpose of D M_e^-1, for both are symmetric.
            psi = 0.0
            for y in range(n):
                psi += work.M[y, 4 + z] * work.point_L[q, y]
            work.weight[q, z] = work.cover[q] * patches.weight[start + q] * psi
            work.summed[z] += work.weight[q, z] * work.gap[q]
    _derive(surfaces, p, first, covered, work)


@compiled
def _lumped_part(s: float) -> tuple[float, float]:
    """e, and its derivative by the part s of a facet that is left."""
    width, sliver = 3.0 - 2.0 * s, LUMPED_SLIVER * (1.0 - s) ** 7
    return (1.0 - s) * (1.0 / width + sliver), -1.0 / (width * width) - 8.0 * sliver


@compiled
def _invert(surfaces: Surfaces, p: int, first: int, e: float, work: SurfaceWork) -> None:
    """M_e^-1 D of a facet, in the right half of `M`, and D and G in `sums`."""
    patches, n, M = surfaces.patches, surfaces.facets.corners[p], work.M
    M[:] = 0.0
    work.sums[:] = 0.0
    for q in range(first, first + surfaces.facets.points[p]):
        w = work.cover[q] * patches.weight[patches.point[p] + q]
        for y in range(n):
            L = w * work.point_L[q, y]
            work.sums[0, y] += L
            work.sums[1, y] += L * work.gap[q]
            for z in range(n):
                M[y, z] += (1.0 - e) * L * work.point_L[q, z]
    for z in range(n):
        M[z, z] += e * work.sums[0, z]
        M[z, 4 + z] = work.sums[0, z]
    for z in range(n):  # Gauss-Jordan: the matrix is positive definite
        pivot = 1.0 / M[z, z]
        for x in range(8):
            M[z, x] *= pivot
        for y in range(n):
            if y != z:
                factor = M[y, z]
                for x in range(8):
                    M[y, x] -= factor * M[z, x]


@compiled
def _derive(surfaces: Surfaces, p: int, first: int, covered: float, work: SurfaceWork) -> None:
    """Derivatives of D h and D of the corners of a facet by each of its cells that are cut."""
    patches, n = surfaces.patches, surfaces.facets.corners[p]
    e, e_s = _lumped_part(covered)
    area = 0.0
    for q in range(first, first + surfaces.facets.points[p]):
        area += patches.weight[patches.point[p] + q]
    for q in range(first, first + surfaces.facets.points[p]):
        # What is wholly covered or beyond the rim does not change as the facet moves a little.
        if not 0.0 < work.cover[q] < 1.0:
            continue
        w, c, g = patches.weight[patches.point[p] + q], work.cover[q], work.gap[q]
        work.by_rim[q] = 0.0
        at = 0.0
        for z in range(n):
            at += work.point_L[q, z] * work.summed[z] / work.sums[0, z]
        for y in range(n):
            h, L = work.summed[y] / work.sums[0, y], work.point_L[q, y]
            change = w * L * (g - (1.0 - e) * at - e * h)
            # e changes as well; D h - M h = (D h - G) / (1 - e).
            change -= e_s / (1.0 - e) * w / area * (work.summed[y] - work.sums[1, y])
            _add_change(n, q, BY_COVER, y, change, w * L * h, w * L, work)
        for k in range(2):
            along = 0.0
            for z in range(n):
                along += work.slope_L[q, k, z] * work.summed[z] / work.sums[0, z]
            for y in range(n):
                h = work.summed[y] / work.sums[0, y]
                L, dL = work.point_L[q, y], work.slope_L[q, k, y]
                change = dL * (g - (1.0 - e) * at - e * h)
                change += L * (work.slope_gap[q, k] - (1.0 - e) * along)
                _add_change(n, q, ALONG_A + k, y, c * w * change, c * w * dL * h, c * w * dL, work)


@compiled
def _add_change(
    n: int,
    q: int,
    k: int,
    y: int,
    change: float,
    by_D: float,
    dD: float,
    work: SurfaceWork,
) -> None:
    """Add D M_e^-1 of a change of component y of dG - dM_e h, and what dD itself changes."""
    for z in range(n):
        work.by_rim[q, z, k, OF_SUM] += work.M[y, 4 + z] * change
    work.by_rim[q, y, k, OF_SUM] += by_D
    work.by_rim[q, y, k, OF_AREA] += dD
