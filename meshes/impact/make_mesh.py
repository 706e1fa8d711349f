"""The lines of the examples of impact along x: two rods, a beam on two supports, an arm.

Ends are named left and right, the middle of the beam middle.
"""

from pathlib import Path

import meshio
import numpy as np

LINES = {"rod": (1.0, 160), "long_rod": (2.0, 320), "beam": (0.307, 40), "arm": (1.0, 80)}
"""length [m] and number of elements"""


def line_mesh(length: float, elements: int) -> meshio.Mesh:
    points = np.zeros((elements + 1, 3))
    points[:, 0] = np.linspace(0.0, length, elements + 1)
    places = {"left": 0, "middle": elements // 2, "right": elements}
    cells = [meshio.CellBlock("vertex", np.array([[node]])) for node in places.values()]
    nodes = np.arange(elements)
    cells.append(meshio.CellBlock("line", np.column_stack([nodes, nodes + 1])))
    tags = [np.full(len(cell.data), i + 1) for i, cell in enumerate(cells)]
    names = {name: np.array([i + 1, 0]) for i, name in enumerate(places)}
    return meshio.Mesh(
        points,
        cells,
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data=names | {"line": np.array([len(cells), 1])},
    )


if __name__ == "__main__":
    here = Path(__file__).parent
    for name, (length, elements) in LINES.items():
        mesh = line_mesh(length, elements)
        mesh.write(here / f"{name}.msh", file_format="gmsh22", binary=False)
