"""The report of `duhamel run` on the start and the energy of a run."""

import re

import pytest
from duhamel.cli import app
from duhamel.results import Results

MODEL = """
[simulation]
t_end = 0.2
rule = "RULE"

[bodies.beam]
superelement = "beam.h5"

[[loads]]
type = "force"
on = "beam.tip"
direction = [0.0, 0.0, 1.0]
signal = {amplitude = 1.0, frequency = 640.0}
"""


@pytest.fixture
def told(runner, element_file):
    """The lines of a run under a load at a frequency at which the tip answers like a mass, against
    the load.
    """

    def run(rule):
        path = element_file.with_name(f"{rule}.toml")
        path.write_text(MODEL.replace("RULE", rule))
        result = runner.invoke(app, ["run", str(path)])
        assert result.exit_code == 0, result.output
        return result.stdout

    return run


def test_energy_that_the_convolution_created_is_told(told):
    """Eq. (55) gives energy to a load on a mass; no other rule does."""
    found = re.search(
        r"elastic energy fell to (\S+) J: the convolution has created energy \(rule 'paper'\)",
        told("paper"),
    )
    assert float(found[1]) < -1e-6
    assert "created energy" not in told("consistent")


SPINNING = """
[simulation]
t_end = 6e-4

[bodies.beam]
superelement = "beam.h5"
angular_velocity = [0, SPEED, 0]
"""


@pytest.mark.parametrize(("speed", "warned"), [(1.0, False), (200.0, True)])
def test_validity_is_told_with_a_warning_for_each_limit_passed(speed, warned, runner, element_file):
    path = element_file.with_name("spinning.toml")
    path.write_text(SPINNING.replace("SPEED", str(speed)))
    result = runner.invoke(app, ["run", str(path)])
    assert result.exit_code == 0, result.output
    (line,) = [line for line in result.stdout.splitlines() if line.startswith("spin /")]
    assert re.search(r" beam +< 0\.03 +< 0\.05( +poor)?$", line)
    assert line.endswith("poor") == warned
    warning = (
        r"warning: body 'beam': spin / first elastic frequency: 0\.\d+ \(limit < 0\.05\): "
        r"centrifugal stiffening is missing: add \[rotation\] to its body file"
    )
    assert bool(re.search(warning, result.stderr)) == warned


@pytest.mark.parametrize(
    ("amplitude", "ends"),
    [("1e7", r"stopped in step \d+ \(t = .* s\): "), ("1e9", r"no convergence .* likely cause: ")],
)
def test_a_body_torn_apart_ends_the_run_with_one_line(amplitude, ends, runner, element_file):
    """Whether Newton's method still converges or not."""
    path = element_file.with_name("torn.toml")
    model = MODEL.replace("RULE", "consistent").replace(
        "amplitude = 1.0", f"amplitude = {amplitude}"
    )
    path.write_text(model)
    result = runner.invoke(app, ["run", str(path)])
    assert result.exit_code == 1
    line = (
        rf"error: {re.escape(str(path))}: {ends}interface 'beam\.\w+' has (turned|moved) by .*, "
        r"where linear elasticity has no meaning: divide .*\n"
    )
    *warnings, error = result.stderr.splitlines(keepends=True)
    assert re.fullmatch(line, error)
    assert all(line.startswith("warning: ") for line in warnings)


PENDULUM = """
[simulation]
t_end = 0.01
step = 1e-3

[bodies.bob]
mass = 1.0
inertia = [0.1, 0.1, 0.1]
position = [0.50001, 0, 0]
velocity = [0.3, 0, 0]
frames.pin = {position = [-0.5, 0, 0]}

[[joints]]
name = "pin"
type = "revolute"
between = ["ground.pin", "bob.pin"]
axis = [0, 0, 1]
start = {START}

[ground]
frames.pin = {}
"""


@pytest.fixture
def start_told(runner, tmp_path):
    """The lines of a run of a bob that is 10 um off its pin and thrown away from it."""

    def run(start="{}"):
        path = tmp_path / "pendulum.toml"
        path.write_text(PENDULUM.replace("{START}", start))
        result = runner.invoke(app, ["run", str(path)])
        assert result.exit_code == 0, result.output
        return result.stdout.splitlines()

    return run


def test_how_far_the_start_was_off_is_told_as_given(start_told):
    """Whatever joints ask for at the start moves bodies, but opens nothing."""
    lines = start_told()
    assert "largest assembly error: 1e-05 m at joint 'pin'" in lines
    assert "largest velocity error: 0.3 m/s or rad/s at joint 'pin'" in lines
    assert "bodies start up to 1e-05 m or rad from their given places" in lines
    asked = start_told("{angle = 1}")
    assert asked[1:3] == lines[1:3]
    assert "bodies start up to 1 m or rad from their given places" in asked


def test_the_balance_is_told_beside_the_largest_energy(told):
    found = re.search(r"balance within (\S+), (\S+) of the largest\n", told("consistent"))
    assert float(found[1]) > 0.0
    assert 0.0 < float(found[2]) < 1.0


@pytest.mark.parametrize(
    ("quantities", "told_of"),
    [("", ["energy", "momentum"]), ('"momentum"', ["momentum"]), ('"bodies"', [])],
)
def test_what_was_not_recorded_is_not_told(quantities, told_of, runner, tmp_path):
    path = tmp_path / "pendulum.toml"
    output = f"[output]\nquantities = [{quantities}]\n" if quantities else ""
    path.write_text(PENDULUM.replace("{START}", "{}") + output)
    result = runner.invoke(app, ["run", str(path)])
    assert result.exit_code == 0, result.output
    lines = [line for line in result.stdout.splitlines() if "at the end" in line]
    assert [line.split()[0] for line in lines] == told_of


BALL = """
[simulation]
t_end = 0.11
step = 1e-4
gravity = [0, 0, -10]

[ground]
frames.floor = {}

[bodies.ball]
mass = 0.1
inertia = [1e-5, 1e-5, 1e-5]
position = [0, 0, 0.03]

[[contacts]]
name = "floor"
between = ["ground.floor", "ball"]
shape = "plane"
axis = [0, 0, 1]
ball = 0.02
stiffness = 6e4
restitution = 0.5

[[contacts]]
name = "roof"
between = ["ground.floor", "ball"]
shape = "sphere"
radius = 0.5
hollow = true
ball = 0.02
stiffness = 6e4
"""


def test_each_contact_is_a_line_and_quantities_of_it_can_be_drawn(runner, tmp_path):
    path = tmp_path / "ball.toml"
    path.write_text(BALL)
    result = runner.invoke(app, ["run", str(path)])
    assert result.exit_code == 0, result.output
    floor, roof = (line for line in result.stdout.splitlines() if line.startswith("contacts: "))
    found = re.fullmatch(
        r"contacts: floor: (\d+) impacts, peak (\S+) N, impulse (\S+) N s, shortest (\d+) steps",
        floor,
    )
    events = Results.read(tmp_path / "ball-results.h5").events["floor"]
    assert int(found[1]) == len(events) == 2
    assert float(found[2]) == pytest.approx(events.peak.max(), rel=1e-3)
    assert float(found[3]) == pytest.approx(events.impulse.sum(), rel=1e-3)
    assert int(found[4]) == events.steps.min()
    assert roof == "contacts: roof: never closed"
    assert "note: never closed in this run: roof; " in result.stdout
    shown = Results.read(tmp_path / "ball-results.h5")._repr_html_()
    assert re.search(r"never closed\b.*roof", shown, re.S)
    names = ["gap:floor", "normal_force:floor", "slip:floor:t1", "friction_force:floor"]
    names += ["impulse:floor"]
    target = tmp_path / "ball-results.h5"
    assert runner.invoke(app, ["plot", str(target), *names, "contact_state:roof"]).exit_code == 0
    refused = runner.invoke(app, ["plot", str(target), "gap:wall"])
    owners = "contact or surface contact or stop"
    assert f"gap:wall: no {owners} 'wall'; there are: floor, roof" in refused.stderr
    refused = runner.invoke(app, ["plot", str(target), "slip:floor:z"])
    assert "slip:floor:z: expected slip:CONTACT[:t1|t2]" in refused.stderr
