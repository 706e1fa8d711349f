"""A disk with eight blades in 20-node hexahedra, about z: groups bore, tip_1 to tip_8, and wheel.

    python meshes/disk/make_mesh.py

The disk is a ring of constant thickness. The first element of a blade goes over from the rim, which
is round, to a straight prism of constant section, which begins at the radius PLATFORM. Blade 1 lies
along x.
"""

from collections.abc import Callable
from pathlib import Path

import meshio
import numpy as np
from numpy.typing import NDArray

BORE, RIM, PLATFORM, TIP = 0.03, 0.10, 0.115, 0.20
"""radii [m]"""
THICKNESS, WIDTH = 0.012, 0.016
"""along the axis, and of a blade around it [m]"""
BLADES, PER_BLADE = 8, 3
"""and elements around the disk for each: the middle one carries it"""
RINGS, LENGTHS, LAYERS = 3, 6, 1
"""elements along the radius of the disk, along a blade, and along the axis"""
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)]
EDGES += [(0, 4), (1, 5), (2, 6), (3, 7)]
CORNERS = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
)
LOCAL = np.vstack([2 * CORNERS, [CORNERS[a] + CORNERS[b] for a, b in EDGES]]) / 2
"""corners and middles of edges of a brick, along the radius, around and along the axis"""
INNER, OUTER = [0, 4, 7, 3, 16, 15, 19, 11], [1, 2, 6, 5, 9, 18, 13, 17]
"""faces of a brick"""

Array = NDArray[np.float64]
Mapping = Callable[[Array], Array]


def of_disk(grid: Array) -> Array:
    """Points (n, 3) at (rings, elements around, layers) of a grid."""
    r = BORE + (RIM - BORE) * grid[:, 0] / RINGS
    angle = 2.0 * np.pi * (grid[:, 1] - 0.5 * PER_BLADE) / (BLADES * PER_BLADE)
    z = THICKNESS * (grid[:, 2] / LAYERS - 0.5)
    return np.column_stack([r * np.cos(angle), r * np.sin(angle), z])


def of_blade(n: int) -> Mapping:
    """Of blade n, whose first element takes the round rim to the straight blade."""

    def points(grid: Array) -> Array:
        start = PER_BLADE * n + PER_BLADE // 2
        rim = of_disk(np.column_stack([np.full(len(grid), RINGS), start + grid[:, 1], grid[:, 2]]))
        x = PLATFORM + (TIP - PLATFORM) * (grid[:, 0] - 1.0) / (LENGTHS - 1)
        across, angle = WIDTH * (grid[:, 1] - 0.5), 2.0 * np.pi * n / BLADES
        cos, sin = np.cos(angle), np.sin(angle)
        straight = [cos * x - sin * across, sin * x + cos * across, rim[:, 2]]
        first = np.column_stack([PLATFORM * cos - sin * across, PLATFORM * sin + cos * across])
        share = grid[:, :1]
        over = np.column_stack([(1.0 - share) * rim[:, :2] + share * first, rim[:, 2]])
        return np.where(share < 1.0, over, np.column_stack(straight))

    return points


def bricks(shape: tuple[int, int, int], mapping: Mapping) -> Array:
    """Points (cells, 20, 3) of a grid of bricks."""
    origins = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1)
    grid = (origins.reshape(-1, 1, 3) + LOCAL).reshape(-1, 3)
    return mapping(grid).reshape(-1, 20, 3)


def wheel() -> meshio.Mesh:
    disk = bricks((RINGS, BLADES * PER_BLADE, LAYERS), of_disk)
    blades = [bricks((LENGTHS, 1, LAYERS), of_blade(n)) for n in range(BLADES)]
    every = np.concatenate([disk, *blades]).reshape(-1, 3)
    _, first, nodes = np.unique(
        np.round(every, 9) + 0.0, axis=0, return_index=True, return_inverse=True
    )
    cells = nodes.reshape(-1, 20)
    per_blade, of_ring = LENGTHS * LAYERS, BLADES * PER_BLADE * LAYERS
    groups = [("bore", "quad8", cells[:of_ring][:, INNER])]
    for n in range(BLADES):
        end = len(disk) + (n + 1) * per_blade
        groups.append((f"tip_{n + 1}", "quad8", cells[end - LAYERS : end][:, OUTER]))
    return named(every[first], [*groups, ("wheel", "hexahedron20", cells)])


def named(points: Array, parts: list[tuple[str, str, NDArray[np.int64]]]) -> meshio.Mesh:
    """A mesh whose parts are the physical groups of Gmsh."""
    cells = [meshio.CellBlock(kind, rows) for _, kind, rows in parts]
    tags = [np.full(len(rows), i + 1) for i, (_, _, rows) in enumerate(parts)]
    names = {name: np.array([i + 1, cells[i].dim]) for i, (name, _, _) in enumerate(parts)}
    return meshio.Mesh(
        points, cells, cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags}, field_data=names
    )


if __name__ == "__main__":
    wheel().write(Path(__file__).with_name("wheel.msh"), file_format="gmsh22", binary=False)
