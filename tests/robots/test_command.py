"""`duhamel import`: its options, what it prints, and what it leaves."""

import pytest
from duhamel.cli import app
from duhamel.solver import read_model
from typer.testing import CliRunner

from .references import DATA

ARM = str(DATA / "two_links.urdf")


def run(*arguments):
    return CliRunner().invoke(app, ["import", *map(str, arguments)])


def test_a_robot_becomes_a_model_that_runs(tmp_path):
    target = tmp_path / "arm.toml"
    done = run(ARM, "-o", target, "--servo", 500, 20, "--state", "elbow=-0.5", "--t-end", 0.01)
    assert done.exit_code == 0, done.output
    *told, last = done.output.replace("\n", " ").partition(str(target))[::2]
    assert "not taken, or otherwise: collision geometry" in told[0]
    assert last.strip() == ": 2 bodies, 2 joints, 1 stop, 2 motors; 3.7 kg"
    model = read_model(target)
    assert [motor.reference.value for motor in model.motors] == [0.0, -0.5]
    ran = CliRunner().invoke(app, ["run", str(target)])
    assert ran.exit_code == 0, ran.output


def test_the_model_is_beside_the_robot_unless_given(tmp_path):
    robot = tmp_path / "arm.urdf"
    robot.write_text((DATA / "two_links.urdf").read_text())
    assert run(robot).exit_code == 0
    assert (tmp_path / "arm.toml").is_file()


def test_an_error_is_one_line_with_the_place(tmp_path):
    robot = tmp_path / "bad.urdf"
    robot.write_text('<robot name="r"><link name="a"/><link name="b"/></robot>')
    done = run(robot)
    assert done.exit_code == 1
    assert done.stderr == f"error: {robot}: expected one root link, found 'a', 'b'\n"
    assert not (tmp_path / "bad.toml").exists()


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (["--state", "elbow"], "--state: expected JOINT=VALUE"),
        (["--state", "elbow=up"], "--state: elbow: expected a number, got 'up'"),
        (["--flexible", "fore"], "--flexible: expected LINK=FILE.h5"),
        (["--flexible", "fore=a.h5,elbow"], "--flexible: expected JOINT=INTERFACE"),
        (["--servo", "0", "0"], "--servo: expected a gain above 0"),
        (["--stop-stiffness", "-1"], "--stop-stiffness: expected a positive number"),
        (["--servo-of", "elbow=1"], "--servo-of: expected JOINT=KP,KD"),
        (["--servo-of", "elbow=1,b"], "--servo-of: elbow: expected a number, got 'b'"),
        (["--servo-of", "elbow=0,0"], "--servo-of: elbow: expected a gain above 0"),
        (["--t-end", "0"], "--t-end: expected a positive number"),
        (["--base", "loose"], "loose"),
    ],
)
def test_a_wrong_call_is_refused(tmp_path, options, expected):
    done = run(ARM, "-o", tmp_path / "arm.toml", *options)
    assert done.exit_code == 2
    words = " ".join(done.output.replace("│", " ").split())
    assert expected in words
    assert not list(tmp_path.iterdir())
