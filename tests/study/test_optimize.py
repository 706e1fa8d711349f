"""Searches for optima, against closed forms of a ball that flies freely."""

import json
from dataclasses import replace

import numpy as np
import pytest
from duhamel.cli import app
from duhamel.solver import (
    Contact,
    Frame,
    Impact,
    Model,
    ModelError,
    RigidBody,
    Settings,
    read_model,
    simulate,
)
from duhamel.study import Parameter, StudyError, optimize, optimize_model
from duhamel.study.goals import MOST_PARTS, peaks_by_parts
from duhamel.study.outputs import values
from typer.testing import CliRunner

G = 10.0
HEIGHT = "final position:ball:z"


def ball(z=0.0, v=0.0, h=0.0, mass=1.0, step=0.02):
    """A ball that is thrown at v upward and h sideways, for a second."""
    body = RigidBody(mass, [0.1] * 3)
    start = replace(body.start, position=np.array([0, 0, z]), velocity=np.array([h, 0, v]))
    settings = Settings(t_end=1.0, step=step)
    return Model({"ball": replace(body, start=start)}, gravity=(0, 0, -G), settings=settings)


def level(z):
    """A ball that ends at a height: a run that gives a number of one's own."""
    return ball(z=z + 0.5 * G)


def between(low, high, start):
    return Parameter(bounds=(low, high), start=start)


@pytest.mark.parametrize("method", ["local", "global"])
def test_a_peak_that_moves_from_one_time_to_another(method):
    """Of |v t - g t^2 / 2| the largest is least where that of the middle is that of the end: the
    largest itself has a kink there.
    """
    found = optimize_model(
        lambda v: ball(v=v),
        {"v": between(0.0, 10.0, 1.0)},
        minimize="max |position:ball:z|",
        method=method,
    )
    assert found.converged
    # As the samples of the run have it, and the closed form between them.
    t, v = np.linspace(0.0, 1.0, 51), np.linspace(4.1, 4.2, 10001)
    sampled = np.abs(v[:, None] * t - 0.5 * G * t**2).max(axis=1)
    assert found.value == pytest.approx(sampled.min(), rel=1e-5)
    assert found.values["v"] == pytest.approx(v[sampled.argmin()], rel=1e-5)
    assert found.value == pytest.approx(G * (1.5 - np.sqrt(2.0)), rel=1e-3)
    assert found.runs < 150


def test_the_largest_of_two_outputs():
    """Thrown sideways and up, the farthest way along either is least where both are the same."""
    found = optimize_model(
        lambda v: ball(v=v, h=7.0 - v),
        {"v": between(0.0, 7.0, 6.5)},
        {"up": "max position:ball:z", "along": "max position:ball:x"},
        minimize="max(4 * up, along)",
    )
    v = found.values["v"]
    assert found.converged
    assert found.outputs["along"][1] == pytest.approx(7.0 - v, rel=1e-9)
    assert 4 * found.outputs["up"][1] == pytest.approx(7.0 - v, rel=1e-6)
    assert 4 * v**2 / (2 * G) == pytest.approx(7.0 - v, rel=1e-2)


def test_multipliers_are_what_limits_cost():
    """m v^2 / 2 >= 100 at v = 10: m >= 2, by 1/50 of it for each unit of the limit."""

    def least(limit):
        return optimize_model(
            lambda mass: ball(mass=mass),
            {"mass": between(1.0, 5.0, 3.0)},
            minimize="mass",
            constraints={"max energy:kinetic": (limit, None)},
        )

    found, tighter = least(100.0), least(101.0)
    (constraint,) = found.constraints
    assert found.converged
    assert constraint.is_active
    assert found.value == pytest.approx(2.0, rel=1e-6)
    assert constraint.multiplier == pytest.approx(0.02, rel=1e-5)
    assert tighter.value - found.value == pytest.approx(0.02, rel=1e-4)


@pytest.mark.parametrize("unit", [1e-7, 1.0, 1e9])
def test_a_limit_of_0_is_missed_or_active_in_any_unit(unit):
    def least(text, ends):
        found = optimize_model(
            lambda m: ball(mass=m),
            {"m": between(1.0, 5.0, 3.0)},
            minimize="m**2",
            constraints={text.format(unit): ends},
        )
        return found, found.constraints[0]

    kept, limit = least("{} * (m**3 - 8)", (0.0, None))
    assert kept.is_feasible
    assert limit.is_active
    assert not limit.is_missed
    missed, limit = least("{} * (m + 1)", (None, 0.0))
    assert not missed.is_feasible
    assert limit.is_missed
    assert not limit.is_active


def test_an_equality_is_kept_and_has_a_multiplier_of_its_own_sign():
    """v + h least with v h = 6 has v = h = sqrt(6), and grows by 1 / sqrt(6) with the 6."""
    found = optimize_model(
        lambda v, h: ball(v=v, h=h),
        {"v": between(0.1, 20.0, 9.0), "h": between(0.1, 20.0, 3.0)},
        minimize="v + h",
        constraints={"v * h": (6.0, 6.0)},
    )
    assert found.converged
    assert list(found.values.values()) == pytest.approx([np.sqrt(6.0)] * 2, rel=1e-4)
    assert found.constraints[0].value == pytest.approx(6.0, rel=1e-6)
    # Less is better: one more of the product makes it worse.
    assert found.constraints[0].multiplier == pytest.approx(-1.0 / np.sqrt(6.0), rel=1e-3)


def test_an_optimum_at_a_bound_is_told_and_bounds_are_kept():
    seen = []

    def thrown(v):
        seen.append(v)
        return ball(v=v)

    found = optimize_model(thrown, {"v": between(0.0, 10.0, 1.0)}, maximize=HEIGHT)
    assert found.converged
    assert found.values["v"] == 10.0
    assert "v is at a bound, 10" in found.notes
    assert min(seen) >= 0.0
    assert max(seen) <= 10.0


def test_a_flat_objective_is_no_optimum():
    found = optimize_model(
        lambda v: ball(v=v), {"v": between(0.0, 9.0, 1.0)}, minimize="max position:ball:x"
    )
    assert not found.converged
    assert "no parameter changes the objective" in found.state
    assert "v changes neither the objective nor a constraint" in found.remarks


def test_a_parameter_that_does_nothing_is_told_and_hinders_nothing():
    found = optimize_model(
        lambda v, idle: level((v - 3.0) ** 2),
        {"v": between(0.0, 10.0, 1.0), "idle": between(0.0, 1.0, 0.5)},
        minimize=HEIGHT,
    )
    assert found.converged
    assert found.values == pytest.approx({"v": 3.0, "idle": 0.5}, abs=1e-3)
    assert found.remarks == ("idle changes neither the objective nor a constraint",)


def test_parameters_of_very_different_size():
    found = optimize_model(
        lambda a, b: level((a / 1e-6 - 2.0) ** 2 + (b / 1e3 - 3.0) ** 2),
        {"a": between(0.0, 1e-5, 1e-6), "b": between(0.0, 1e4, 1e3)},
        minimize=HEIGHT,
    )
    assert found.converged
    assert found.values["a"] == pytest.approx(2e-6, rel=1e-3)
    assert found.values["b"] == pytest.approx(3e3, rel=1e-3)


@pytest.mark.parametrize("method", ["local", "global"])
def test_runs_that_fail_on_more_than_half_of_the_box(method):
    def makes(p):
        if p > 3.0:
            raise ModelError("too fast")
        return level(np.hypot(1.0, 3.0 * (p - 2.9)))

    found = optimize_model(makes, {"p": between(0.0, 10.0, 0.5)}, minimize=HEIGHT, method=method)
    assert found.converged
    assert found.values["p"] == pytest.approx(2.9, abs=1e-3)
    assert found.failed
    assert any("runs failed, the first one: too fast" in note for note in found.notes)


def test_an_edge_beyond_which_nothing_runs_is_no_optimum():
    def makes(p):
        if p > 3.0:
            raise ModelError("too fast")
        return level(-p)

    found = optimize_model(makes, {"p": between(0.0, 10.0, 0.5)}, minimize=HEIGHT)
    assert not found.converged
    assert found.values["p"] == pytest.approx(3.0, rel=1e-3)


def test_a_jump_is_no_optimum():
    found = optimize_model(
        lambda p: level(p if p > 2.0 else p + 5.0),
        {"p": between(0.0, 10.0, 4.0)},
        minimize=HEIGHT,
    )
    assert not found.converged
    assert found.values["p"] == pytest.approx(2.0, rel=1e-2)
    assert "is left, as where the objective jumps or is noisy" in found.state


def test_a_maximum_is_not_taken_for_a_minimum():
    """There no slope tells which way is down."""
    found = optimize_model(
        lambda p: level(np.cos(p)), {"p": between(-9.0, 9.0, 0.0)}, minimize=HEIGHT
    )
    assert found.converged
    assert found.value == pytest.approx(-1.0, abs=1e-6)


def test_only_a_global_search_finds_the_lower_of_two_valleys():
    def wavy(p):
        return level(np.cos(3.0 * p) + 0.1 * p)

    start = {"p": between(0.0, 6.0, 5.5)}
    near = optimize_model(wavy, start, minimize=HEIGHT)
    far = optimize_model(wavy, start, minimize=HEIGHT, method="global")
    assert near.converged
    assert far.converged
    lowest = (np.pi - np.arcsin(0.1 / 3.0)) / 3.0
    assert near.values["p"] == pytest.approx(lowest + 4.0 * np.pi / 3.0, rel=1e-3)
    assert far.values["p"] == pytest.approx(lowest, rel=1e-3)


def test_what_cannot_be_kept_is_told_with_the_least_miss():
    """v - 5 >= 3 and v <= 7, missed by the same part of each: (8 - v) / 3 = (v - 7) / 7."""
    found = optimize_model(
        lambda v: ball(v=v),
        {"v": between(0.0, 10.0, 1.0)},
        minimize="v",
        constraints={HEIGHT: (3.0, None), "v": (None, 7.0)},
    )
    v = 7.7
    assert not found.converged
    assert not found.is_feasible
    assert found.values["v"] == pytest.approx(v, rel=1e-4)
    assert found.violation == pytest.approx((8.0 - v) / 3.0, rel=1e-3)
    assert found.state.startswith("no point within all limits was found: the least miss is 0.1 of")
    assert f"v is {v:.6g}: max = 7 is missed" in found.notes


def test_a_search_that_runs_out_says_so():
    found = optimize_model(
        lambda p: level(np.cos(3.0 * p)), {"p": between(0.0, 6.0, 5.5)}, minimize=HEIGHT, runs=18
    )
    assert not found.converged
    assert "the limit of 18 runs" in found.ended
    assert found.runs <= 18


def test_a_peak_is_taken_at_each_sample_or_in_parts_of_long_runs():
    run = simulate(ball(v=3.3))
    height = run.body("ball").position[:, 2]
    np.testing.assert_array_equal(peaks_by_parts(run, "min position:ball:z"), height)
    long = simulate(ball(v=3.3, step=2e-4))
    parts = peaks_by_parts(long, "max position:ball:z")
    assert len(parts) == MOST_PARTS
    assert parts.max() == values(long, {"z": "max position:ball:z"})["z"]
    assert parts[-1] == long.body("ball").position[-6:, 2].max()


def test_arithmetic_that_falls_with_its_peak_is_taken_as_one_number():
    """1 / peak >= 1 keeps the peak below 1: v^2 / 2 g, of samples at 0, 0.02, ..."""
    found = optimize_model(
        lambda v: ball(v=v),
        {"v": between(1.0, 10.0, 2.0)},
        {"up": "max position:ball:z"},
        maximize="v",
        constraints={"1 / up": (1.0, None)},
    )
    assert found.converged
    assert found.values["v"] == pytest.approx(np.sqrt(2.0 * G), rel=1e-3)


@pytest.mark.parametrize("bounds", [(5e3, 5e4), (1e4, 5e4), (5e3, 1e4)])
def test_noise_of_a_contact_takes_wide_differences(bounds):
    """The time of flight of a ball on a stiff floor, with few steps in a contact."""
    found = optimize_model(
        bouncing(),
        {"k": Parameter("contacts.floor.stiffness", bounds=bounds, start=1e4)},
        {"end": "final position:ball:z"},
        minimize="end**2",
    )
    assert any("differences are taken over 1 % of it" in note for note in found.remarks)
    assert bounds[0] <= found.values["k"] <= bounds[1]


def bouncing():
    body = RigidBody(1.0, [0.01] * 3)
    body = replace(body, start=replace(body.start, position=np.array([0, 0, 0.15])))
    floor = Contact(
        "floor",
        ("ground.floor", "ball"),
        "plane",
        axis=[0, 0, 1],
        ball=0.05,
        impact=Impact(stiffness=1e4),
    )
    return Model(
        {"ball": body},
        gravity=(0, 0, -G),
        ground_frames={"floor": Frame([0, 0, 0])},
        contacts=(floor,),
        settings=Settings(t_end=1.5, step=1e-3),
    )


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ({"minimize": HEIGHT, "maximize": HEIGHT}, "expected one of minimize and maximize"),
        ({"minimize": "argmax position:ball:z"}, "optimize.minimize: .* moves by jumps"),
        ({"minimize": "tip + 1"}, "optimize.minimize: .*tip"),
        ({"minimize": "final position:bell:z"}, "'bell'"),
        (
            {"minimize": "v", "constraints": {HEIGHT: (None, None)}},
            "optimize: constraints.0: expected min, max or both",
        ),
        ({"minimize": "v", "constraints": {"v": (3, 2)}}, "expected min up to max"),
        ({"minimize": "v", "method": "newton"}, "optimize: method: .*newton"),
        ({"minimize": "v", "runs": 3}, "optimize.runs: expected at least 16 for 1 parameters"),
        ({"minimize": "1 / (v - 1)"}, "optimize.minimize: .*division"),
    ],
)
def test_what_is_wrong_is_named(more, told):
    with pytest.raises(StudyError, match=told):
        optimize_model(lambda v: ball(v=v), {"v": between(0.0, 10.0, 1.0)}, **more)


def test_starts_outside_of_bounds_are_refused():
    with pytest.raises(StudyError, match=r"parameters.v: expected a start between 2 and 3"):
        optimize_model(lambda v: ball(v=v), {"v": between(2.0, 3.0, 1.0)}, minimize="v")


def test_a_start_at_a_bound_and_one_that_does_not_run():
    found = optimize_model(lambda v: ball(v=v), {"v": between(2.0, 9.0, 9.0)}, minimize=HEIGHT)
    assert found.converged
    assert not found.remarks
    assert found.values["v"] == 2.0
    with pytest.raises(StudyError, match=r"does not run at the start: .*mass"):
        optimize_model(
            lambda mass: ball(mass=mass), {"mass": Parameter(start=-1.0)}, minimize="mass"
        )


def test_a_global_search_takes_bounds():
    with pytest.raises(StudyError, match=r"parameters.v: a global search takes bounds"):
        optimize_model(
            lambda v: ball(v=v), {"v": Parameter(start=1.0)}, minimize="v", method="global"
        )


MODEL = """
[simulation]
t_end = 1.0
step = 0.02
gravity = [0, 0, -10]
[bodies.ball]
mass = 1.0
inertia = [0.1, 0.1, 0.1]
velocity = [0, 0, 2]
"""
STUDY = """
model = "ball.toml"
[parameters]
bodies.ball.velocity.2 = {uniform = [0, 20]}
m = {log_uniform = [0.1, 10]}
[derived]
bodies.ball.mass = "m"
[outputs]
end = "final position:ball:z"
energy = "max energy:kinetic"
[optimize]
maximize = "end + 0 * bodies.ball.mass"
[[optimize.constraints]]
output = "energy"
max = 50
[[optimize.constraints]]
output = "m"
min = 0.5
"""


@pytest.fixture
def bench(tmp_path):
    (tmp_path / "ball.toml").write_text(MODEL)
    (tmp_path / "study.toml").write_text(STUDY)
    return tmp_path


def test_a_study_file_is_optimized_and_its_model_written(bench):
    """m v^2 / 2 <= 50 with m >= 0.5: v <= sqrt(200), as high as it may be."""
    found = optimize(bench / "study.toml", bench / "best.toml")
    speed, mass = found.parameters
    assert found.converged
    assert mass.value == pytest.approx(0.5, rel=1e-5)
    assert speed.value == pytest.approx(np.sqrt(200.0), rel=1e-5)
    assert all(one.is_active for one in found.constraints)
    model = read_model(bench / "best.toml")
    assert model.bodies["ball"].mass == mass.value
    run = simulate(model)
    assert run.body("ball").position[-1, 2] == found.outputs["end"][1]


def test_the_command_writes_the_model_a_picture_and_json(bench):
    shown = CliRunner().invoke(app, ["optimize", str(bench / "study.toml"), "--json"])
    assert shown.exit_code == 0, shown.output
    document = json.loads(shown.stdout)
    assert document["converged"]
    assert document["parameters"]["m"]["value"] == pytest.approx(0.5, rel=1e-5)
    assert document["constraints"][1]["max"] is None
    assert (bench / "study-optimized.toml").exists()
    assert (bench / "study-optimized.png").stat().st_size
    told = CliRunner().invoke(app, ["optimize", str(bench / "study.toml")])
    assert "max 50, active" in told.output
    assert "optimum, of points nearby" in told.output


def test_no_input_is_replaced_and_a_search_that_fails_writes_nothing(bench):
    command = ["optimize", str(bench / "study.toml"), "-o"]
    refused = CliRunner().invoke(app, [*command, str(bench / "ball.toml")])
    assert refused.exit_code == 1
    assert (bench / "ball.toml").read_text() == MODEL
    (bench / "ball.toml").write_text(MODEL.replace("1.0", "-1.0", 1))
    before = {path.name for path in bench.iterdir()}
    failed = CliRunner().invoke(app, [*command, str(bench / "best.toml")])
    assert failed.exit_code == 1
    assert {path.name for path in bench.iterdir()} == before


def test_an_end_without_an_optimum_is_a_failure_of_the_command(bench):
    """m 5^2 / 2 is the least of the largest energies: (12.5 m - 50) / 50 = (20 - m) / 20."""
    text = STUDY.replace("min = 0.5", "min = 20")
    (bench / "study.toml").write_text(text)
    shown = CliRunner().invoke(app, ["optimize", str(bench / "study.toml")])
    assert shown.exit_code == 1
    assert "no point within all limits was found" in shown.output
    assert "m is 6.66667: min = 20 is missed" in shown.output
