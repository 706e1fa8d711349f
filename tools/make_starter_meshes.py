"""The meshes of the starter projects of `duhamel init`: `python tools/make_starter_meshes.py`.

A row of lines in meters, and an angle bracket of 20-node hexahedra in millimeters.
"""

from itertools import product
from pathlib import Path

import meshio
import numpy as np

STARTERS = Path(__file__).resolve().parents[1] / "cli" / "starters"

CORNERS = ((0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2))
EDGES = (
    *((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)),
    *((0, 4), (1, 5), (2, 6), (3, 7)),
)
HEXAHEDRON = np.array([*CORNERS, *(np.add(CORNERS[a], CORNERS[b]) // 2 for a, b in EDGES)])
"""a 20-node hexahedron in half steps of a grid, numbered as meshio has it"""
QUAD = HEXAHEDRON[[0, 1, 2, 3, 8, 9, 10, 11]]
"""its lower face"""


def row_of_lines(length: float, n: int) -> meshio.Mesh:
    """Lines along x from the origin [m]; the ends are the groups root and tip."""
    points = np.zeros((n + 1, 3))
    points[:, 0] = np.linspace(0.0, length, n + 1)
    lines = np.stack([np.arange(n), np.arange(1, n + 1)], axis=1)
    cells = [("vertex", np.array([[0]])), ("vertex", np.array([[n]])), ("line", lines)]
    return _mesh(points, cells, {"root": [1, 0], "tip": [2, 0], "lines": [3, 1]})


def bracket() -> meshio.Mesh:
    """A foot of 60 x 40 x 5 mm and a wall as high, as hexahedra of 10 x 10 x 5 mm."""
    x = np.array([0, 5, *range(15, 66, 10)], dtype=float)
    z = np.array([0, 5, *range(15, 66, 10)], dtype=float)
    y = np.arange(0.0, 41.0, 10.0)
    boxes = [
        (i, j, k)
        for i, j, k in product(range(len(x) - 1), range(4), range(len(z) - 1))
        if i == 0 or k == 0
    ]
    solids = [2 * np.array(box) + HEXAHEDRON for box in boxes]
    foot = [2 * np.array(box) + QUAD for box in boxes if box[2] == 0]
    top = [2 * np.array(box) + QUAD + [0, 0, 2] for box in boxes if box[2] == len(z) - 2]
    places, numbers = np.unique(np.concatenate(solids), axis=0, return_inverse=True)
    number = {tuple(place): i for i, place in enumerate(places.tolist())}
    quads = [
        np.array([[number[tuple(at)] for at in quad.tolist()] for quad in face])
        for face in (foot, top)
    ]
    halves = [
        np.interp(np.arange(2 * len(axis) - 1) / 2, range(len(axis)), axis) for axis in (x, y, z)
    ]
    points = np.stack([half[place] for half, place in zip(halves, places.T, strict=True)], axis=1)
    cells = [("quad8", quads[0]), ("quad8", quads[1]), ("hexahedron20", numbers.reshape(-1, 20))]
    return _mesh(points, cells, {"foot": [1, 2], "top": [2, 2], "bracket": [3, 3]})


def _mesh(points, cells, groups) -> meshio.Mesh:
    """A mesh of which each block of cells is a group."""
    tags = [
        np.full(len(block), tag)
        for (_, block), (tag, _) in zip(cells, groups.values(), strict=True)
    ]
    return meshio.Mesh(
        points,
        cells,
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={name: np.array(tag) for name, tag in groups.items()},
    )


if __name__ == "__main__":
    for mesh, name in (
        (row_of_lines(0.6, 12), "beam-project/arm.msh"),
        (bracket(), "solid-project/bracket.msh"),
        (row_of_lines(0.15, 12), "mechanism-project/rod.msh"),
    ):
        mesh.write(STARTERS / name, file_format="gmsh22", binary=False)
