"""The guide to CAD files leads from STEP to a superelement, by the commands that it shows."""

from math import pi
from pathlib import Path

import pytest
from duhamel import superelement

from .walk import walk


def test_the_guide_goes_as_it_is_written(tmp_path: Path) -> None:
    pytest.importorskip("gmsh")
    assert walk("how-to/cad.md", tmp_path) == []
    area = 0.12 * 0.03 + pi * (0.015**2 - 0.008**2 - 0.005**2)
    lever = superelement.read(tmp_path / "lever.h5")
    assert lever.mass == pytest.approx(2700.0 * 0.01 * area, rel=2e-5)
    assert (tmp_path / "lever.png").stat().st_size
