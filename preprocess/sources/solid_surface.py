"""The surface of a mesh of solids, as points at which fields are recovered."""

from dataclasses import dataclass

import numpy as np

from ...superelement.cells import padded
from ..mesh.facets import Facets
from ..mesh.mesh import IntArray, Mesh


@dataclass(frozen=True, eq=False)
class SurfacePoints:
    """The boundary of a mesh of solids as points, one for each node and material that bounds there.

    nodes (p,) and owners (p,): the node and the material of each point; cells (n, k): facets as
    points, -1 filling short rows; of_elements: by type of element (n_elements, k), the point that
    each node is, -1 for none.
    """

    nodes: IntArray
    owners: IntArray
    cells: IntArray
    of_elements: dict[str, IntArray]


def surface_points(mesh: Mesh, facets: Facets, owners: IntArray) -> SurfacePoints:
    """The surface of a mesh whose elements (n_elements,) are of the materials `owners`."""
    # Inner facets get whichever element comes last; only outer ones are looked at.
    owner_of_facet = np.empty(facets.count, dtype=np.int64)
    for kind, sides in facets.sides.items():
        owner_of_facet[sides] = mesh.of_kind(owners, kind)[:, None]
    outer = np.flatnonzero(facets.boundary)
    cells = padded(list(facets.patch(outer).values()))

    # A node of a material is one number, node + n_nodes * material, until points are counted.
    n_nodes = len(mesh.points)
    cells = np.where(cells >= 0, cells + n_nodes * owner_of_facet[outer][:, None], -1)
    keys = np.unique(cells[cells >= 0])
    point = np.full(n_nodes * (1 + int(owners.max())), -1)
    point[keys] = np.arange(len(keys))
    of_elements = {
        kind: point[elements + n_nodes * mesh.of_kind(owners, kind)[:, None]]
        for kind, elements in mesh.elements.items()
    }
    cells = np.where(cells >= 0, point[cells], -1)
    return SurfacePoints(keys % n_nodes, keys // n_nodes, cells, of_elements)
