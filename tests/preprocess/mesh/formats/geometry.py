"""What must hold of any mesh of straight elements, whoever wrote it: volumes, and nodes in the
middle of others.
"""

import numpy as np
from duhamel.preprocess.mesh.mesh import Mesh

from ...blocks import CUBE_EDGES, CUBE_FACES, TETRA_EDGES

TRIANGLE_EDGES = [(0, 1), (1, 2), (2, 0)]
QUAD_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0)]
BETWEEN = {  # the corners that every node after the corners lies in the middle of
    "line3": [(0, 1)],
    "triangle6": TRIANGLE_EDGES,
    "quad8": QUAD_EDGES,
    "quad9": [*QUAD_EDGES, (0, 1, 2, 3)],
    "tetra10": TETRA_EDGES,
    "hexahedron20": CUBE_EDGES,
    "hexahedron27": [*CUBE_EDGES, *CUBE_FACES, range(8)],
}
PARALLELEPIPED = {
    "tetra": ([1, 2, 3], 6.0),
    "wedge": ([1, 2, 3], 2.0),
    "hexahedron": ([1, 3, 4], 1.0),
}


def volume(mesh: Mesh, group: str | None = None) -> float:
    """Of all elements, or of a group, each cut from a parallelepiped; none may be inverted."""
    total = 0.0
    for kind, cells in mesh.elements.items():
        corners = mesh.points[cells]
        neighbors, parts = PARALLELEPIPED[kind.rstrip("0123456789")]
        edges = corners[:, neighbors] - corners[:, :1]
        volumes = np.linalg.det(edges) / parts
        assert (volumes > 0.0).all(), kind
        total += float(
            volumes.sum() if group is None else volumes[mesh.group(group).cells.get(kind, [])].sum()
        )
    return total


def eccentricity(mesh: Mesh) -> float:
    """The largest distance of a node that is no corner from the middle of the corners that it
    stands between.
    """
    worst = 0.0
    for kind, places in BETWEEN.items():
        if kind in mesh.cells:
            points = mesh.points[mesh.cells[kind]]
            middles = np.stack(
                [points[:, list(corners)].mean(axis=1) for corners in places], axis=1
            )
            worst = max(worst, float(np.abs(points[:, -len(places) :] - middles).max()))
    return worst


def places(mesh: Mesh, group: str) -> list[list[float]]:
    """The points of a group and of its cells, sorted."""
    members = mesh.group(group)
    rows = [mesh.cells[kind][cells].ravel() for kind, cells in members.cells.items()]
    return np.unique(mesh.points[np.concatenate([*rows, members.points])].round(9), axis=0).tolist()
