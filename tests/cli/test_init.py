"""`duhamel init`: each starter project runs by the commands of its README; where none is made."""

import json
import shlex

import pytest
from duhamel.cli import app
from duhamel.cli.starters import StarterError, commands, make
from duhamel.inputs import read_toml
from jsonschema import Draft7Validator

STARTERS = "beam", "solid", "mechanism"


@pytest.mark.parametrize("kind", STARTERS)
def test_a_starter_project_runs_by_the_commands_of_its_readme(kind, runner, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = runner.invoke(app, ["init", kind])
    assert made.exit_code == 0, made.output
    monkeypatch.chdir(kind)
    for command in commands(kind):
        done = runner.invoke(app, shlex.split(command)[1:])
        assert done.exit_code == 0, f"{command}: {done.output}"
        assert "warning" not in done.output
    assert (tmp_path / kind / "model-results.png").stat().st_size > 10_000


@pytest.mark.parametrize("kind", STARTERS)
def test_the_files_of_a_project_name_schemas_that_lie_in_it_and_that_they_keep(
    kind, runner, tmp_path
):
    runner.invoke(app, ["init", kind, str(tmp_path)])
    for path in tmp_path.glob("*.toml"):
        first = path.read_text().partition("\n")[0]
        schema = tmp_path / first.removeprefix("#:schema ")
        assert Draft7Validator(json.loads(schema.read_text())).is_valid(read_toml(path))


def test_the_next_commands_are_told(runner, tmp_path):
    result = runner.invoke(app, ["init", "beam", str(tmp_path / "my arm")])
    assert result.stdout.splitlines()[1:] == [
        f"  cd '{tmp_path}/my arm'",
        "  duhamel preprocess arm.toml",
        "  duhamel run model.toml",
        "  duhamel plot model-results.h5",
    ]


def test_a_folder_that_is_not_empty_is_refused_and_left_as_it_is(runner, tmp_path):
    (tmp_path / "model.toml").write_text("mine")
    result = runner.invoke(app, ["init", "beam", str(tmp_path)])
    expected = f"error: {tmp_path}: expected a new or an empty folder: nothing is replaced\n"
    assert (result.exit_code, result.stderr) == (1, expected)
    assert [path.name for path in tmp_path.iterdir()] == ["model.toml"]


def test_a_file_is_no_folder_for_a_project(runner, tmp_path):
    (tmp_path / "file").write_text("mine")
    result = runner.invoke(app, ["init", "beam", str(tmp_path / "file")])
    assert (result.exit_code, (tmp_path / "file").read_text()) == (1, "mine")


def test_what_was_written_is_removed_when_the_disk_is_full(tmp_path, monkeypatch):
    written = []

    def full(path, content):
        if len(written) == 3:
            raise OSError(28, "No space left on device")
        written.append(path)
        path.touch()

    monkeypatch.setattr("pathlib.Path.write_bytes", full)
    with pytest.raises(StarterError, match="new: no project can be written: No space left"):
        make("beam", tmp_path / "a" / "new", {"body": {}, "model": {}})
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_starter_lists_those_that_there_are(runner):
    result = runner.invoke(app, ["init", "frame"])
    assert result.exit_code == 2
    assert all(kind in result.stderr for kind in STARTERS)
