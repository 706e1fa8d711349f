"""`duhamel explain`."""

from duhamel.cli.app import app
from duhamel.cli.explain import ALL_CRITERIA
from typer.testing import CliRunner


def explained(*words):
    return CliRunner().invoke(app, ["explain", *words])


def test_a_criterion_is_explained_by_its_name():
    done = explained("axial_load")
    assert done.exit_code == 0
    assert done.output.startswith(
        "axial_load: axial force / Euler load\n  measures: the largest mean"
    )
    assert "recommended < 0.02, limit < 0.05, for each body" in done.output
    assert "[rotation]" in done.output


def test_or_by_words_of_its_row():
    done = explained("Time steps per period")
    assert "steps_per_period:" in done.output
    assert "motor_steps:" in done.output
    assert "recommended > 20, limit > 8" in done.output


def test_without_a_name_all_are_listed():
    assert len(explained().output.splitlines()) == len(ALL_CRITERIA)


def test_a_name_that_is_none_is_told_with_those_like_it():
    done = explained("axial load")
    assert done.exit_code == 1
    assert "error: no criterion 'axial load': did you mean axial_load" in done.output
