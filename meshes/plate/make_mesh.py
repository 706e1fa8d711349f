"""A square plate of 0.5 m and 10 mm in 27-node hexahedra, its middle plane at z = 0.

    python meshes/plate/make_mesh.py

Groups: rim, the four sides, and plate.
"""

from pathlib import Path

import meshio
import numpy as np

SIZE, THICKNESS, ELEMENTS = 0.5, 0.01, 10
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)]
EDGES += [(0, 4), (1, 5), (2, 6), (3, 7)]
CORNERS = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
)
FACES = [(0, 1, 1), (2, 1, 1), (1, 0, 1), (1, 2, 1), (1, 1, 0), (1, 1, 2), (1, 1, 1)]
LOCAL = np.vstack([2 * CORNERS, [CORNERS[a] + CORNERS[b] for a, b in EDGES], FACES])
"""corners, middles of edges and of faces, and the middle of a brick, on a grid of half elements"""
SIDES = {
    (0, 0): [0, 4, 7, 3, 16, 15, 19, 11, 20],
    (0, 1): [1, 2, 6, 5, 9, 18, 13, 17, 21],
    (1, 0): [0, 1, 5, 4, 8, 17, 12, 16, 22],
    (1, 1): [3, 7, 6, 2, 19, 14, 18, 10, 23],
}
"""faces of a brick across x and y, at their lower and upper ends"""


def plate_mesh() -> meshio.Mesh:
    places = np.array([(i, j) for i in range(ELEMENTS) for j in range(ELEMENTS)])
    origins = 2 * np.column_stack([places, np.zeros(len(places), dtype=int)])
    grid, cells = np.unique((origins[:, None] + LOCAL).reshape(-1, 3), axis=0, return_inverse=True)
    cells = cells.reshape(-1, 27)
    rim = [
        cells[places[:, axis] == end * (ELEMENTS - 1)][:, nodes]
        for (axis, end), nodes in SIDES.items()
    ]
    middle = np.array([ELEMENTS, ELEMENTS, 1])
    points = 0.5 * (grid - middle) * [SIZE / ELEMENTS, SIZE / ELEMENTS, THICKNESS]
    blocks = [
        meshio.CellBlock("quad9", np.concatenate(rim)),
        meshio.CellBlock("hexahedron27", cells),
    ]
    tags = [np.full(len(block.data), i + 1) for i, block in enumerate(blocks)]
    return meshio.Mesh(
        np.round(points, 9),
        blocks,
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={"rim": np.array([1, 2]), "plate": np.array([2, 3])},
    )


if __name__ == "__main__":
    target = Path(__file__).with_name("plate.msh")
    plate_mesh().write(target, file_format="gmsh22", binary=False)
