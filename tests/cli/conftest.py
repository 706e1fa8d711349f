"""Superelements made by hand, as files."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from duhamel.superelement import (
    GeneralizedAlpha,
    Interface,
    Modes,
    Provenance,
    Superelement,
    sample_kernel,
    write,
)
from typer.testing import CliRunner


@pytest.fixture
def runner() -> CliRunner:
    return CliRunner()


@pytest.fixture
def element() -> Superelement:
    rng = np.random.default_rng(0)
    frequencies = 100.0 * np.arange(1, 13)
    modes = Modes(2 * np.pi * frequencies, np.full(12, 0.01), rng.normal(size=(9, 12)))
    return Superelement(
        name="beam",
        mass=0.0429,
        J_rot=[[3.0, 1.0, 0.0], [1.0, 3.0, 0.0], [0.0, 0.0, 5.5]],
        center=[0.25, 0.0, 0.0],
        interfaces=(
            Interface("root", [-0.25, 0, 0]),
            Interface("tip", [0.25, 0, 0], rotations=False),
        ),
        kernel=sample_kernel(modes, 5e-4, GeneralizedAlpha(0.8), 40, error=3e-9),
        modes=modes,
        compliance=modes.phi / modes.omega**2 @ modes.phi.T,
        accelerance=modes.phi @ modes.phi.T,
        provenance=Provenance(
            body='name = "beam"\n',
            mesh="beam.msh",
            mesh_sha256="0123456789abcdef" * 4,
            method="modal",
            tolerance=1e-8,
            versions={"numpy": "2.4.6"},
            timings={"modes": 0.25},
        ),
    )


@pytest.fixture
def element_file(element: Superelement, tmp_path: Path) -> Path:
    write(tmp_path / "beam.h5", element)
    return tmp_path / "beam.h5"


@pytest.fixture
def measured_file(element: Superelement, tmp_path: Path) -> Path:
    """A body without modes."""
    write(tmp_path / "measured.h5", replace(element, modes=None))
    return tmp_path / "measured.h5"
