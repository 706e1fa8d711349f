"""`duhamel report`."""

import re
from pathlib import Path

import pytest
from duhamel import view
from duhamel.cli import app

from ..results.disc import write_disc


@pytest.fixture
def results_file(tmp_path):
    return write_disc(tmp_path / "disc-results.h5")


def test_a_report_stands_beside_the_results_unless_told_otherwise(
    runner, results_file, monkeypatch
):
    asked = []

    def written(results, path, title, field, on_part):
        asked.append((results.name, path, title, field))
        Path(path).write_text("page")

    monkeypatch.setattr(view, "write_report", written)
    result = runner.invoke(app, ["report", str(results_file), "--field", "velocity"])
    page = results_file.with_suffix(".html")
    assert asked == [(str(results_file), page, "", "velocity")]
    assert re.fullmatch(rf"{re.escape(str(page))}: 0\.0 MB, \d+\.\d s\n", result.output)


def test_results_that_cannot_be_read_are_told_in_one_line(runner, tmp_path):
    result = runner.invoke(app, ["report", str(tmp_path / "none.h5")])
    assert result.exit_code == 1
    assert re.fullmatch(r"error: .*none\.h5.*\n", result.output)


def test_a_page_is_not_written_in_the_place_of_the_results(runner, results_file):
    before = results_file.read_bytes()
    results_file.with_suffix(".html").symlink_to(results_file)
    result = runner.invoke(app, ["report", str(results_file)])
    assert result.exit_code == 1
    assert "is the results file, which the report would replace" in result.output
    assert results_file.read_bytes() == before


def test_an_unknown_field_is_refused(runner, results_file):
    result = runner.invoke(app, ["report", str(results_file), "--field", "heat"])
    assert result.exit_code == 2
    assert "von_mises" in result.output
