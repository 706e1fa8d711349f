"""A bar of two materials with all that a body can have, as files; and MPI, where it can be had."""

import platform
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from ..blocks import SOLID_TYPES, named, solid_cells

# The extra `mpi` asks for these; elsewhere there is nothing that could be installed.
HAS_WHEELS = (
    sys.version_info >= (3, 12)
    and sys.platform == "linux"
    and platform.machine() in ("x86_64", "AMD64")
)
collect_ignore = [] if HAS_WHEELS else ["test_together.py", "test_ends.py"]

BODY = """
name = "bar"
mesh = "bar.msh"

[materials.front]
E = 2.1e11
nu = 0.3
rho = 7800.0

[materials.back]
E = 0.7e11
nu = 0.33
rho = 2700.0

[interfaces.root]
group = "root"
kind = "rigid"

[interfaces.tip]
group = "tip"

[masses.motor]
mass = 0.2
inertia = [1e-4, 1e-4, 1e-4]
box = {corners = [[0.04, -1, 0.02], [0.08, 1, 0.02]]}

[masses.flange]
mass = 0.1
interface = "root"

[loads.wind]
pressure = 1.0
box = {corners = [[-1, 0.0, -1], [1, 0.0, 1]]}

[loads.weight]
force_per_volume = [0, 0, 1]

[sensors.gauge]
point = [0.05, 0.02, 0.01]
direction = [1, 0, 0]

[recovery]
stress = true

[impulse]
step = 1e-5
steps = 100
band = 10000
tolerance = 1e-5
method = "krylov"
"""


@pytest.fixture(scope="session")
def bar(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """The body file of a bar of ten-node tetrahedra, in a folder of its own, with its mesh.

    changes: words of the file, and what is to stand there.
    """

    def write(changes: dict[str, str] | None = None, divisions: tuple = (6, 2, 2)) -> Path:
        folder = tmp_path_factory.mktemp("bar")
        grid, cells = solid_cells("tetra10", divisions)
        middle = grid[cells[:, :4], 0].mean(axis=1) < divisions[0]
        parts = [("front", "tetra10", cells[middle]), ("back", "tetra10", cells[~middle])]
        faces = cells[:, SOLID_TYPES["tetra10"].facets["triangle6"]].reshape(-1, 6)
        for name, x in (("root", 0), ("tip", 2 * divisions[0])):
            parts.append((name, "triangle6", faces[(grid[faces, 0] == x).all(axis=1)]))
        mesh = named(grid * 0.01 / 2 * 2 / divisions[1], parts)
        mesh.write(folder / "bar.msh", file_format="gmsh22", binary=False)
        text = BODY
        for old, new in (changes or {}).items():
            assert old in text
            text = text.replace(old, new)
        (folder / "bar.toml").write_text(text)
        return folder / "bar.toml"

    return write
