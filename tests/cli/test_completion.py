"""What shells complete, as they ask for it."""

import pytest
from duhamel.cli import app
from duhamel.cli.completion import files


@pytest.fixture
def folder(tmp_path, monkeypatch):
    for name in ("model.toml", "mode.txt", "beam.h5", ".hidden.toml", "sub/deep/inner.toml"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    monkeypatch.chdir(tmp_path)
    return tmp_path


def completed(runner, *words):
    asked = {
        "_DUHAMEL_COMPLETE": "complete_bash",
        "COMP_WORDS": " ".join(("duhamel", *words)),
        "COMP_CWORD": str(len(words)),
    }
    return runner.invoke(app, [], env=asked, prog_name="duhamel").stdout.split()


def test_commands_are_completed(runner):
    assert completed(runner, "pre") == ["preprocess"]


def test_files_are_completed_by_the_suffix_that_a_command_reads(runner, folder):
    assert completed(runner, "run", "mo") == ["model.toml"]
    assert completed(runner, "info", "b") == ["beam.h5"]


@pytest.mark.parametrize("command", ["peaks", "animate", "report", "export"])
def test_results_are_completed_for_all_commands_that_read_them(runner, folder, command):
    assert completed(runner, command, "b") == ["beam.h5"]


@pytest.mark.parametrize("command", ["check", "modes", "frf", "campbell"])
def test_models_are_completed_for_all_commands_that_read_them(runner, folder, command):
    assert completed(runner, command, "mo") == ["model.toml"]


def test_starters_are_completed(runner):
    assert "solid" in completed(runner, "init", "so")


def test_folders_are_completed_and_the_only_one_is_entered(folder):
    assert files(".toml")("") == ["model.toml", "sub/"]
    assert files(".toml")("su") == ["sub/deep/inner.toml"]
    assert files(".toml")(f"{folder}/mo") == [f"{folder}/model.toml"]


def test_a_folder_that_is_not_there_has_nothing_to_complete(folder):
    assert files(".toml")("nowhere/a") == []
    assert files(".toml")("a\0b/c") == []


def test_completion_is_installed_by_an_option(runner):
    assert "--install-completion" in runner.invoke(app, ["--help"], env={"COLUMNS": "200"}).stdout
