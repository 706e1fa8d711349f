"""`duhamel check`: a table of what holds, and the exit code."""

import re
import shutil
from dataclasses import replace
from pathlib import Path

import duhamel.cli
import h5py
import pytest
from duhamel.cli import app
from duhamel.superelement import Chain, sample_kernel, write


def test_a_sound_superelement_passes(runner, element_file):
    result = runner.invoke(app, ["check", str(element_file)])
    assert result.exit_code == 0, result.output
    last = result.stdout.splitlines()[-1]
    assert last == f"{element_file}: 22 checks hold"
    assert "NO" not in result.stdout
    for words in ("static/compliance", "passivity", "reciprocity", "no rigid motion"):
        assert words in result.stdout


def test_a_superelement_is_compared_with_a_static_solution_of_its_mesh(runner, tmp_path):
    """Beside its mesh, by itself; elsewhere, if told the body file. One of a stiffer body is not
    its own.
    """
    starter = Path(duhamel.cli.__file__).parent / "starters" / "solid-project"
    folder = tmp_path / "made"
    shutil.copytree(starter, folder)
    (body,) = (file for file in folder.glob("*.toml") if "[interfaces" in file.read_text())
    assert runner.invoke(app, ["preprocess", str(body)]).exit_code == 0
    file = body.with_suffix(".h5")
    beside = runner.invoke(app, ["check", str(file)])
    assert beside.exit_code == 0, beside.output
    assert "the static solution" in " ".join(beside.stdout.split())
    alone = shutil.copy(file, tmp_path / "alone.h5")
    result = runner.invoke(app, ["check", str(alone)])
    assert result.exit_code == 0
    assert "not compared with its mesh" in result.stdout
    assert runner.invoke(app, ["check", str(alone), "--body", str(body)]).exit_code == 0
    stiffer = folder / "stiffer.toml"
    stiffer.write_text(re.sub(r"(?m)^E = .*", "E = 2.2e11", body.read_text()))
    result = runner.invoke(app, ["check", str(alone), "--body", str(stiffer)])
    assert result.exit_code == 1
    assert "static/compliance: expected the static solution of the mesh, found" in result.stderr


def test_what_does_not_hold_is_a_line_each_and_the_exit_code_says_so(runner, element, tmp_path):
    g = element.kernel.g.copy()
    g[5, 2, 2] *= 1.001
    path = tmp_path / "damaged.h5"
    write(path, replace(element, kernel=replace(element.kernel, g=g)))
    result = runner.invoke(app, ["check", str(path)])
    assert result.exit_code == 1
    lines = result.stderr.splitlines()
    assert all(line.startswith(f"error: {path}: kernel/g: expected ") for line in lines)
    assert "at every lag what the modes give" in lines[0]
    assert "NO" in result.stdout


def test_a_file_that_readers_refuse_is_one_line(runner, element_file):
    with h5py.File(element_file, "r+") as file:
        file["rigid/mass"][()] = -1.0
    result = runner.invoke(app, ["check", str(element_file)])
    assert result.exit_code == 1
    assert result.stderr == f"error: {element_file}: mass: expected a positive number, found -1.0\n"


@pytest.mark.parametrize("name", ["beam.msh", "beam"])
def test_other_files_are_refused(runner, name, tmp_path):
    result = runner.invoke(app, ["check", str(tmp_path / name)])
    assert result.exit_code == 2
    words = " ".join(result.output.replace("│", " ").split())  # the path decides where lines end
    assert "expected a superelement" in words


MODEL = """
[simulation]
t_end = 0.01

[bodies.beam]
superelement = "beam.h5"
"""


def test_a_model_is_told_about_and_nothing_is_written(runner, element_file):
    path = element_file.with_name("flight.toml")
    path.write_text(MODEL)
    result = runner.invoke(app, ["check", str(path)])
    assert result.exit_code == 0, result.output
    lines = dict(line.split(": ", 1) for line in result.stdout.splitlines())
    assert lines["bodies"] == "1, of which 1 flexible"
    assert lines["steps"] == "20 of 0.0005 s"
    about = "linearized about the initial state, without damping, preload and spin"
    assert lines[f"natural frequencies, {about} [Hz]"].startswith("100, 200, 300")
    megabytes = float(re.search(r"([\d.e+]+) MB of memory in all", result.stdout)[1])
    assert 50.0 < megabytes < 50_000.0  # a process with numpy, and what tests before it took
    assert sorted(file.name for file in path.parent.iterdir()) == ["beam.h5", "flight.toml"]


def test_moduli_that_are_given_at_a_frequency_are_told_by_check_and_run(
    runner, element, element_file
):
    chain = Chain([1e-4, 1e-3], [0.02, 0.02], 0.03, (50.0, 2000.0), 316.2278, 0.0123)
    modes, kernel = replace(element.modes, chain=chain), element.kernel
    kernel = sample_kernel(modes, kernel.h, kernel.scheme, kernel.steps)
    write(element_file, replace(element, modes=modes, kernel=kernel))
    path = element_file.with_name("flight.toml")
    path.write_text(MODEL)
    line = "body 'beam': moduli given at 316 Hz; the static moduli are 1.6 % lower"
    for command in ("check", "run"):
        assert line in runner.invoke(app, [command, str(path)]).stdout.splitlines()


def test_a_model_that_a_run_would_refuse_is_refused(runner, element_file):
    path = element_file.with_name("flight.toml")
    path.write_text(MODEL.replace("t_end = 0.01", "t_end = 0.01\nhistory = 'quick'"))
    result = runner.invoke(app, ["check", str(path)])
    assert result.exit_code == 1
    assert result.stderr.startswith(f"error: {path}: simulation.history: ")
    assert result.stderr.count("\n") == 1


def test_what_looks_wrong_with_a_model_is_a_warning_of_check_and_of_run(runner, element_file):
    path = element_file.with_name("flight.toml")
    path.write_text(MODEL.replace("t_end = 0.01", "t_end = 0.01\ngravity = [0, 0, -9810]"))
    doubt = "simulation.gravity is 9810 m/s^2, on Earth it is 9.81: is it in mm/"
    for command, begin in (("check", f"warning: {path}: "), ("run", "warning: ")):
        result = runner.invoke(app, [command, str(path)])
        assert result.exit_code == 0, result.output
        assert any(line.startswith(begin + doubt) for line in result.stderr.splitlines())
