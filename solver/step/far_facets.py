"""Gaps of points of surfaces, and the facets that are too far from their targets to touch them."""

import math

from ..compiler.marks import compiled
from .facets import normal_of_facet, point_of_facet, walk_to_foot
from .records.surfaces import Surfaces
from .shapes import surface_at
from .system import Workspace
from .vectors import Vector, add, dot, row, scale, subtract

BENDS_OF_GAP = 4.0
"""bends of the gap over a facet that the gap of a row may be below that of its node"""


@compiled
def distance_from_shape(surfaces: Surfaces, c: int, y: Vector) -> tuple[float, Vector, float]:
    """The distance of a point from the shape of contact c, the normal, and how far it is beyond.

    In the axes of the shape.
    """
    contacts = surfaces.contacts
    parameters = contacts.parameters[contacts.first[c] : contacts.first[c + 1]]
    s, n, _, beyond = surface_at(
        contacts.shape[c], parameters, row(contacts.axis, c), row(contacts.across, c), y
    )
    return contacts.side[c] * s, scale(contacts.side[c], n), beyond


@compiled
def _gap_at(surfaces: Surfaces, c: int, y: Vector, below: int, work: Workspace) -> float:
    """The gap of a point from the target of contact c; below: the facet from which it is sought."""
    t = surfaces.contacts.target[c]
    if t < 0:
        gap, _, _ = distance_from_shape(surfaces, c, y)
        return gap
    # Nothing faces the facet of this point: it touches nothing.
    if below < 0:
        return math.inf
    f, a, b, _, _ = walk_to_foot(surfaces.facets, t, y, below, work.surfaces)
    n = normal_of_facet(surfaces.facets, t, f, a, b, work.surfaces)
    foot, _, _ = point_of_facet(surfaces.facets, t, f, a, b, work.surfaces)
    return dot(n, subtract(y, foot))


@compiled
def find_far_facets(surfaces: Surfaces, c: int, margin: float, work: Workspace) -> None:
    """Facets none of whose rows can have a gap below the margin, by the gaps of nodes.

    Dual functions make the gap of a row that of its node where gaps are linear over the facets
    around it; it differs by as much as gaps are bent there. Facets that are far already stay so.
    """
    facets, patches, out = surfaces.facets, surfaces.patches, work.surfaces
    p = surfaces.contacts.patch[c]
    shift = surfaces.contacts.row[c] - patches.row[p]
    for k in range(patches.node[p], patches.node[p + 1]):
        out.node_gap[k] = math.nan
    for i in range(patches.row[p], patches.row[p + 1]):
        out.row_gap[i + shift] = math.inf
    for f in range(facets.range[p], facets.range[p + 1]):
        if out.is_far[f]:
            continue
        for z in range(facets.n_nodes[p]):
            k = facets.nodes[f, z]
            if math.isnan(out.node_gap[k]):
                out.node_gap[k] = _gap_at(surfaces, c, row(out.place, k), out.below[f], work)
        bend = BENDS_OF_GAP * _bend_of_gap(surfaces, c, f, work)
        for z in range(facets.corners[p]):
            i = facets.rows[f, z] + shift
            out.row_gap[i] = min(out.row_gap[i], out.node_gap[facets.nodes[f, z]] - bend)
    # A row needs all facets around it, those of near ones too that are far themselves.
    for f in range(facets.range[p], facets.range[p + 1]):
        if out.is_far[f]:
            continue
        out.is_far[f] = 1
        for z in range(facets.corners[p]):
            i = facets.rows[f, z] + shift
            # Also where it is no number, which must not pass for far.
            if out.closed[i] or not out.row_gap[i] > margin:
                out.is_far[f] = 0


@compiled
def _bend_of_gap(surfaces: Surfaces, c: int, f: int, work: Workspace) -> float:
    """The largest difference, over facet f, of the gap from a linear one between its corners.

    At its center, which a curved target bends, and at its middle nodes, which a curved facet does.
    """
    facets, out = surfaces.facets, work.surfaces
    p = surfaces.contacts.patch[c]
    n, nodes = facets.corners[p], facets.nodes[f]
    center, mean = (0.0, 0.0, 0.0), 0.0
    for z in range(n):
        center = add(center, scale(1.0 / n, row(out.place, nodes[z])))
        mean += out.node_gap[nodes[z]] / n
    gap = _gap_at(surfaces, c, center, out.below[f], work)
    bend = abs(gap - mean)
    for z in range(n, facets.n_nodes[p]):
        between = mean  # of the node in the middle of the facet
        if z < 2 * n:
            first, second = nodes[z - n], nodes[(z - n + 1) % n]
            between = 0.5 * (out.node_gap[first] + out.node_gap[second])
        bend = max(bend, abs(out.node_gap[nodes[z]] - between))
    return bend
