"""Boxes of every type of solid, and of several: structured, with named groups, at any size and
without a mesher.
"""

from typing import Any

import meshio
import numpy as np
from duhamel.preprocess.mesh.cells import SOLID_TYPES

CUBE = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
)
SIX_TETRAHEDRA = np.array(
    [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)]
)
TWO_WEDGES = np.array([(0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)])
TETRA_EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
CUBE_EDGES = [
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
CUBE_FACES = [(0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7)]


def solid_cells(kind: str, divisions: tuple[int, int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Points on a grid of half elements (integers), and cells in meshio's order."""
    origins = 2 * np.stack(np.meshgrid(*map(np.arange, divisions), indexing="ij"), axis=-1).reshape(
        -1, 1, 3
    )
    corners = origins + 2 * CUBE  # (n, 8, 3)
    edges, faces = CUBE_EDGES, CUBE_FACES
    if kind.startswith("tetra"):
        corners = corners[:, SIX_TETRAHEDRA].reshape(-1, 4, 3)
        edges, faces = TETRA_EDGES, []
    elif kind == "wedge":
        corners = corners[:, TWO_WEDGES].reshape(-1, 6, 3)
    nodes = [corners]
    if kind in ("tetra10", "hexahedron20", "hexahedron27"):
        nodes.append(np.stack([(corners[:, a] + corners[:, b]) // 2 for a, b in edges], axis=1))
    if kind == "hexahedron27":
        nodes.append(np.stack([corners[:, face].sum(axis=1) // 4 for face in faces], axis=1))
        nodes.append(corners.sum(axis=1, keepdims=True) // 8)
    per_cell = np.concatenate(nodes, axis=1)
    shape = tuple(2 * n + 1 for n in divisions)
    # Numbers on the grid are in the order of the points, and sorted sooner.
    numbers = np.ravel_multi_index(tuple(np.moveaxis(per_cell, -1, 0)), shape)
    found, cells = np.unique(numbers, return_inverse=True)
    points = np.stack(np.unravel_index(found, shape), axis=1)
    return points, cells.reshape(numbers.shape)


def box_mesh(
    kind: str,
    size: tuple[float, float, float] = (1.0, 1.0, 1.0),
    divisions: tuple[int, int, int] = (2, 2, 2),
) -> meshio.Mesh:
    """A box from the origin; groups root and tip are its faces across x, and all its elements are
    in `box`.
    """
    grid, cells = solid_cells(kind, divisions)
    points = grid / (2.0 * np.array(divisions)) * size
    parts = []
    for facet, local in SOLID_TYPES[kind].facets.items():
        faces = cells[:, np.array(local)].reshape(-1, len(local[0]))
        for name, x in (("root", 0), ("tip", 2 * divisions[0])):
            parts.append((name, facet, faces[(grid[faces, 0] == x).all(axis=1)]))
    return named(points, [*(part for part in parts if len(part[2])), ("box", kind, cells)])


def mixed_mesh(divisions: int = 1) -> meshio.Mesh:
    """Three unit cubes as an L: tetrahedra, on them wedges, beside those hexahedra; groups named as
    the types.
    """
    places = {"tetra": (0, 0, 0), "wedge": (0, 0, 1), "hexahedron": (1, 0, 1)}
    apart = {kind: solid_cells(kind, (divisions,) * 3) for kind in places}
    corners = {
        kind: grid[cells] + 2 * divisions * np.array(places[kind])
        for kind, (grid, cells) in apart.items()
    }
    flat = np.concatenate([points.reshape(-1, 3) for points in corners.values()])
    grid, numbers = np.unique(flat, axis=0, return_inverse=True)
    ends = np.cumsum([len(points.reshape(-1, 3)) for points in corners.values()])[:-1]
    parts = np.split(numbers.ravel(), ends)
    cells = [
        (kind, kind, part.reshape(corners[kind].shape[:2]))
        for kind, part in zip(places, parts, strict=True)
    ]
    return named(grid / (2.0 * divisions), cells)


def named(points: np.ndarray, parts: list[tuple[str, str, Any]]) -> meshio.Mesh:
    """A mesh whose parts are physical groups of Gmsh, each an entity of its own."""
    cells = [meshio.CellBlock(kind, np.asarray(rows)) for _, kind, rows in parts]
    tags = [np.full(len(block), i + 1) for i, block in enumerate(cells)]
    entities = np.zeros((len(points), 2), dtype=int)
    for i in reversed(range(len(parts))):
        entities[cells[i].data[0 if cells[i].dim == 3 else slice(None)]] = cells[i].dim, i + 1
    return meshio.Mesh(
        points,
        cells,
        point_data={"gmsh:dim_tags": entities},
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={name: np.array([i + 1, cells[i].dim]) for i, (name, _, _) in enumerate(parts)},
    )
