"""Results: the file, what a run that breaks off leaves in it, and plain Python against compiled
code.
"""

import hashlib
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from duhamel.results.journal import JournaledFile
from duhamel.solver import (
    Constant,
    ConvergenceError,
    Function,
    Results,
    ResultsError,
    read_model,
    simulate,
    start,
)
from duhamel.superelement import write

MODEL = """
[simulation]
t_end = 0.01
step = 2e-4

[bodies.hub]
mass = 0.01
inertia = [0.0095, 0.0095, 0.019]
frames.rim = {position = [0.05, 0, 0]}

[bodies.beam]
superelement = "beam.h5"
place = {frame = "root", on = "hub.rim"}

[[joints]]
name = "pivot"
type = "revolute"
between = ["ground", "hub"]
axis = [0, 0, 1]

[[joints]]
name = "clamp"
type = "fixed"
between = ["hub.rim", "beam.root"]

[[springs]]
name = "tether"
type = "point"
between = ["ground.hook", "beam.tip"]
stiffness = 2
damping = 0.01

[ground.frames]
hook = {position = [0.6, 0.2, 0]}

[[loads]]
type = "torque"
on = "hub"
direction = [0, 0, 1]
signal = {times = [0, 0.005], values = [1, -1]}
"""
N, H = 51, 2e-4


@pytest.fixture(scope="module")
def model_file(coarse, tmp_path_factory):
    folder = tmp_path_factory.mktemp("model")
    write(folder / "beam.h5", coarse)
    (folder / "rotor.toml").write_text(MODEL)
    return folder / "rotor.toml"


@pytest.fixture(scope="module")
def results_file(model_file):
    path = model_file.with_name("rotor-results.h5")
    simulate(read_model(model_file), output=path)
    return path


VECTORS = {
    "body_position": "m",
    "body_velocity": "m s-1",
    "body_angular_velocity": "rad s-1",
    "body_acceleration": "m s-2",
    "body_angular_acceleration": "rad s-2",
    "frame_position": "m",
    "frame_velocity": "m s-1",
    "frame_angular_velocity": "rad s-1",
    "frame_acceleration": "m s-2",
    "frame_angular_acceleration": "rad s-2",
    "frame_elastic_displacement": "m",
    "frame_elastic_rotation": "rad",
    "frame_force": "N",
    "frame_moment": "N m",
    "joint_force": "N",
    "joint_moment": "N m",
    "spring_force": "N",
    "spring_moment": "N m",
}
COUNTS = {"body": 2, "frame": 3, "joint": 2, "spring": 1}
SCALARS = {
    **dict.fromkeys(
        (
            *(f"{name}_energy" for name in ("kinetic", "elastic", "spring", "potential")),
            "numerical_dissipation",
            "external_work",
            "dissipated_energy",
            "energy_balance",
        ),
        "J",
    ),
    "time": "s",
    "newton_iterations": "1",
    "newton_residual": "1",
}
VARIABLES = {
    **{name: ((N, COUNTS[name.partition("_")[0]], 3), unit) for name, unit in VECTORS.items()},
    "body_rotation": ((N, 2, 4), "1"),
    "frame_rotation": ((N, 3, 4), "1"),
    **{name: ((N,), unit) for name, unit in SCALARS.items()},
    "linear_momentum": ((N, 3), "kg m s-1"),
    "angular_momentum": ((N, 3), "kg m2 s-1"),
    "joint_multiplier": ((N, 11), None),
    "joint_position": ((N, 1), "rad"),
    "joint_rate": ((N, 1), "rad s-1"),
    "spring_multiplier": ((N, 1), "N"),
    "spring_coordinate": ((N, 1), "m"),
    "spring_permanent": ((N, 1), "m"),
}
LABELS = {
    "body": ["hub", "beam"],
    "frame": ["hub.rim", "beam.root", "beam.tip"],
    "joint": ["pivot", "clamp"],
    "joint_constraint": [
        *(f"pivot.{i}" for i in range(1, 6)),
        *(f"clamp.{i}" for i in range(1, 7)),
    ],
    "joint_multiplier_units": [*["N"] * 3, *["N m"] * 2, *["N"] * 3, *["N m"] * 3],
    "joint_coordinate": ["pivot.angle"],
    "joint_position_units": ["rad"],
    "joint_rate_units": ["rad s-1"],
    "spring": ["tether"],
    "spring_component": ["tether.1"],
    "spring_multiplier_units": ["N"],
    "spring_coordinate_units": ["m"],
    "spring_permanent_units": ["m"],
    "axis": ["x", "y", "z"],
    "quaternion": ["w", "x", "y", "z"],
    "flexible_body": ["beam"],
}


def datasets(path):
    """The variables with numbers over time."""
    found = {}
    with h5py.File(path, "r") as file:
        for name, item in file.items():
            if isinstance(item, h5py.Dataset) and item.dtype.kind != "O" and name != "check_value":
                found[name] = item[()]
    return found


def test_every_variable_of_the_file_and_its_units(results_file, model_file):
    with h5py.File(results_file, "r") as file:
        numbers = {name: file[name] for name in datasets(results_file)}
        found = {name: (item.shape, item.attrs.get("units")) for name, item in numbers.items()}
        labels = {
            name: item.asstr()[()].tolist()
            for name, item in file.items()
            if name not in {*found, "solver", "space", "check", "check_value"}
        }
    assert found == VARIABLES
    beam = model_file.with_name("beam.h5")
    assert labels.pop("superelement_file") == [str(beam)]
    assert labels.pop("superelement_sha256") == [hashlib.sha256(beam.read_bytes()).hexdigest()]
    assert {name: sorted(values) for name, values in labels.items()} == {
        name: sorted(values) for name, values in LABELS.items()
    }


def test_the_attributes_of_the_file(results_file):
    with h5py.File(results_file, "r") as file:
        assert file.attrs["format"] == "duhamel-results"
        assert file.attrs["version"] == 12
        assert file.attrs["Conventions"].startswith("CF-")
        assert file.attrs["created_by"].startswith("duhamel ")
        assert file.attrs["model"] == MODEL
        solver = dict(file["solver"].attrs)
    assert solver["finished"]
    assert (solver["h"], solver["rho_inf"], solver["steps"], solver["rule"]) == (
        2e-4,
        0.9,
        N - 1,
        "consistent",
    )


def test_time_starts_at_zero_and_ends_at_t_end(results_file):
    np.testing.assert_allclose(Results.read(results_file).time, 2e-4 * np.arange(N), rtol=1e-14)


def test_results_in_memory_are_those_of_the_file(results_file, model_file):
    memory, file = simulate(read_model(model_file)), Results.read(results_file)
    for read in (
        lambda results: vars(results.body("beam")),
        lambda results: vars(results.frame("beam.tip")),
        lambda results: vars(results.joint("clamp")),
        lambda results: vars(results.energy),
        lambda results: {
            "time": results.time,
            "iterations": results.iterations,
            "residual": results.residual,
        },
    ):
        a, b = read(memory), read(file)
        assert a.keys() == b.keys()
        for key, array in a.items():
            np.testing.assert_array_equal(array, b[key])


def test_the_start_alone_is_the_first_row_of_a_run(model_file, results_file):
    alone, whole = start(read_model(model_file)), Results.read(results_file)
    assert alone.time.tolist() == [0.0]
    assert (alone.solver["steps"], alone.solver["finished"]) == (0, True)
    assert alone.recorded == whole.recorded
    np.testing.assert_array_equal(alone.frame("beam.tip").force, whole.frame("beam.tip").force[:1])
    np.testing.assert_array_equal(alone.energy.balance, [0.0])
    for name in ("assembly_error", "moved", "degrees_of_freedom"):
        assert alone.solver[name] == whole.solver[name]


def test_a_run_that_fails_in_its_first_step_leaves_an_earlier_file(model_file, tmp_path):
    model, path = read_model(model_file), tmp_path / "out.h5"
    simulate(model, output=path)
    torque = replace(model.loads[0], signal=Constant(1e12))
    with pytest.raises(ConvergenceError, match="no convergence in step 1 "):
        simulate(replace(model, loads=(torque,)), output=path)
    left = Results.read(path)
    assert left.solver["finished"]
    assert len(left.time) == N
    assert [entry.name for entry in tmp_path.iterdir()] == ["out.h5"]


def test_a_second_run_replaces_the_file_of_the_first(results_file, model_file, tmp_path):
    model, path = read_model(model_file), tmp_path / "out.h5"
    first = simulate(model, output=path)
    assert len(first.time) == N
    second = simulate(model.with_settings(t_end=0.002), output=path)
    assert len(second.time) == 11


def test_what_has_no_results_says_so(results_file, tmp_path):
    with pytest.raises(KeyError, match="no bodies/wheel; there are: beam, hub"):
        Results.read(results_file).body("wheel")
    with pytest.raises(KeyError, match=r"no frames/hub; there are: beam.root, beam.tip, hub.rim"):
        Results.read(results_file).frame("hub")
    (tmp_path / "text.h5").write_text("hello")
    with pytest.raises(ValueError, match=r"text.h5: not a readable HDF5 file"):
        Results.read(tmp_path / "text.h5")
    with pytest.raises(ValueError, match=r"beam.h5: expected results of a run, found"):
        Results.read(results_file.with_name("beam.h5"))


def test_a_run_that_fails_leaves_the_steps_before_the_failure(model_file, tmp_path):
    """A torque of 1e9 N m from 5 ms on turns the hub by more than Newton's method can follow."""
    text = MODEL.replace("values = [1, -1]", "values = [1, 1e9]")
    failing = model_file.with_name("failing.toml")
    failing.write_text(text)
    path = tmp_path / "failing.h5"
    with pytest.raises(ConvergenceError) as caught:
        simulate(read_model(failing), output=path)
    error, left = caught.value, Results.read(path)
    assert len(left.time) == error.step
    assert not left.solver["finished"]
    assert error.time == pytest.approx(error.step * 2e-4)
    whole = Results.read(model_file.with_name("rotor-results.h5"))
    before = 24  # the torque changes half a step before 5 ms
    np.testing.assert_array_equal(left.body("hub").x[:before], whole.body("hub").x[:before])
    assert (
        {len(array) for array in datasets(path).values()}
        == {error.step}
        == {left.solver["written"]}
    )
    assert f"step {error.step} (t = {error.time:.9g} s)" in str(error)
    assert f"relative residual {error.residual:.3e}, tolerance 1.0e-10" in str(error)
    assert f"the most open joint is {error.joint!r}, by {error.opening:.3e}" in str(error)
    assert error.joint in ("pivot", "clamp")


KILLED = """
import sys
from dataclasses import replace
from duhamel.solver import read_model, simulate
simulate(read_model(sys.argv[1]).with_settings(t_end=1e3), output=sys.argv[2])
"""


def steps_in(path):
    """How many steps a file holds that is being written."""
    try:
        return Results.read(path).solver["written"] if path.exists() else 0
    except ResultsError:  # at the moment it is open to be written
        return 0


def test_a_run_that_is_killed_leaves_whole_steps(results_file, model_file, tmp_path):
    path = tmp_path / "killed.h5"
    run = subprocess.Popen([sys.executable, "-c", KILLED, str(model_file), str(path)])
    deadline = time.monotonic() + 100.0
    while steps_in(path) < 4 * N and time.monotonic() < deadline:
        assert run.poll() is None, "the run ended by itself"
        time.sleep(0.02)
    run.kill()
    run.wait()
    left, whole = Results.read(path), Results.read(results_file)
    n = left.solver["written"]
    assert not left.solver["finished"]
    assert n > N
    for array in (
        left.time,
        left.residual,
        left.energy.balance,
        left.joint("clamp").force,
        left.frame("beam.tip").u,
    ):
        assert len(array) == n
    np.testing.assert_allclose(np.diff(left.time), 2e-4, rtol=1e-9)
    for array in (left.energy.kinetic, left.iterations, left.body("hub").v[:, 5]):
        assert (array[1:] != 0).all()
    np.testing.assert_array_equal(left.body("hub").v[:N], whole.body("hub").v)


POSITION_ROUNDING = 1e-13
"""m; what fifty steps make of the last digits of positions of half a meter"""


def order_of_rounding(name):
    """Rates are positions over h, accelerations and forces positions over h^2; so is their
    rounding.
    """
    if name.endswith(("force", "moment", "multiplier", "acceleration")):
        return 2
    rates = ("velocity", "rate", "momentum", "energy", "work", "balance")
    return 1 if name.endswith(rates) else 0


PLAIN = """
import sys
from duhamel.solver import read_model, simulate
simulate(read_model(sys.argv[1]), output=sys.argv[2])
"""


def test_plain_python_gives_what_the_compiled_code_gives(results_file, model_file, tmp_path):
    path = tmp_path / "plain.h5"
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    subprocess.run(
        [sys.executable, "-c", PLAIN, str(model_file), str(path)], env=environment, check=True
    )
    plain, compiled = datasets(path), datasets(results_file)
    assert plain.keys() == compiled.keys()
    for name, array in compiled.items():
        if name.startswith("newton_"):
            continue
        tolerance = POSITION_ROUNDING / H ** order_of_rounding(name)
        assert np.abs(plain[name] - array).max() <= tolerance * max(1.0, np.abs(array).max()), name


def test_a_folder_that_is_missing_is_named(model_file, tmp_path):
    path = tmp_path / "nowhere" / "out.h5"
    with pytest.raises(ValueError, match=f"{Path(path)}: no folder {path.parent}"):
        simulate(read_model(model_file), output=path)


def test_results_do_not_replace_what_the_run_reads(model_file, tmp_path):
    model, beam = read_model(model_file), model_file.with_name("beam.h5")
    (tmp_path / "link.h5").symlink_to(beam)
    for path, message in (
        (beam, "is the superelement of body 'beam', which the results would replace"),
        (tmp_path / "link.h5", "is the superelement of body 'beam'"),
        (model_file, "is the model file"),
        (tmp_path, "cannot be written: expected a regular file, found a folder"),
    ):
        before = None if path.is_dir() else path.read_bytes()
        with pytest.raises(ResultsError, match=f"{path}:? {message}"):
            simulate(model, output=path)
        assert before is None or path.read_bytes() == before


def under_a_load_that(model_file, acts):
    """The model with a load of nothing; `acts` is called once, as soon as the loop asks for its
    value at 5 ms.
    """
    done = []

    def value(t):
        if t > 5e-3 and not done:
            done.append(t)
            acts()
        return 0.0

    model = read_model(model_file)
    return replace(model, loads=(*model.loads, replace(model.loads[0], signal=Function(value))))


def test_a_file_without_steps_yet_says_so(model_file, tmp_path):
    path = tmp_path / "begun.h5"

    def look():
        results = Results.read(path)
        assert not results.solver["finished"]
        with pytest.raises(ResultsError, match=f"{path}: no step has been written yet"):
            _ = results.time
        with pytest.raises(ResultsError, match=f"{path}: no step has been written yet"):
            results.body("hub")

    assert len(simulate(under_a_load_that(model_file, look), output=path).time) == N


def test_an_interrupt_leaves_the_steps_before_it(results_file, model_file, tmp_path):
    path = tmp_path / "interrupted.h5"

    def interrupt():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        simulate(under_a_load_that(model_file, interrupt), output=path)
    left, whole = Results.read(path), Results.read(results_file)
    n = left.solver["written"]
    assert not left.solver["finished"]
    assert 1 < n <= 26
    assert {len(array) for array in datasets(path).values()} == {n}
    np.testing.assert_array_equal(
        left.frame("beam.tip").position, whole.frame("beam.tip").position[:n]
    )


def test_a_second_run_to_a_file_is_refused_and_the_first_goes_on(
    results_file, model_file, tmp_path
):
    path = tmp_path / "contended.h5"
    model = read_model(model_file)

    def run_again():
        with pytest.raises(ResultsError, match=f"{path}: another run writes to this file"):
            simulate(model, output=path)

    simulate(under_a_load_that(model_file, run_again), output=path)
    found, whole = datasets(path), datasets(results_file)
    assert found.keys() == whole.keys()
    for name, array in whole.items():
        np.testing.assert_array_equal(found[name], array)


def test_a_file_that_was_deleted_is_named(model_file, tmp_path):
    path = tmp_path / "deleted.h5"
    with pytest.raises(ResultsError, match=f"{path}: cannot be written: .*No such file"):
        simulate(under_a_load_that(model_file, path.unlink), output=path)
    assert not path.exists()


READER = """
import sys, time, h5py
with h5py.File(sys.argv[1]):
    print("open", flush=True)
    time.sleep(0.5)
"""


def test_a_run_waits_for_those_that_read_its_file(model_file, tmp_path):
    path = tmp_path / "read.h5"
    readers = []

    def read():
        readers.append(
            subprocess.Popen(
                [sys.executable, "-c", READER, str(path)], stdout=subprocess.PIPE, text=True
            )
        )
        assert readers[0].stdout.readline() == "open\n"

    results = simulate(under_a_load_that(model_file, read), output=path)
    with readers[0] as reader:
        assert reader.wait() == 0
    assert len(results.time) == N


def test_an_interrupt_while_rows_are_written_leaves_each_row_once(
    model_file, results_file, tmp_path, monkeypatch
):
    """It comes when the rows are on their way, and again when they are in the file."""
    path, commit = tmp_path / "out.h5", JournaledFile.commit
    for late in (False, True):

        def interrupted(file, patience, late=late):
            monkeypatch.setattr(JournaledFile, "commit", commit)
            if late:
                commit(file, patience)
            signal.raise_signal(signal.SIGINT)
            if not late:
                commit(file, patience)

        monkeypatch.setattr(JournaledFile, "commit", interrupted)
        with pytest.raises(KeyboardInterrupt):
            simulate(read_model(model_file), output=path)
        left, whole = Results.read(path), Results.read(results_file)
        np.testing.assert_array_equal(left.time, whole.time[: len(left.time)])
        np.testing.assert_array_equal(left.body("beam").x, whole.body("beam").x)
        path.unlink()
