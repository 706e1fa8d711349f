"""The surface of a mesh of solids, as points at which fields are recovered."""

from dataclasses import dataclass

import numpy as np

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
    owner = np.empty(facets.count, dtype=np.int64)
    for kind, sides in facets.sides.items():
        owner[sides] = _of(owners, mesh, kind)[:, None]
    outer = np.flatnonzero(facets.boundary)
    patch = facets.patch(outer).values()
    width = max(nodes.shape[1] for nodes in patch)
    cells = np.vstack(
        [
            np.pad(nodes, ((0, 0), (0, width - nodes.shape[1])), constant_values=-1)
            for nodes in patch
        ]
    )
    # A node of a material is one number, node + n_nodes * material, until points are counted.
    n_nodes = len(mesh.points)
    cells = np.where(cells >= 0, cells + n_nodes * owner[outer][:, None], -1)
    keys = np.unique(cells[cells >= 0])
    point = np.full(n_nodes * (1 + int(owners.max())), -1)
    point[keys] = np.arange(len(keys))
    of_elements = {
        kind: point[cells + n_nodes * _of(owners, mesh, kind)[:, None]]
        for kind, cells in mesh.elements.items()
    }
    return SurfacePoints(
        keys % n_nodes, keys // n_nodes, np.where(cells >= 0, point[cells], -1), of_elements
    )


def _of(per_element: IntArray, mesh: Mesh, kind: str) -> IntArray:
    """The entries of a type of element, of numbers (n_elements,) for all."""
    return per_element[mesh.first[kind] :][: len(mesh.cells[kind])]
