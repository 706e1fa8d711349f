"""The demonstration: files of a project, its results, a page and a film."""

import pytest
from duhamel.cli import app
from duhamel.cli.commands import demo
from duhamel.results import Results
from typer.testing import CliRunner

PROJECT = {"README.md", "model.toml", "rod.msh", "rod.toml", "schemas"}


def test_a_demonstration_goes_from_a_mesh_to_a_film(tmp_path):
    folder = tmp_path / "my demo"
    done = CliRunner().invoke(app, ["demo", str(folder)])
    assert done.exit_code == 0, done.output
    made = {"rod.h5", "model-results.h5", "model-results.html", "film.mp4"}
    assert {path.name for path in folder.iterdir()} == PROJECT | made
    assert all((folder / name).stat().st_size > 10_000 for name in made)
    results = Results.read(folder / "model-results.h5")
    # The crank runs up to 3000 revolutions a minute.
    assert results.body("crank").angular_velocity[-1, 2] == pytest.approx(314.159, rel=1e-6)
    assert results.validity.summary in done.output.splitlines()
    assert done.output.splitlines()[-1].startswith("next: change")
    again = CliRunner().invoke(app, ["demo", str(folder)])
    assert again.exit_code == 1
    assert "expected a new or an empty folder" in again.output


def test_without_libraries_of_films_there_is_the_motion(tmp_path, monkeypatch):
    monkeypatch.setattr(demo, "find_spec", lambda _: None)
    done = CliRunner().invoke(app, ["demo", str(tmp_path / "demo")])
    assert done.exit_code == 0, done.output
    assert "pip install 'duhamel[view,report]'" in done.output
    made = {path.name for path in (tmp_path / "demo").iterdir()}
    assert made == PROJECT | {"rod.h5", "model-results.h5"}
