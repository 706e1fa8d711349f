"""One aluminium bar as two meshes: 20-node hexahedra, and lines. Both name their ends root and tip.

The bar runs along x from the origin; its section is WIDTH (y) by HEIGHT (z), centered on the axis.
"""

from pathlib import Path

import meshio
import numpy as np
from numpy.typing import NDArray

LENGTH, WIDTH, HEIGHT = 0.5, 0.02, 0.01
ELEMENTS = (20, 3, 2)
LINES = 20
Edges = list[tuple[int, int]]
EDGES: Edges = [
    (0, 1),
    (1, 2),
    (2, 3),
    (3, 0),
    (4, 5),
    (5, 6),
    (6, 7),
    (7, 4),
    (0, 4),
    (1, 5),
    (2, 6),
    (3, 7),
]
CORNERS = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
)


def solid_mesh() -> meshio.Mesh:
    """A grid of bricks with nodes at their corners and in the middle of their edges."""
    local = np.vstack(
        [2 * CORNERS, [CORNERS[a] + CORNERS[b] for a, b in EDGES]]
    )  # on a grid of half elements
    origins = 2 * np.stack(np.meshgrid(*map(np.arange, ELEMENTS), indexing="ij"), axis=-1).reshape(
        -1, 1, 3
    )
    nodes, cells = np.unique((origins + local).reshape(-1, 3), axis=0, return_inverse=True)
    cells = cells.reshape(-1, 20)
    size = np.array([LENGTH, WIDTH, HEIGHT])
    points = nodes / (2 * np.array(ELEMENTS)) * size - [0.0, WIDTH / 2, HEIGHT / 2]
    root = cells[(nodes[cells[:, 0], 0] == 0)][:, [0, 4, 7, 3, 16, 15, 19, 11]]
    tip = cells[(nodes[cells[:, 1], 0] == 2 * ELEMENTS[0])][:, [1, 2, 6, 5, 9, 18, 13, 17]]
    return _named(
        points, [("root", "quad8", root), ("tip", "quad8", tip), ("bar", "hexahedron20", cells)]
    )


def line_mesh() -> meshio.Mesh:
    x = np.linspace(0.0, LENGTH, LINES + 1)
    points = np.stack([x, 0 * x, 0 * x], axis=1)
    lines = np.stack([np.arange(LINES), np.arange(1, LINES + 1)], axis=1)
    ends = [("root", "vertex", np.array([[0]])), ("tip", "vertex", np.array([[LINES]]))]
    return _named(points, [*ends, ("bar", "line", lines)])


def _named(
    points: NDArray[np.float64], parts: list[tuple[str, str, NDArray[np.int64]]]
) -> meshio.Mesh:
    """A mesh whose parts are the physical groups of Gmsh."""
    cells = [meshio.CellBlock(kind, rows) for _, kind, rows in parts]
    tags = [np.full(len(rows), i + 1) for i, (_, _, rows) in enumerate(parts)]
    names = {name: np.array([i + 1, cells[i].dim]) for i, (name, _, _) in enumerate(parts)}
    return meshio.Mesh(
        points, cells, cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags}, field_data=names
    )


if __name__ == "__main__":
    here = Path(__file__).parent
    for mesh, name in ((solid_mesh(), "solid.msh"), (line_mesh(), "beam.msh")):
        mesh.write(here / name, file_format="gmsh22", binary=False)
