"""Whether the elements of a mesh hang together as one body."""

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from .errors import MeshError
from .mesh import Mesh


def check_used(mesh: Mesh) -> None:
    """Every point must be a node of an element, or it has no mass."""
    unused = np.ones(len(mesh.points), dtype=bool)
    unused[mesh.elements] = False
    if unused.any():
        point = int(np.flatnonzero(unused)[0])
        raise MeshError(
            f"{mesh.name}: {unused.sum()} nodes without mass: they belong to no {mesh.body_type} element, "
            f"first point {point} at {mesh.points[point].tolist()}"
        )


def check_connected(mesh: Mesh) -> None:
    """All elements must be in one piece."""
    n_elements, n_nodes = mesh.elements.shape
    of_element = np.repeat(np.arange(n_elements), n_nodes)
    incidence = sp.coo_array(
        (np.ones(mesh.elements.size), (of_element, mesh.elements.ravel())), shape=(n_elements, len(mesh.points))
    ).tocsr()
    pieces, label = connected_components(incidence @ incidence.T, directed=False)
    if pieces > 1:
        sizes = np.bincount(label)
        places = [mesh.points[mesh.elements[np.flatnonzero(label == i)[0], 0]].tolist() for i in range(min(pieces, 4))]
        raise MeshError(
            f"{mesh.name}: expected one connected body, found {pieces} pieces of {_listing(sizes.tolist())} elements; "
            f"they hold the points {_listing(places)}"
        )


def _listing(items: list[object]) -> str:
    return ", ".join(str(item) for item in items[:4]) + (", ..." if len(items) > 4 else "")
