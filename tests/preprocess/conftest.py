"""Meshes made on the spot, the files that hold them, and bodies on them."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from duhamel.preprocess import Body
from duhamel.preprocess.mesh.cells import SOLID_TYPES

from .blocks import box_mesh, named

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


def line_mesh(points: Any, lines: Any = None) -> meshio.Mesh:
    """Lines through points in their order, unless given; groups root and tip are the first and last
    point.
    """
    points = np.asarray(points, dtype=float)
    if lines is None:
        lines = np.stack([np.arange(len(points) - 1), np.arange(1, len(points))], axis=1)
    ends = [("root", "vertex", [[0]]), ("tip", "vertex", [[len(points) - 1]])]
    return named(points, [*ends, ("beam", "line", lines)])


def straight(elements: int, length: float = 0.5, along: Any = (1.0, 0.0, 0.0)) -> meshio.Mesh:
    return line_mesh(np.linspace(0.0, length, elements + 1)[:, None] * np.array(along))


@pytest.fixture(params=SOLID_TYPES)
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

    def write(
        mesh: meshio.Mesh, name: str = "mesh.msh", file_format: str = "gmsh22", **options: Any
    ) -> Path:
        path = tmp_path / name
        if file_format == "gmsh22":
            mesh = meshio.Mesh(
                mesh.points, mesh.cells, cell_data=mesh.cell_data, field_data=mesh.field_data
            )
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
        return Body.model_validate(
            {key: value for key, value in values.items() if value is not None}
        )

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
        return Body.model_validate(
            {key: value for key, value in values.items() if value is not None}
        )

    return make
