"""Meshes made on the spot: boxes of every solid element, lines, and the files that hold them."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from duhamel.preprocess import Body
from duhamel.preprocess.facets import LOCAL

SOLIDS = ["tetra", "tetra10", "hexahedron", "hexahedron20", "hexahedron27"]
FACET_TYPES = {
    "tetra": "triangle",
    "tetra10": "triangle6",
    "hexahedron": "quad",
    "hexahedron20": "quad8",
    "hexahedron27": "quad9",
}
CUBE = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
SIX_TETRAHEDRA = np.array([(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)])
TETRA_EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
CUBE_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
CUBE_FACES = [(0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7)]

IMPULSE = {"step": 1e-4, "steps": 20}
STEEL = {"E": 2.1e11, "nu": 0.3, "rho": 7800.0}
SECTION = {
    "EA": 2.16e7,
    "EI_y": 5.5,
    "EI_z": 5.5,
    "GJ": 4.0,
    "mass_per_length": 0.0858,
    "polar_inertia_per_length": 4.4e-8,
}


def solid_cells(kind: str, divisions: tuple[int, int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Points on a grid of half elements (integers), and cells in meshio's order."""
    origins = 2 * np.stack(np.meshgrid(*map(np.arange, divisions), indexing="ij"), axis=-1).reshape(-1, 1, 3)
    corners = origins + 2 * CUBE  # (n, 8, 3)
    edges, faces = CUBE_EDGES, CUBE_FACES
    if kind.startswith("tetra"):
        corners = corners[:, SIX_TETRAHEDRA].reshape(-1, 4, 3)
        edges, faces = TETRA_EDGES, []
    nodes = [corners]
    if kind in ("tetra10", "hexahedron20", "hexahedron27"):
        nodes.append(np.stack([(corners[:, a] + corners[:, b]) // 2 for a, b in edges], axis=1))
    if kind == "hexahedron27":
        nodes.append(np.stack([corners[:, face].sum(axis=1) // 4 for face in faces], axis=1))
        nodes.append(corners.sum(axis=1, keepdims=True) // 8)
    per_cell = np.concatenate(nodes, axis=1)
    points, cells = np.unique(per_cell.reshape(-1, 3), axis=0, return_inverse=True)
    return points, cells.reshape(len(per_cell), -1)


def box_mesh(
    kind: str,
    size: tuple[float, float, float] = (1.0, 1.0, 1.0),
    divisions: tuple[int, int, int] = (2, 2, 2),
) -> meshio.Mesh:
    """A box from the origin; groups root and tip are its faces across x, and all its elements are in `box`."""
    grid, cells = solid_cells(kind, divisions)
    points = grid / (2.0 * np.array(divisions)) * size
    (local,) = LOCAL[kind].values()
    faces = cells[:, np.array(local)].reshape(-1, len(local[0]))
    at = {name: faces[(grid[faces, 0] == x).all(axis=1)] for name, x in (("root", 0), ("tip", 2 * divisions[0]))}
    facet = FACET_TYPES[kind]
    return named(points, [("root", facet, at["root"]), ("tip", facet, at["tip"]), ("box", kind, cells)])


def line_mesh(points: Any, lines: Any = None) -> meshio.Mesh:
    """Lines through points in their order, unless given; groups root and tip are the first and last point."""
    points = np.asarray(points, dtype=float)
    if lines is None:
        lines = np.stack([np.arange(len(points) - 1), np.arange(1, len(points))], axis=1)
    ends = [("root", "vertex", [[0]]), ("tip", "vertex", [[len(points) - 1]])]
    return named(points, [*ends, ("beam", "line", lines)])


def straight(elements: int, length: float = 0.5, along: Any = (1.0, 0.0, 0.0)) -> meshio.Mesh:
    return line_mesh(np.linspace(0.0, length, elements + 1)[:, None] * np.array(along))


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


@pytest.fixture(params=SOLIDS)
def kind(request: pytest.FixtureRequest) -> str:
    """Every type of solid."""
    return str(request.param)


@pytest.fixture
def box() -> Callable[..., meshio.Mesh]:
    return box_mesh


@pytest.fixture
def beam() -> Callable[..., meshio.Mesh]:
    return straight


@pytest.fixture
def lines() -> Callable[..., meshio.Mesh]:
    return line_mesh


@pytest.fixture
def section() -> dict[str, float]:
    return dict(SECTION)


@pytest.fixture
def save(tmp_path: Path) -> Callable[..., Path]:
    """Write a mesh, by default as Gmsh 2.2 text; gives the path."""

    def write(mesh: meshio.Mesh, name: str = "mesh.msh", file_format: str = "gmsh22", **options: Any) -> Path:
        path = tmp_path / name
        if file_format == "gmsh22":
            mesh = meshio.Mesh(mesh.points, mesh.cells, cell_data=mesh.cell_data, field_data=mesh.field_data)
        options = options or {"binary": False}
        mesh.write(path, file_format=file_format, **options)
        return path

    return write


@pytest.fixture
def beam_body(save: Callable[..., Path]) -> Callable[..., Body]:
    """A body of lines: the paper's beam unless told otherwise."""

    def make(mesh: meshio.Mesh, section: Mapping[str, Any] = SECTION, **changes: Any) -> Body:
        values = {
            "name": "beam",
            "mesh": save(mesh),
            "section": section,
            "interfaces": {"root": {"group": "root"}, "tip": {"group": "tip"}},
            "impulse": IMPULSE,
            **changes,
        }
        return Body.model_validate({key: value for key, value in values.items() if value is not None})

    return make


@pytest.fixture
def solid_body(save: Callable[..., Path]) -> Callable[..., Body]:
    """A body of solids: steel, with averaged frames on its ends, unless told otherwise."""

    def make(mesh: meshio.Mesh, **changes: Any) -> Body:
        values = {
            "name": "solid",
            "mesh": save(mesh),
            "material": STEEL,
            "interfaces": {"root": {"group": "root"}, "tip": {"group": "tip"}},
            "impulse": IMPULSE,
            **changes,
        }
        return Body.model_validate({key: value for key, value in values.items() if value is not None})

    return make
