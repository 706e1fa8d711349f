"""The guide to a robot arm leads from meshes to a film, by the commands that it shows."""

from pathlib import Path

import numpy as np
import pytest
from duhamel.results import Results, peaks

from .walk import walk


@pytest.fixture(scope="module")
def walked(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[str]]:
    """The folder of the guide, and lines of the page that were not printed."""
    pytest.importorskip("gmsh")
    folder = tmp_path_factory.mktemp("robot")
    return folder, walk("how-to/robot-arm.md", folder)


def test_the_guide_goes_as_it_is_written(walked: tuple[Path, list[str]]) -> None:
    folder, missing = walked
    assert missing == []
    assert all((folder / name).stat().st_size for name in ("robot.png", "robot.gif", "moving.png"))


def test_gears_keep_their_ratios_and_the_arm_rests_before_it_moves(
    walked: tuple[Path, list[str]],
) -> None:
    run = Results.read(walked[0] / "robot-results.h5")
    for axis, ratio in (("shoulder", 100.0), ("elbow", 80.0)):
        shaft, link = run.joint(f"{axis} shaft").angle, run.joint(axis).angle
        np.testing.assert_allclose(shaft, ratio * link, rtol=0, atol=1e-9)
    before = run.time < 0.1
    assert np.abs(run.body("payload").v[before]).max() < 1e-6


def test_the_upper_link_bends_as_far_as_the_guide_says(walked: tuple[Path, list[str]]) -> None:
    run = Results.read(walked[0] / "robot-results.h5")
    (bent,) = peaks(run, ("displacement:upper.tip:upper.root:y",))
    assert -bent.smallest == pytest.approx(3.4e-3, rel=0.02)
