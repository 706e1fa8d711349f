"""An open housing of 8-node hexahedra on four crowned feet, in meters.

    python meshes/housing/make_mesh.py

A tray of 100 x 70 mm with walls of 30 mm, 2.5 mm thick everywhere. Its feet are 10 mm wide and 6 mm
high; their soles are crowned by a radius of 50 mm, and finer than the rest.
"""

from pathlib import Path

import meshio
import numpy as np

LENGTH, WIDTH, WALL, THICKNESS = 0.1, 0.07, 0.03, 0.0025
FOOT, HEIGHT, CROWN = 0.01, 0.006, 0.05
FINE, COARSE = 0.00125, 0.005
"""sizes of elements: in feet and walls, and between"""
CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def along(length: float, fine: float, coarse: float) -> np.ndarray:
    """Places of nodes: fine across the feet at both ends, coarse between them."""
    middle = np.linspace(FOOT, length - FOOT, round((length - 2.0 * FOOT) / coarse) + 1)
    foot = np.linspace(0.0, FOOT, round(FOOT / fine) + 1)
    return np.concatenate([foot[:-1], middle, length - foot[-2::-1]])


def housing(fine: float = FINE, coarse: float = COARSE) -> meshio.Mesh:
    x, y = (along(size, fine, coarse) for size in (LENGTH, WIDTH))
    heights = (0.0, THICKNESS, WALL)
    z = np.concatenate(
        [
            np.linspace(-HEIGHT, 0.0, 5)[:-1],
            np.linspace(*heights[:2], 3)[:-1],
            np.linspace(*heights[1:], 7),
        ]
    )
    centers = [0.5 * (axis[1:] + axis[:-1]) for axis in (x, y, z)]
    X, Y, Z = np.meshgrid(*centers, indexing="ij")
    ends = [np.minimum(X, LENGTH - X), np.minimum(Y, WIDTH - Y)]
    in_foot = (Z < 0.0) & (ends[0] < FOOT) & (ends[1] < FOOT)
    in_wall = (Z > THICKNESS) & (np.minimum(*ends) < THICKNESS)
    in_floor = (Z > 0.0) & (Z < THICKNESS)
    cells = np.argwhere(in_foot | in_wall | in_floor)
    corners = cells[:, None, :] + np.array(CORNERS)
    grid = np.ravel_multi_index(tuple(np.moveaxis(corners, -1, 0)), (len(x), len(y), len(z)))
    used, numbers = np.unique(grid, return_inverse=True)
    i, j, k = np.unravel_index(used, (len(x), len(y), len(z)))
    points = np.stack([x[i], y[j], z[k]], axis=1)
    below = points[:, 2] < 0.0
    from_middle = [
        np.minimum(points[:, axis], size - points[:, axis]) - 0.5 * FOOT
        for axis, size in ((0, LENGTH), (1, WIDTH))
    ]
    rise = (from_middle[0] ** 2 + from_middle[1] ** 2) / (2.0 * CROWN)
    points[below, 2] -= rise[below] * points[below, 2] / HEIGHT
    return meshio.Mesh(points, [("hexahedron", numbers.reshape(grid.shape))])


if __name__ == "__main__":
    mesh = housing()
    # written by Gmsh's format in doubles, as the other meshes are
    meshio.write(Path(__file__).with_name("housing.msh"), mesh, file_format="gmsh22", binary=True)
