"""A ball stud of 20-node hexahedra, in meters: groups ball, end and stud.

    python meshes/ball_stud/make_mesh.py

A ball of 10 mm radius about the origin, and a neck down to z = -40 mm that grows from a sixth of
the ball. `ball` is the rest of its surface.
"""

from pathlib import Path

import meshio
import numpy as np
from numpy.typing import NDArray

RADIUS, CUBE, END = 0.01, 0.0042, 0.04
"""of the ball; half the edge of the cube in its middle; distance of the end of the neck [m]"""
ALONG, RINGS, NECK = 5, 2, 5
"""elements along an edge of the cube, from there to the surface, and along the neck"""

CORNERS = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
)
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)]
EDGES += [(0, 4), (1, 5), (2, 6), (3, 7)]
LOCAL = np.vstack([2 * CORNERS, [CORNERS[a] + CORNERS[b] for a, b in EDGES]]) / 2
"""corners and middles of edges of a brick"""
TOP = [4, 5, 6, 7, 12, 13, 14, 15]
MIRRORED = [0, 3, 2, 1, 4, 7, 6, 5, 11, 10, 9, 8, 15, 14, 13, 12, 16, 19, 18, 17]
"""nodes of its upper face, and of all of it with its first two directions exchanged"""

Array = NDArray[np.float64]


def direction(grid: Array) -> Array:
    """Unit vectors (n, 3) to points of a face of the cube, whose angles are equal."""
    at = np.column_stack([np.tan(0.25 * np.pi * grid), np.ones(len(grid))])
    unit: Array = at / np.linalg.norm(at, axis=1)[:, None]
    return unit


def grid_of(*counts: int) -> Array:
    """Nodes (bricks, 20, 3) of a grid from 0 to 1 in each direction."""
    steps = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1)
    grid: Array = (steps.reshape(-1, 1, 3) + LOCAL) / np.array(counts)
    return grid


def inner() -> Array:
    """The cube, whose faces bulge a little towards the ball."""
    x = 2.0 * grid_of(ALONG, ALONG, ALONG) - 1.0
    return bulged(x.reshape(-1, 3)).reshape(x.shape)


def bulged(x: Array) -> Array:
    """Points of the cube from -1 to 1: a mean of itself and of a ball, by a share of its edge."""
    largest = np.abs(x).max(axis=1, keepdims=True)
    face = np.divide(x, largest, out=np.zeros_like(x), where=largest > 0.0)
    angles = np.tan(0.25 * np.pi * face)
    ball = angles / np.maximum(np.linalg.norm(angles, axis=1, keepdims=True), 1e-300)
    points: Array = CUBE * largest * (0.5 * face + 0.5 * np.sqrt(2.0) * ball)
    return points


def outer() -> Array:
    """From the lower face of the cube to the ball, towards -z, first the cells at the cube."""
    grid = grid_of(ALONG, ALONG, RINGS)
    face = 2.0 * grid.reshape(-1, 3)[:, :2] - 1.0
    start = bulged(np.column_stack([face, -np.ones(len(face))]))
    end = RADIUS * direction(face) * [1.0, 1.0, -1.0]
    share = grid.reshape(-1, 3)[:, 2:]
    return ((1.0 - share) * start + share * end).reshape(grid.shape)


def neck() -> Array:
    """From the lower sixth of the ball down, where it becomes flat."""
    grid = grid_of(ALONG, ALONG, NECK)
    start = RADIUS * direction(2.0 * grid.reshape(-1, 3)[:, :2] - 1.0) * [1.0, 1.0, -1.0]
    z = -END * grid.reshape(-1, 3)[:, 2] + (1.0 - grid.reshape(-1, 3)[:, 2]) * start[:, 2]
    return np.column_stack([start[:, :2], z]).reshape(grid.shape)


def stud() -> meshio.Mesh:
    turns = [np.eye(3), np.diag([1.0, -1.0, -1.0])]
    for sign in (1, -1):
        turns.append(np.array([[0, 0, sign], [0, 1, 0], [-sign, 0, 0]], dtype=float))
        turns.append(np.array([[1, 0, 0], [0, 0, sign], [0, -sign, 0]], dtype=float))
    sixths = [outer() @ turn.T for turn in turns]
    every = np.concatenate([inner(), *sixths, neck()])
    edges = every[:, [1, 3, 4]] - every[:, :1]
    mirrored = np.linalg.det(edges) < 0.0
    every[mirrored] = every[mirrored][:, MIRRORED]
    points, numbers = np.unique(
        np.round(every.reshape(-1, 3), 9) + 0.0, axis=0, return_inverse=True
    )
    cells = numbers.reshape(-1, 20)
    # The upper faces of the last layers of the sixths, of which the first is above the neck, and of
    # the neck.
    parts = np.split(cells[ALONG**3 :], np.cumsum([ALONG**2 * RINGS] * 6))
    tops = [
        part.reshape(-1, layers, 20)[:, -1][:, TOP]
        for part, layers in zip(parts, [*[RINGS] * 6, NECK], strict=True)
    ]
    blocks = [np.concatenate(tops[1:6]), tops[6], cells]
    groups = [np.full(len(block), k + 1) for k, block in enumerate(blocks)]
    names = {"ball": [1, 2], "end": [2, 2], "stud": [3, 3]}
    return meshio.Mesh(
        points,
        [("quad8", blocks[0]), ("quad8", blocks[1]), ("hexahedron20", cells)],
        cell_data={"gmsh:physical": groups, "gmsh:geometrical": groups},
        field_data={name: np.array(value) for name, value in names.items()},
    )


if __name__ == "__main__":
    # written by Gmsh's format in doubles, as the other meshes are
    target = Path(__file__).with_name("ball_stud.msh")
    meshio.write(target, stud(), file_format="gmsh22", binary=True)
