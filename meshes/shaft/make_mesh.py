"""A line of 24 elements along x, 1 m long: left and right, its ends, and disk, at a third of it.

python meshes/shaft/make_mesh.py
"""

from pathlib import Path

import meshio
import numpy as np

LENGTH, ELEMENTS = 1.0, 24
PLACES = {"left": 0, "right": ELEMENTS, "disk": ELEMENTS // 3}


def line_mesh() -> meshio.Mesh:
    points = np.zeros((ELEMENTS + 1, 3))
    points[:, 0] = np.linspace(0.0, LENGTH, ELEMENTS + 1)
    nodes = np.arange(ELEMENTS)
    cells = [meshio.CellBlock("vertex", np.array([[node]])) for node in PLACES.values()]
    cells.append(meshio.CellBlock("line", np.column_stack([nodes, nodes + 1])))
    tags = [np.full(len(cell.data), i + 1) for i, cell in enumerate(cells)]
    names = {name: np.array([i + 1, 0]) for i, name in enumerate(PLACES)}
    return meshio.Mesh(
        points,
        cells,
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data=names | {"shaft": np.array([len(cells), 1])},
    )


if __name__ == "__main__":
    line_mesh().write(Path(__file__).with_name("shaft.msh"), file_format="gmsh22", binary=False)
