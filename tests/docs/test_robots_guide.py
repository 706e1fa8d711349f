"""The guide to robots leads from a URDF to a flexible arm, by the commands that it shows."""

from pathlib import Path

import pytest
from duhamel.results import Results, peaks

from .walk import walk


@pytest.fixture(scope="module")
def walked(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[str]]:
    """The folder of the guide, and lines of the page that were not printed."""
    pytest.importorskip("gmsh")
    folder = tmp_path_factory.mktemp("robots")
    return folder, walk("how-to/robots.md", folder)


def test_the_guide_goes_as_it_is_written(walked: tuple[Path, list[str]]) -> None:
    folder, missing = walked
    assert missing == []
    assert (folder / "arm.png").stat().st_size


def test_the_forearm_bends_as_far_as_the_guide_says(walked: tuple[Path, list[str]]) -> None:
    run = Results.read(walked[0] / "arm-moves-results.h5")
    (bent,) = peaks(run, ("displacement:fore.tip:fore.root:z",))
    assert -bent.smallest == pytest.approx(0.42e-3, rel=0.02)


def test_both_arms_end_where_the_servos_lead_them(walked: tuple[Path, list[str]]) -> None:
    ends = {"shoulder": -0.6, "elbow": 1.4, "wrist": 1.0}
    for name in ("rigid", "arm"):
        run = Results.read(walked[0] / f"{name}-moves-results.h5")
        for joint, end in ends.items():
            # Without an integral gain the servos sag by their torque over 900 N m/rad.
            assert run.joint(joint).angle[-1] == pytest.approx(end, abs=0.01)
