"""`duhamel tutorial`: the files of the page, and its commands where Gmsh is not installed."""

import re
import shlex

import pytest
from duhamel.cli import app
from duhamel.cli.starters import commands
from duhamel.results import Results, peaks
from import_order import ROOT

PAGE = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")
FILES = dict(re.findall(r'```\w+ title="([\w.]+)"\n(.*?)```', PAGE, flags=re.S))


@pytest.fixture
def folder(runner, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = runner.invoke(app, ["tutorial"])
    assert done.exit_code == 0, done.output
    assert "  duhamel run knock.toml" in done.stdout.splitlines()
    monkeypatch.chdir(tmp_path / "duhamel-tutorial")
    return tmp_path / "duhamel-tutorial"


@pytest.mark.parametrize("name", FILES)
def test_its_files_are_those_of_the_page(folder, name):
    written = (folder / name).read_text(encoding="utf-8")
    if name.endswith(".toml"):
        first, _, written = written.partition("\n")
        kind = "model" if name == "knock.toml" else "body"
        assert first == f"#:schema schemas/{kind}.json"
    assert written == FILES[name]


def test_its_commands_run_on_the_mesh_that_lies_in_it(folder, runner):
    for command in commands("tutorial"):
        done = runner.invoke(app, shlex.split(command)[1:])
        assert done.exit_code == 0, f"{command}: {done.output}"
    results = Results.read(folder / "knock-results.h5")
    (stress,) = peaks(results, ["von_mises:lever"])
    told = re.search(r"The largest stress is ([\d.]+) MPa", PAGE)
    assert told is not None
    assert stress.largest == pytest.approx(1e6 * float(told[1]), rel=0.01)


def test_a_folder_that_holds_something_is_refused(runner, tmp_path):
    (tmp_path / "mine").write_text("mine")
    done = runner.invoke(app, ["tutorial", str(tmp_path)])
    assert done.exit_code == 1
    assert [path.name for path in tmp_path.iterdir()] == ["mine"]
