"""`duhamel modes`, `duhamel frf` and `duhamel campbell`: what they print and write."""

import csv
import resource
from dataclasses import replace

import numpy as np
import pytest
from duhamel.cli import app
from duhamel.superelement import write

PENDULUM = """
[simulation]
t_end = 1.0
step = 1e-3
gravity = [0, -9.81, 0]
[bodies.arm]
mass = 2.0
inertia = [0.01, 0.02, 0.03]
position = [0, -0.5, 0]
frames.pivot = {position = [0, 0.5, 0]}
[[joints]]
name = "hinge"
type = "revolute"
between = ["ground", "arm.pivot"]
axis = [0, 0, 1]
[[loads]]
type = "torque"
on = "arm"
direction = [0, 0, 1]
signal = 1.0
"""
ROTOR = """
[simulation]
t_end = 1.0
step = 1e-3
start = "equilibrium"
steady_rotation = {angular_velocity = [0, 0, 1]}
[bodies.disk]
mass = 2.0
inertia = [0.02, 0.02, 0.04]
[[springs]]
name = "bearing"
type = "bushing"
between = ["ground", "disk"]
stiffness = [2e4, 2e4, 2e4, 0, 0, 0]
"""
FREQUENCY = np.sqrt(9.81 / 0.53) / (2.0 * np.pi)


@pytest.fixture
def pendulum(tmp_path):
    file = tmp_path / "pendulum.toml"
    file.write_text(PENDULUM)
    return file


def run(runner, *arguments, code=0):
    result = runner.invoke(app, [str(argument) for argument in arguments])
    assert result.exit_code == code, result.output
    return result


def test_modes_are_printed_and_drawn(runner, pendulum, tmp_path):
    target = tmp_path / "modes.png"
    result = run(runner, "modes", pendulum, "-o", target)
    assert f"{FREQUENCY:.6g}" in result.stdout
    assert target.exists()
    run(runner, "modes", pendulum, "-o", tmp_path / "modes.csv")
    rows = list(csv.DictReader((tmp_path / "modes.csv").read_text().splitlines()))
    assert float(rows[0]["frequency_Hz"]) == pytest.approx(FREQUENCY, rel=1e-12)


def test_a_full_disk_names_the_table(runner, pendulum, tmp_path):
    """A limit of the size of files stands for it."""
    target, limits = tmp_path / "modes.csv", resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10, limits[1]))
    try:
        result = run(runner, "modes", pendulum, "-o", target, code=1)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert result.stderr == f"error: {target}: cannot be written: File too large\n"
    assert list(tmp_path.iterdir()) == [pendulum]


def test_responses_are_drawn_within_the_band_of_the_superelements(runner, element, tmp_path):
    """Unless a band is given: twice the tenth frequency of a model may be far beyond it."""
    write(tmp_path / "beam.h5", replace(element, kernel=replace(element.kernel, band=500.0)))
    model = tmp_path / "model.toml"
    model.write_text("simulation.t_end = 0.1\n[bodies.beam]\nsuperelement = 'beam.h5'\n")
    asked = ("--from", "force:beam.tip:y", "--to", "elastic_displacement:beam.tip:y")
    result = run(runner, "frf", model, *asked, "-o", tmp_path / "frf.csv")
    assert "All validity limits respected, all values in their recommended" in result.stdout
    *_, last = csv.reader((tmp_path / "frf.csv").read_text().splitlines())
    assert 300.0 < float(last[0]) < 0.8 * 500.0


def test_frequency_responses_are_written(runner, pendulum, tmp_path):
    target = tmp_path / "frf.csv"
    asked = ("--from", "load:1", "--to", "coordinate:hinge:angle", "--band", 1, 10)
    run(runner, "frf", pendulum, *asked, "-o", target)
    header, *rows = csv.reader(target.read_text().splitlines())
    assert header[1] == "coordinate:hinge:angle by load:1 [rad / (N m)]"
    f, size, _ = np.array(rows, dtype=float).T
    np.testing.assert_allclose(size, np.abs(1 / (9.81 - 0.53 * (2 * np.pi * f) ** 2)), rtol=1e-9)
    run(runner, "frf", pendulum, *asked, "--bodies", "dynamic", "--bodies", "rigid")
    assert (tmp_path / "pendulum-frf.png").exists()
    run(runner, "frf", pendulum, *asked, "--bodies", "dynamic", "--bodies", "rigid", "-o", target)
    header, first, *_ = csv.reader(target.read_text().splitlines())
    assert header[1].endswith("by load:1, dynamic [rad / (N m)]")
    assert header[3].endswith("by load:1, rigid [rad / (N m)]")
    assert float(first[3]) == pytest.approx(size[0], rel=1e-9)  # nothing bends
    result = run(runner, "frf", pendulum, *asked[:4], "--static")
    assert f"{1 / 9.81:.9g}" in result.stdout


def test_a_campbell_diagram_is_printed_and_drawn(runner, tmp_path):
    file = tmp_path / "rotor.toml"
    file.write_text(ROTOR)
    result = run(runner, "campbell", file, "--spin", 0, 200, 5, "-n", 4)
    assert "1x meets line" in result.stdout
    assert "100 rad/s" in result.stdout  # sqrt(2e4 / 2)
    assert (tmp_path / "rotor-campbell.png").exists()


def test_rotors_on_bearings_by_commands(runner, tmp_path):
    """2 kg on 2e4 N/m with 4 N s/m; cross coupling of 1 N/m per rad/s wins at 400 rad/s."""
    file, rows = tmp_path / "rotor.toml", tmp_path / "orbits.csv"
    file.write_text(
        """
        [simulation]
        t_end = 1.0
        step = 1e-3
        [ground]
        frames.hub = {}
        [bodies.disk]
        mass = 2.0
        inertia = [0.01, 0.01, 0.02]
        [[bearings]]
        between = ["ground.hub", "disk"]
        axis = [0, 0, 1]
        speeds = [0, 500]
        stiffness = [[2e4, 0, 0, 2e4], [2e4, 500, -500, 2e4]]
        damping = [[4, 0, 0, 4], [4, 0, 0, 4]]
        """
    )
    assert "100" in run(runner, "modes", file, "--spin", 100).stdout
    result = run(runner, "campbell", file, "--spin", 100, 500, 5, "-o", tmp_path / "lines.csv")
    assert "unstable above 400 rad/s" in result.stdout
    at = ("--at", "disk=2e-3@90", "--spin", 0, 200, 201, "-o", rows)
    assert "disk: largest at 100" in run(runner, "unbalance", file, *at).stdout
    with rows.open(newline="") as opened:
        line = next(row for row in csv.DictReader(opened) if float(row["spin_rad_per_s"]) == 50.0)
    # u Omega^2 / (k - m Omega^2 + i Omega c ...), a quarter turn ahead
    expected = 2e-3 * 50.0**2 / abs(2e4 - 2.0 * 50.0**2 + 1j * 50.0 * 4.0 - 1j * 50.0)
    assert float(line["disk long semiaxis [m]"]) == pytest.approx(expected, rel=1e-9)
    # Two of the size at 30 and 150 degrees are one at 90 degrees.
    both = ("--at", "disk=2e-3@30", "--at", "disk=2e-3@150", "--spin", 50, 60, 2, "-o", rows)
    run(runner, "unbalance", file, *both)
    with rows.open(newline="") as opened:
        line = next(csv.DictReader(opened))
    assert float(line["disk long semiaxis [m]"]) == pytest.approx(expected, rel=1e-9)
    assert (
        "--at" in run(runner, "unbalance", file, "--at", "disk", "--spin", 0, 9, 3, code=2).stderr
    )


def test_a_campbell_diagram_of_many_lines_fits_into_80_columns(runner, tmp_path, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    file = tmp_path / "rotor.toml"
    disk = ROTOR[ROTOR.index("[bodies.disk]") : ROTOR.index("[[springs]]")]
    bearing = ROTOR[ROTOR.index("[[springs]]") :]
    copies = [
        (disk + bearing).replace("disk", f"disk{k}").replace("bearing", f"bearing{k}")
        for k in range(4)
    ]
    file.write_text(ROTOR + "".join(copies))
    output = run(runner, "campbell", file, "--spin", 1000, 1200, 2, "-n", 15).stdout
    rows = [line for line in output.splitlines() if line.startswith("\u2502")]
    assert len(rows) >= 4  # two spins, in two tables at least
    assert all(len(line) <= 80 and "\u2026" not in line for line in rows)


def test_the_validity_of_a_linear_analysis_is_printed_and_warned_of(runner, element_file):
    """A free body that turns at a tenth of its first frequency, 100 Hz, without [rotation]."""
    file = element_file.with_name("spun.toml")
    file.write_text(
        "[simulation]\nt_end = 0.01\nstart = 'equilibrium'\n"
        "steady_rotation = {angular_velocity = [62.83185, 0, 0]}\n"
        "[bodies.beam]\nsuperelement = 'beam.h5'\n"
    )
    result = run(runner, "modes", file, "-n", 8)
    assert "spin / first elastic frequency" in result.stdout
    assert "poor" in result.stdout
    assert f"warning: {file}: body 'beam': spin / first elastic frequency: 0.1 (limit < 0.05)" in (
        result.stderr
    )


def test_modes_end_in_the_band_of_the_superelement_unless_they_are_counted(
    runner, element, tmp_path
):
    kernel = replace(element.kernel, band=300.0)
    write(replace(element, kernel=kernel), tmp_path / "beam.h5")
    file = tmp_path / "free.toml"
    file.write_text(
        "[simulation]\nt_end = 0.01\nstart = 'equilibrium'\n"
        "[bodies.beam]\nsuperelement = 'beam.h5'\n"
    )
    few = run(runner, "modes", file)
    assert "modes are above 300 Hz" in few.stdout
    assert not few.stderr
    all_of_them = run(runner, "modes", file, "-n", 12)
    assert "modes are above" not in all_of_them.stdout
    assert "highest frequency / band of the superelement" in all_of_them.stderr


def test_what_cannot_be_done_is_told_in_one_line(runner, pendulum, tmp_path):
    asked = ("--to", "coordinate:hinge:angle", "--band", 1, 10)
    result = run(runner, "frf", pendulum, "--from", "load:2", *asked, code=1)
    assert "error: " in result.stderr
    assert "load:2: expected load:1 to load:1" in result.stderr
    result = run(runner, "campbell", pendulum, "--spin", 0, 200, 5, code=1)
    told = f"{pendulum}: simulation: a Campbell diagram needs the axis of a steady_rotation"
    assert told in result.stderr
    result = run(runner, "modes", pendulum, "-o", pendulum, code=1)
    assert "would replace" in result.stderr
