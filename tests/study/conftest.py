"""A hub on a pivot that a torque C turns: its angle is C t^2 / (2 J); and a superelement that flies
beside it.
"""

from collections.abc import Callable
from pathlib import Path

import h5py
import meshio
import numpy as np
import pytest
from duhamel.superelement import (
    GeneralizedAlpha,
    Interface,
    Modes,
    Superelement,
    sample_kernel,
    write,
)

MODEL = """
[simulation]
t_end = 0.05
step = 5e-4

[bodies.hub]
mass = 1.0
inertia = [2, 2, 4]

[bodies.beam]
superelement = "parts/beam.h5"
velocity = [1, 0, 0]

[[joints]]
name = "pivot"
type = "revolute"
between = ["ground", "hub"]
axis = [0, 0, 1]

[[loads]]
type = "torque"
on = "hub"
direction = [0, 0, 1]
signal = 8
"""

STUDY = """
model = "model/hub.toml"

[parameters]
bodies.hub.inertia = [[2, 2, 4], [1, 1, 2]]
loads.0.signal = [8, 4, 2]

[outputs]
angle = "final angle:hub:z"
"""


def make_element(mass: float) -> Superelement:
    modes = Modes(
        2 * np.pi * np.array([100.0, 250.0]),
        np.full(2, 0.01),
        np.random.default_rng(0).normal(size=(6, 2)),
    )
    return Superelement(
        name="beam",
        mass=mass,
        J_rot=np.diag([1.0, 2.0, 2.0]),
        center=np.zeros(3),
        interfaces=(Interface("tip", [0.25, 0, 0]),),
        kernel=sample_kernel(modes, 5e-4, GeneralizedAlpha(0.9), 100),
        modes=modes,
        compliance=modes.phi / modes.omega**2 @ modes.phi.T,
        accelerance=modes.phi @ modes.phi.T,
    )


def datasets(results_file: Path) -> dict[str, bytes]:
    """All numbers of a results file, to the last bit."""
    found: dict[str, bytes] = {}

    def take(name: str, item: h5py.Group | h5py.Dataset) -> None:
        if isinstance(item, h5py.Dataset):
            found[name] = repr(item[()].tolist()).encode()

    with h5py.File(results_file) as file:
        file.visititems(take)
    return found


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """hub.toml and the superelement it names in a folder of their own, as a study elsewhere finds
    them.
    """
    parts = tmp_path / "model" / "parts"
    parts.mkdir(parents=True)
    write(parts / "beam.h5", make_element(mass=2.0))
    (tmp_path / "model" / "hub.toml").write_text(MODEL)
    return tmp_path


@pytest.fixture
def study_file(folder: Path) -> Callable[..., Path]:
    def make(text: str = STUDY) -> Path:
        path = folder / "torques.toml"
        path.write_text(text)
        return path

    return make


@pytest.fixture
def line_mesh() -> Callable[[Path, int], None]:
    """A bar of 0.5 m along x."""

    def make(path: Path, elements: int) -> None:
        points = np.zeros((elements + 1, 3))
        points[:, 0] = np.linspace(0.0, 0.5, elements + 1)
        lines = np.stack([np.arange(elements), np.arange(1, elements + 1)], axis=1)
        tags = {
            "gmsh:physical": [np.ones(elements, int)],
            "gmsh:geometrical": [np.ones(elements, int)],
        }
        meshio.Mesh(points, [("line", lines)], cell_data=tags).write(
            path, file_format="gmsh22", binary=False
        )

    return make
