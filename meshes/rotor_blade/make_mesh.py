"""A line of 20 elements along x, 4.75 m long: root and tip, its ends.

python meshes/rotor_blade/make_mesh.py
"""

from pathlib import Path

import meshio
import numpy as np

LENGTH, ELEMENTS = 4.75, 20


def line_mesh() -> meshio.Mesh:
    points = np.zeros((ELEMENTS + 1, 3))
    points[:, 0] = np.linspace(0.0, LENGTH, ELEMENTS + 1)
    nodes = np.arange(ELEMENTS)
    ends = [meshio.CellBlock("vertex", np.array([[node]])) for node in (0, ELEMENTS)]
    cells = [*ends, meshio.CellBlock("line", np.column_stack([nodes, nodes + 1]))]
    tags = [np.full(len(cell.data), i + 1) for i, cell in enumerate(cells)]
    return meshio.Mesh(
        points,
        cells,
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={"root": np.array([1, 0]), "tip": np.array([2, 0]), "blade": np.array([3, 1])},
    )


if __name__ == "__main__":
    line_mesh().write(Path(__file__).with_name("blade.msh"), file_format="gmsh22", binary=False)
