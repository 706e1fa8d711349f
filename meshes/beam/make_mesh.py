"""The mesh of the paper's beam: ten lines over half a meter, the ends named root and tip."""

from pathlib import Path

import meshio
import numpy as np

LENGTH, ELEMENTS = 0.5, 10


def beam_mesh() -> meshio.Mesh:
    x = np.linspace(0.0, LENGTH, ELEMENTS + 1)
    points = np.stack([x, np.zeros_like(x), np.zeros_like(x)], axis=1)
    lines = np.stack([np.arange(ELEMENTS), np.arange(1, ELEMENTS + 1)], axis=1)
    tags = [np.array([1]), np.array([2]), np.full(ELEMENTS, 3)]
    return meshio.Mesh(
        points,
        [("vertex", np.array([[0]])), ("vertex", np.array([[ELEMENTS]])), ("line", lines)],
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={"root": np.array([1, 0]), "tip": np.array([2, 0]), "beam": np.array([3, 1])},
    )


if __name__ == "__main__":
    beam_mesh().write(Path(__file__).with_name("beam.msh"), file_format="gmsh22", binary=False)
