"""The page of the twelve keys goes as it is written, from a mesh to a study."""

import csv

import numpy as np
import pytest
import skfem

from .walk import blocks, walk


@pytest.fixture(scope="module")
def walked(tmp_path_factory):
    folder = tmp_path_factory.mktemp("keys")
    sides = [np.linspace(0.0, length, n) for length, n in ((0.5, 21), (0.03, 3), (0.03, 3))]
    skfem.MeshHex.init_tensor(*sides).save(folder / "arm.msh")
    return folder, walk("keys.md", folder)


def test_every_command_prints_what_is_shown(walked):
    assert walked[1] == []


def test_the_cases_of_the_study_are_proportional_to_the_blow(walked):
    with (walked[0] / "out" / "summary.csv").open() as file:
        rows = list(csv.DictReader(file))
    blows = [float(row["loads.0.signal.half_sine"]) for row in rows]
    assert blows == [100.0, 200.0, 400.0]
    pins = [float(row["pin"]) for row in rows]
    # Beside the weight of the arm, which is a few newtons.
    assert np.diff(pins) / np.diff(blows) == pytest.approx(
        [(pins[1] - pins[0]) / 100.0] * 2, rel=0.05
    )


def test_the_page_counts_its_keys():
    text = "\n".join(block.text for block in blocks("keys.md") if block.title)
    assert [n for n in range(1, 14) if f"# {n}." in text] == list(range(1, 13))
