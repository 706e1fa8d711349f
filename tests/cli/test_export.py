"""`duhamel export`: what it writes where, what it says, and what it refuses."""

import csv
import resource
import subprocess
import sys

import h5py
import pytest
import scipy.io
from duhamel.cli import app
from duhamel.solver import FlexibleBody, Model, RigidBody, Settings, Start, simulate


@pytest.fixture
def results_file(element, tmp_path):
    """A body made by hand and a rigid one with a name that is hard on files, in steady motion."""
    target = tmp_path / "flight-results.h5"
    start = Start(velocity=[2.0, 0.0, 0.0])
    bodies = {
        "beam": FlexibleBody(element, start),
        "a b<script>": RigidBody(1.0, [1.0, 1.0, 1.0], start=start),
    }
    simulate(Model(bodies, settings=Settings(t_end=0.3)), output=target)
    return target


def export(runner, file, *arguments):
    result = runner.invoke(app, ["export", str(file), str(file.parent / "out"), *arguments])
    assert result.exit_code == 0, result.output
    return result.stdout.splitlines()


def test_paraview_gets_frames_evenly_and_is_told_of_it(runner, results_file, tmp_path):
    first, *files, last = export(runner, results_file)
    assert first == "200 of 601 steps, evenly over time: --frames or --all for more"
    out = tmp_path / "out"
    assert [line.partition(":")[0] for line in files] == [
        str(out / "flight-results.vtkhdf"),
        str(out / "flight-results-points.vtkhdf"),
        str(out / "flight-results-names.csv"),
    ]
    assert last.startswith("3 files, ")
    assert steps_of(out / "flight-results.vtkhdf") == 200


def steps_of(path):
    with h5py.File(path) as file:
        return int(file["VTKHDF/Steps"].attrs["NSteps"])


@pytest.mark.parametrize(
    ("arguments", "steps"),
    [
        (["--frames", "7"], 7),
        (["--all"], 601),
        (["--from", "0.1", "--until", "0.1025"], 6),
        (["--frames", "1"], 1),
    ],
)
def test_steps_are_those_that_were_asked_for(runner, results_file, tmp_path, arguments, steps):
    export(runner, results_file, "--to", "vtk", *arguments)
    assert steps_of(tmp_path / "out" / "flight-results.vtkhdf") == steps


def test_tables_and_matlab_files_go_into_the_folder(runner, results_file, tmp_path):
    export(runner, results_file, "--to", "csv", "velocity:*:x", "--until", "0.01")
    with (tmp_path / "out" / "quantities.csv").open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    assert header[:3] == ["time [s]", "velocity:beam:x [m/s]", "velocity:a b<script>:x [m/s]"]
    assert len(rows) == 21
    export(runner, results_file, "--to", "mat")
    found = scipy.io.loadmat(tmp_path / "out" / "flight-results.mat", simplify_cells=True)
    assert found["bodies"]["a_b_script_"]["name"] == "a b<script>"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--to", "csv", "speed:beam"], "error: speed:beam: no quantity 'speed'; there are: "),
        (["--from", "5"], "error: nothing was recorded from 5 to 0.3 s: expected times from 0 to"),
        (["--to", "vtk", "velocity:beam"], "quantities go with --to csv, found --to vtk"),
        (["--to", "mat", "--frames", "5"], "go with --to vtk, found --to mat"),
        (["--to", "abaqus", "--until", "0.1"], "--from and --until go with --to vtk, csv or mat"),
        (
            ["--to", "stl"],
            "--to: expected one of vtk, csv, mat, abaqus, nastran, craig-bampton, sid, found 'stl'",
        ),
        (["--all", "--frames", "5"], "expected one of --frames and --all"),
        (["--magnify", "nan"], "--magnify: expected a number, found nan"),
    ],
)
def test_what_cannot_be_done_is_refused(runner, results_file, tmp_path, arguments, message):
    out = tmp_path / "out"
    result = runner.invoke(app, ["export", str(results_file), str(out), *arguments])
    assert result.exit_code in (1, 2)
    assert message in " ".join(result.stderr.replace("│", "").split())
    assert not out.exists() or not list(out.iterdir())


def test_the_results_themselves_are_never_replaced(runner, results_file):
    """By a link from the name of the output."""
    before = results_file.read_bytes()
    link = results_file.with_name("flight-results.mat")
    link.symlink_to(results_file)
    folder = str(results_file.parent)
    result = runner.invoke(app, ["export", str(results_file), folder, "--to", "mat"])
    assert result.exit_code == 1
    assert "flight-results.mat is the input" in result.stderr
    assert results_file.read_bytes() == before


def test_a_folder_in_the_place_of_a_file_is_one_line(runner, results_file, tmp_path):
    (tmp_path / "file").touch()
    result = runner.invoke(app, ["export", str(results_file), str(tmp_path / "file" / "in")])
    assert result.exit_code == 1
    assert result.stderr.count("\n") == 1
    assert "cannot be made a folder" in result.stderr


def test_what_a_killed_export_left_is_removed_by_the_next(runner, results_file, tmp_path):
    """Hundreds of megabytes of a film of a large part."""
    folder = tmp_path / "out"
    folder.mkdir()
    killed = (
        "import os, signal, sys\nfrom pathlib import Path\n"
        "from duhamel.results.exports.folder import exported\n"
        f"with exported({str(folder)!r}) as export, export.file('whole.csv') as file:\n"
        "    Path(file).write_text('half')\n"
        "    os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    subprocess.run([sys.executable, "-c", killed], check=False)
    assert len(list(folder.rglob("whole.csv"))) == 1
    result = runner.invoke(app, ["export", str(results_file), str(folder), "--to", "mat"])
    assert result.exit_code == 0
    assert [path.name for path in folder.iterdir()] == ["flight-results.mat"]


@pytest.mark.parametrize(
    ("to", "name"),
    [("vtk", "flight-results.vtkhdf"), ("csv", "bodies.csv"), ("mat", "flight-results.mat")],
)
def test_a_full_disk_names_the_file_and_leaves_nothing(runner, results_file, tmp_path, to, name):
    """A limit of the size of files stands for it."""
    folder, limits = tmp_path / "out" / "of", resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, limits[1]))
    try:
        result = runner.invoke(app, ["export", str(results_file), str(folder), "--to", to])
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert result.exit_code == 1
    assert result.stderr == f"error: {folder / name}: cannot be written: File too large\n"
    assert not (tmp_path / "out").exists()
