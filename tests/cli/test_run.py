"""`duhamel run`: where the results go, what is printed, what is loaded, and how it fails."""

import re
import subprocess
import sys

import h5py
import numpy as np
import pytest
from duhamel.cli import app
from duhamel.cli.commands.run import _watched
from duhamel.solver import ModelError, read_model
from duhamel.solver.control import RUN_CONTROL
from duhamel.superelement import read

MODEL = """
[simulation]
t_end = 0.01

[bodies.beam]
superelement = "beam.h5"
velocity = [2.0, 0.0, 0.0]
"""


@pytest.fixture
def model_file(element_file):
    """A free body made by hand, in steady motion."""
    path = element_file.with_name("flight.toml")
    path.write_text(MODEL)
    return path


def test_a_run_that_is_watched_controls_no_later_one(model_file):
    pytest.importorskip("plotly")
    model = read_model(model_file)

    def watch():
        with _watched(model, model_file.with_suffix(".h5")):
            assert RUN_CONTROL.get() is not None
            raise ModelError("of the run")

    with pytest.raises(ModelError, match="of the run"):
        watch()
    assert RUN_CONTROL.get() is None


def test_the_results_stand_beside_the_model_file(runner, model_file):
    result = runner.invoke(app, ["run", str(model_file)])
    target = model_file.with_name("flight-results.h5")
    assert result.exit_code == 0, result.output
    last = result.stdout.splitlines()[-1]
    assert re.fullmatch(rf"{target}: 20 steps, [\d.]+ s in all, [\d.]+ us per step", last)
    with h5py.File(target) as file:
        np.testing.assert_allclose(
            file["body_position"][:, 0, 0], 2.0 * file["time"][:], rtol=0, atol=1e-13
        )


def test_a_run_without_steps_has_no_time_per_step(runner, model_file):
    model_file.write_text(MODEL.replace("t_end = 0.01", "t_end = 1e-60"))
    result = runner.invoke(app, ["run", str(model_file)])
    assert result.exit_code == 0, result.output
    last = result.stdout.splitlines()[-1]
    target = model_file.with_name("flight-results.h5")
    assert re.fullmatch(rf"{target}: 0 steps, [\d.]+ s in all", last)


def test_the_momentum_at_the_end_is_told(runner, model_file, element_file):
    result = runner.invoke(app, ["run", str(model_file)])
    mass = read(element_file).mass
    line = (
        f"momentum at the end [kg m/s]: ({2 * mass:.4g}, 0, 0); "
        "angular, about the origin [kg m^2/s]: (0, 0, 0)"
    )
    assert line in result.stdout.splitlines()


def test_the_results_go_where_they_are_sent(runner, model_file):
    target = model_file.with_name("elsewhere.h5")
    result = runner.invoke(app, ["run", str(model_file), "-o", str(target)])
    assert result.exit_code == 0, result.output
    assert sorted(path.name for path in model_file.parent.glob("*.h5")) == [
        "beam.h5",
        "elsewhere.h5",
    ]


def test_a_run_loads_nothing_that_only_meshes_and_plots_need(model_file):
    program = (
        "import sys\n"
        "from duhamel.cli import app\n"
        "app(['run', sys.argv[1]], standalone_mode=False)\n"
        "absent = {'skfem', 'meshio', 'matplotlib', 'duhamel.preprocess'}\n"
        "print(sorted(absent & set(sys.modules)))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program, model_file], capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines()[-1] == "[]"


@pytest.mark.parametrize("name", ["flight.toml", "beam.h5"])
def test_a_missing_file_is_one_line_on_stderr_and_nothing_is_written(name, runner, model_file):
    missing = model_file.with_name(name)
    missing.unlink()
    result = runner.invoke(app, ["run", str(model_file)])
    assert result.exit_code == 1
    assert result.stderr.startswith("error: ")
    assert str(missing) in result.stderr
    assert result.stderr.count("\n") == 1
    assert list(model_file.parent.glob("*-results.h5")) == []


def test_another_step_for_a_body_without_modes_is_one_line_on_stderr(
    runner, model_file, measured_file
):
    model_file.write_text(
        MODEL.replace("beam.h5", measured_file.name).replace("t_end", "step = 1e-4\nt_end")
    )
    result = runner.invoke(app, ["run", str(model_file)])
    assert result.exit_code == 1
    assert "no modes, so the kernel is fixed: h = 0.0005 s" in result.stderr
    assert "Traceback" not in result.stderr


RIGID = """
[simulation]
t_end = 0.01
STEP

[bodies.stone]
mass = 1.0
inertia = [1, 1, 1]
frames.edge = {position = [0.5, 0, 0]}
"""
COILED = """
[[springs]]
name = "coil"
type = "point"
between = ["ground.hook", "stone"]

[ground]
frames.hook = {}
"""
FAST = """
[[joints]]
name = "top"
type = "spherical"
between = ["ground", "stone.edge"]

[[loads]]
type = "torque"
on = "stone"
direction = [1, 2, 3]
signal = 1e9
"""


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (RIGID.replace("STEP", ""), "simulation: step: required in a model without superelements"),
        (
            RIGID.replace("STEP", "step = 1e-3") + COILED,
            "spring 'coil': its ends ['ground.hook', 'stone'] coincide",
        ),
        (
            RIGID.replace("STEP", "step = 1e-2\nmax_iterations = 1") + FAST,
            "no convergence in step 1 (t = 0.01 s): ",
        ),
        (
            RIGID.replace("STEP", "stop = 1e-3"),
            "simulation: unknown key 'stop'; did you mean 'step'?",
        ),
    ],
)
def test_every_error_of_a_model_names_its_file_once(runner, tmp_path, text, message):
    path = tmp_path / "stone.toml"
    path.write_text(text)
    result = runner.invoke(app, ["run", str(path)])
    assert result.exit_code == 1
    assert result.stderr.startswith(f"error: {path}: {message}")
    assert result.stderr.count(str(path)) == 1


def test_an_interrupt_before_the_first_step_says_so(runner, model_file, monkeypatch):
    def interrupt(path):
        raise KeyboardInterrupt

    monkeypatch.setattr("duhamel.solver.read_model", interrupt)
    result = runner.invoke(app, ["run", str(model_file)])
    target = model_file.with_name("flight-results.h5")
    told = f"interrupted before the first step; {target} is not written\n"
    assert (result.exit_code, result.stderr) == (130, told)
