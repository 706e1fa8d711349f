"""The tutorial leads to a film: its files, commands and numbers are what the page shows."""

import re
from pathlib import Path

import numpy as np
import pytest
from duhamel.results import Peak, Results, peaks
from import_order import ROOT

from .walk import agree, commands, walk

PAGE = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def walked(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[str]]:
    """The folder of the tutorial, and lines of the page that were not printed."""
    pytest.importorskip("gmsh")
    folder = tmp_path_factory.mktemp("tutorial")
    return folder, walk("tutorial.md", folder)


@pytest.fixture(scope="module")
def knock(walked: tuple[Path, list[str]]) -> Results:
    return Results.read(walked[0] / "knock-results.h5")


@pytest.fixture(scope="module")
def stress(knock: Results) -> Peak:
    return peaks(knock, ("von_mises:lever",))[0]


def test_the_tutorial_goes_as_it_is_written(walked: tuple[Path, list[str]]) -> None:
    assert walked[1] == []


@pytest.mark.parametrize(
    ("text", "quantity", "scale"),
    [
        ("bends the lever by # um", "displacement:lever.eye:lever.bore:y", 1e-6),
        ("since # um would not be", "displacement:lever.eye:lever.bore:y", 1e-6),
        ("The pivot feels # N", "force:pivot", 1.0),
    ],
)
def test_largest_values_in_the_text_are_those_of_the_run(
    knock: Results, text: str, quantity: str, scale: float
) -> None:
    largest = peaks(knock, (quantity,))[0].largest
    assert told(text) * scale == pytest.approx(largest, rel=0.01)


def test_the_largest_stress_and_its_time_are_those_of_the_text(stress: Peak) -> None:
    assert told("The largest stress is # MPa") * 1e6 == pytest.approx(stress.largest, rel=0.01)
    since = stress.at_largest - 1e-3
    assert told("MPa, # ms into the blow") * 1e-3 == pytest.approx(since, rel=0.01)


def test_the_lever_rings_and_swings_as_the_text_says(knock: Results) -> None:
    after = knock.time > 4e-3
    bent = knock.frame("lever.eye").u[after, 1] - knock.frame("lever.bore").u[after, 1]
    loudest = np.abs(np.fft.rfft(np.diff(bent, 2))).argmax()
    ringing = loudest / (len(bent) * 1e-5)
    assert told("rings at # kHz") * 1e3 == pytest.approx(ringing, rel=0.02)
    assert told("swings at # Hz") == pytest.approx(told("[Hz]: #,"), rel=0.01)


def told(text: str) -> float:
    """The number of the page that stands for # in a text."""
    pattern = re.escape(text).replace(r"\#", r"([\d.]+)").replace(r"\ ", r"\s+")
    found = re.search(pattern, PAGE)
    assert found is not None, text
    return float(found[1])


def test_lines_below_a_command_are_what_it_prints() -> None:
    text = "$ duhamel run a.toml\n...\na: 3 steps\n$ duhamel plot a.h5\n"
    assert commands(text) == [("duhamel run a.toml", ["a: 3 steps"]), ("duhamel plot a.h5", [])]


def test_words_of_a_line_are_the_same_and_numbers_close() -> None:
    assert agree("mass  0.22 kg", "mass 0.2208 kg")
    assert not agree("mass 0.22 kg", "mass 0.23 kg")
    assert not agree("mass 0.22 kg", "length 0.22 kg")
    assert agree("rows: 3 of ...", "rows: 3 of 4, 5")
    assert not agree("rows: 2 of ...", "rows: 3 of 4, 5")


def test_times_and_sizes_of_files_may_be_others() -> None:
    assert agree("a.h5: 3 steps, 1.5 s in all, 13.8 MB", "a.h5: 3 steps, 4.2 s in all, 9 MB")
