"""The recipes of docs/extending.md, applied to a copy of the sources and tried."""

from pathlib import Path

import pytest

from .recipes import TRIAL, blocks, extended_copy, run

TRIALS = {block.heading: block.code for block in blocks() if block.first == TRIAL}


@pytest.fixture(scope="module")
def extended(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return extended_copy(tmp_path_factory.mktemp("extended"))


@pytest.mark.parametrize("recipe", TRIALS)
def test_a_recipe_gives_right_numbers(recipe, extended, tmp_path):
    assert run(TRIALS[recipe], extended, tmp_path) == ""


def test_every_recipe_is_tried():
    assert set(TRIALS) == {block.heading for block in blocks()}


def test_a_wrong_number_is_seen(extended, tmp_path):
    wrong = TRIALS["A joint"].replace("== 3", "== 4")
    assert "AssertionError" in run(wrong, extended, tmp_path)
