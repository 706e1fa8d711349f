"""The guide to a hammer test leads from a plan to a mechanism, by the commands that it shows."""

import csv
from pathlib import Path

import numpy as np
import pytest
from duhamel import superelement
from duhamel.results import Results

from .walk import walk

pytestmark = pytest.mark.validation


@pytest.fixture(scope="module")
def walked(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[str]]:
    """The folder of the guide, and lines of the page that were not printed."""
    folder = tmp_path_factory.mktemp("bench")
    return folder, walk("how-to/hammer-test.md", folder)


def test_the_guide_goes_as_it_is_written(walked: tuple[Path, list[str]]) -> None:
    folder, missing = walked
    assert missing == []
    assert (folder / "test" / "tested.png").stat().st_size


def test_modes_are_those_of_the_mesh_as_the_guide_says(walked: tuple[Path, list[str]]) -> None:
    folder, _ = walked
    tested, mesh = (
        superelement.read(folder / name).modes for name in ("test/tested.h5", "angle.h5")
    )
    assert tested is not None
    assert mesh is not None
    own = np.sort(mesh.frequencies)[:14]
    assert own[-1] < 7000.0 < np.sort(mesh.frequencies)[14]
    nearest = np.abs(tested.frequencies[:, None] - own).argmin(axis=0)
    np.testing.assert_allclose(tested.frequencies[nearest], own, rtol=1e-4)
    np.testing.assert_allclose(tested.zeta[nearest], 0.008, rtol=5e-3)


def test_forces_scatter_as_the_guide_says(walked: tuple[Path, list[str]]) -> None:
    folder, _ = walked
    run = Results.read(folder / "blow-results.h5")
    bearing = np.linalg.norm(run.joint("hinge").force, axis=1).max()
    with (folder / "blows" / "summary.csv").open() as file:
        rows = list(csv.DictReader(file))
    forces = [float(row["force"]) for row in rows]
    bearings = [float(row["bearing"]) for row in rows]
    np.testing.assert_allclose(forces, [664.5, 662.0, 662.7], rtol=1e-3)
    np.testing.assert_allclose(bearings, [549.3, 548.3, 553.3], rtol=5e-3)
    assert bearing == pytest.approx(552.0, rel=2e-3)
    np.testing.assert_allclose(bearings, bearing, rtol=0.02)
