"""The tutorial leads to a film: its files and commands do what the page shows."""

from pathlib import Path

import pytest

from .walk import commands, shape, walk


def test_the_tutorial_goes_as_it_is_written(tmp_path: Path) -> None:
    pytest.importorskip("gmsh")
    assert walk("tutorial.md", tmp_path) == []


def test_lines_below_a_command_are_what_it_prints() -> None:
    text = "$ duhamel run a.toml\n...\na: 3 steps\n$ duhamel plot a.h5\n"
    assert commands(text) == [("duhamel run a.toml", ["a: 3 steps"]), ("duhamel plot a.h5", [])]


def test_numbers_of_a_line_may_be_others_words_not() -> None:
    assert shape("mass  0.22 kg") == shape("mass 1.5e-3 kg")
    assert shape("mass 0.22 kg") != shape("length 0.22 kg")
