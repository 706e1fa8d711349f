"""`--json`: one record on the standard output, as docs/command-line.md has it, also of errors."""

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from duhamel.cli import app
from duhamel.cli.call import RECORD_VERSION, plain
from duhamel.superelement import read
from import_order import ROOT

PENDULUM = """
[simulation]
t_end = 0.1
step = 1e-3
gravity = [0, -9.81, 0]

[bodies.bob]
mass = 2
inertia = [1e-3, 1e-3, 1e-3]
position = [0.5, 0, 0]
frames.end = {position = [-0.5, 0, 0]}

[[joints]]
name = "pivot"
type = "revolute"
between = ["ground", "bob.end"]
axis = [0, 0, 1]

[[springs]]
name = "coil"
type = "torsion"
between = ["ground", "bob.end"]
axis = [0, 0, 1]
stiffness = 50.0
"""
# In every record, and in that of a call that failed.
COMMON_KEYS = {"schema_version", "duhamel_version", "command", "exit_code", "warnings"}


@pytest.fixture
def model_file(tmp_path: Path) -> Path:
    path = tmp_path / "pendulum.toml"
    path.write_text(PENDULUM)
    return path


@pytest.fixture
def record_of(runner):
    def record(*arguments, exit_code=0):
        done = runner.invoke(app, [*map(str, arguments), "--json"])
        assert done.exit_code == exit_code, done.output
        found = json.loads(done.stdout)
        assert found["schema_version"] == RECORD_VERSION
        assert found["command"] == arguments[0]
        assert found["exit_code"] == exit_code
        return found

    return record


def documented(command: str) -> set[str]:
    """The keys that the page lists for a command."""
    text = (ROOT / "docs" / "command-line.md").read_text()
    section = text.partition(f"### `{command}`\n")[2].partition("\n###")[0]
    keys = set(re.findall(r"^\| `(\w+)`", section, flags=re.M))
    assert keys, command
    return keys


def test_a_model_that_is_checked(record_of, model_file):
    record = record_of("check", model_file)
    assert set(record) == COMMON_KEYS | documented("check MODEL.toml")
    assert (record["degrees_of_freedom"], record["steps"], record["step_s"]) == (1, 100, 1e-3)
    # A point mass at an arm, and its own inertia, on a torsion spring, without gravity.
    expected = np.sqrt(50.0 / (2.0 * 0.5**2 + 1e-3)) / (2.0 * np.pi)
    assert record["frequencies_hz"] == [pytest.approx(expected, rel=1e-6)]


def test_a_superelement(record_of, element, element_file):
    record = record_of("info", element_file)
    assert set(record) == COMMON_KEYS | documented("info")
    assert record["mass_kg"] == element.mass
    assert record["inertia_kg_m2"] == element.J_rot.tolist()
    assert [each["dofs"] for each in record["interfaces"]] == [6, 3]
    assert record["modes"]["frequencies_hz"] == pytest.approx(100.0 * np.arange(1, 13))


def test_a_superelement_without_modes_has_null_in_their_place(record_of, measured_file):
    assert record_of("info", measured_file)["modes"] is None


def test_checks_that_do_not_hold_are_in_the_record_and_end_with_1(record_of, element_file):
    import h5py

    with h5py.File(element_file, "r+") as file:
        file["kernel/g"][-1] *= 1.5
    record = record_of("check", element_file, exit_code=1)
    assert set(record) == COMMON_KEYS | documented("check FILE.h5") | {"error"}
    failed = [one for one in record["checks"] if not one["holds"]]
    assert failed
    assert all(one["found"] > one["limit"] for one in failed)
    assert not record["holds"]
    assert failed[0]["dataset"] in record["error"]


def test_a_run_and_its_peaks(record_of, model_file):
    record = record_of("run", model_file)
    assert set(record) == COMMON_KEYS | documented("run")
    energies = record["energy_at_end_j"]
    assert energies["kinetic"] + energies["potential"] + energies["springs"] == pytest.approx(
        energies["work"], abs=1e-3
    )
    results_file = Path(record["results_file"])
    assert results_file == model_file.with_name("pendulum-results.h5")
    peaks = record_of("peaks", results_file, "position:bob:x")
    assert set(peaks) == COMMON_KEYS | documented("peaks")
    (peak,) = peaks["peaks"]
    assert (peak["quantity"], peak["unit"], peak["at_unit"]) == ("position:bob:x", "m", "s")
    assert (peak["largest"], peak["largest_at"], peak["place"]) == (0.5, 0.0, None)


def test_modes(record_of, model_file):
    record = record_of("modes", model_file, "-n", "1")
    assert set(record) == COMMON_KEYS | documented("modes")
    (mode,) = record["modes"]
    omega = mode["eigenvalue_imaginary_rad_per_s"]
    assert mode["frequency_hz"] == pytest.approx(omega / (2.0 * np.pi))
    assert mode["damping_ratio"] == pytest.approx(0.0, abs=1e-9)
    assert not mode["is_rigid"]


def test_people_read_the_same_on_the_standard_error(runner, model_file):
    told = runner.invoke(app, ["check", str(model_file)])
    done = runner.invoke(app, ["check", str(model_file), "--json"])
    lines = [line for line in told.stdout.splitlines() if not line.startswith("expected")]
    assert lines
    assert set(lines) <= set(done.stderr.splitlines())


def test_warnings_are_in_the_record(record_of, model_file):
    load = 'type = "force"\non = "bob"\ndirection = [0, 1, 0]'
    signal = "signal = {half_sine = 1, duration = 1e-3}"
    model_file.write_text(f"{PENDULUM}\n[[loads]]\n{load}\n{signal}\n")
    (warning,) = record_of("check", model_file)["warnings"]
    assert warning.startswith(f"{model_file}: ")
    assert "a pulse of 0.001 s has 1 steps" in warning


@pytest.mark.parametrize(
    ("arguments", "exit_code", "expected"),
    [
        (["run", "none.toml"], 1, "none.toml: not a readable file"),
        (["modes"], 2, "Missing argument 'MODEL.toml'"),
        (["peaks", "none.h5", "--unknown"], 2, "No such option: --unknown"),
        (["check", "none.txt"], 2, "expected a superelement"),
    ],
)
def test_failures_are_records_too(record_of, arguments, exit_code, expected):
    record = record_of(*arguments, exit_code=exit_code)
    assert set(record) == COMMON_KEYS | {"error"}
    assert expected in record["error"]


def test_a_defect_of_the_program_is_a_record_as_well(runner, element_file, monkeypatch):
    def fails(element):
        raise ZeroDivisionError("a defect")

    monkeypatch.setattr("duhamel.cli.description.describe", fails)
    done = runner.invoke(app, ["info", str(element_file), "--json"])
    assert isinstance(done.exception, ZeroDivisionError)
    assert json.loads(done.stdout)["error"] == "ZeroDivisionError: a defect"


def test_what_is_no_number_is_null():
    given = {"a": np.array([1.0, np.nan]), "b": (np.float64(np.inf), np.int64(3), None, "text")}
    assert plain(given) == {"a": [1.0, None], "b": [None, 3, None, "text"]}


def test_without_it_nothing_is_a_record(runner, element_file):
    done = runner.invoke(app, ["info", str(element_file)])
    assert done.exit_code == 0
    assert read(element_file).name in done.stdout
    assert "schema_version" not in done.stdout


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="Linux has it")
def test_a_full_disk_under_the_record_is_one_line(element_file):
    with Path("/dev/full").open("w") as full:
        words = [sys.executable, "-m", "duhamel", "info", element_file, "--json"]
        done = subprocess.run(words, stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1] == (
        "error: standard output: cannot be written: No space left on device"
    )
