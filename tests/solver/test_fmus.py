"""FMUs in a model: controllers beside the time loop, explicitly and with their slopes."""

import warnings
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from duhamel.results import Results
from duhamel.solver import (
    FMU,
    Fixed,
    FlexibleBody,
    Frame,
    Impact,
    Input,
    Model,
    ModelError,
    Motor,
    OutputRequest,
    Place,
    Revolute,
    RigidBody,
    Settings,
    Simulator,
    Spring,
    Start,
    StateError,
    Stop,
    Table,
    Torque,
    ValidityWarning,
    check,
    linearize,
    read_model,
    simulate,
    write_model,
)
from duhamel.solver.cosimulation.instance import FMUInstance

from .controller_fmu import controller
from .test_restart import assert_same

H, J = 6e-5, 0.019
INPUTS = {"angle": "joints/pivot/angle", "rate": "joints/pivot/angle_rate"}
GAINS = ((50.0, 0.5), (500.0, 20.0), (500.0, 200.0), (500.0, 700.0), (500.0, 3000.0))
"""kp, kd: of damping times step over inertia 0.002, 0.06, 0.6, 2.2 and 9.5"""
STEP = FMUInstance.step
LOST = 50.0
"""an angle that no stable controller of a turn of 1 rad reaches"""


@pytest.fixture(scope="session", params=[2, 3], ids=["FMI 2", "FMI 3"])
def file(request, tmp_path_factory):
    return controller(tmp_path_factory.mktemp("fmus") / "drive.fmu", request.param)


@pytest.fixture(scope="session")
def drive(tmp_path_factory):
    return controller(tmp_path_factory.mktemp("fmus") / "drive.fmu")


def hub(motor, *fmus, steps=300, **settings):
    """A hub on a pivot."""
    return Model(
        {"hub": RigidBody(0.01, [0.0095, 0.0095, J])},
        joints=[Revolute("ground", "hub", [0, 0, 1], name="pivot")],
        motors=[motor],
        fmus=fmus,
        settings=Settings(t_end=steps * H, step=H, **settings),
    )


def driven(file, steps=300, settings=None, inputs=INPUTS, **more):
    """A hub that an FMU turns to 1 rad."""
    parameters = more.pop("parameters", {})
    fmu = FMU("drive", file, inputs, {"torque": "tau"}, parameters, **more)
    motor = Motor("m", "pivot", "angle", torque=Input("tau"))
    return hub(motor, fmu, steps=steps, **(settings or {}))


def servo(kp, kd, steps=300):
    """The same by a servo inside the time step."""
    reference = Table([0.0, 1.0], [1.0, 1.0])
    gains = {"stiffness": kp, "damping": kd}
    return hub(Motor("m", "pivot", "angle", reference=reference, **gains), steps=steps)


def angle(model):
    with warnings.catch_warnings():
        # Gains that are too fast for the step, and explicit coupling that has failed, warn.
        warnings.simplefilter("ignore", ValidityWarning)
        return simulate(model).joint("pivot").angle


def error(found, exact):
    return np.abs(found - exact).max() / np.abs(exact).max()


def test_explicit_coupling_is_of_first_order(file):
    errors = []
    for n in (1, 2, 4):
        model = driven(file, step=n * H, parameters={"kp": 50.0, "kd": 2.0})
        errors.append(error(angle(model), angle(servo(50.0, 2.0))))
    ratios = [b / a for a, b in pairwise(errors)]
    assert errors[0] < 5e-3
    assert all(1.8 < ratio < 2.2 for ratio in ratios)


@pytest.mark.parametrize(("kp", "kd"), GAINS)
def test_with_its_slope_a_controller_is_a_servo_at_any_gain(kp, kd, file):
    model = driven(file, coupling="slope", parameters={"kp": kp, "kd": kd})
    assert error(angle(model), angle(servo(kp, kd))) < 1e-10


@pytest.mark.parametrize(("kp", "kd"), GAINS)
def test_explicit_coupling_is_stable_up_to_twice_the_inertia_over_the_step(kp, kd, drive):
    found = angle(driven(drive, 1500, parameters={"kp": kp, "kd": kd}))
    is_lost = not np.isfinite(found).all() or np.abs(found).max() > LOST
    assert is_lost == (kd * H / J > 2.0)


def test_a_controller_that_goes_up_and_down_is_warned_of(drive):
    parameters = {"kp": 500.0, "kd": 700.0, "limit": 1.0}
    with pytest.warns(ValidityWarning, match=r"fmu 'drive': torque chatters: .*coupling = \"slope"):
        simulate(driven(drive, 1500, parameters=parameters))
    with warnings.catch_warnings():
        warnings.filterwarnings("error", ".*chatters")
        angle(driven(drive, 1500, parameters={"kp": 50.0, "kd": 2.0}))


@pytest.mark.parametrize("version", [2, 3])
def test_directional_derivatives_stand_for_the_slope_where_no_state_can_be_saved(version, tmp_path):
    drive = controller(tmp_path / "d.fmu", version, states=False, derivatives=True)
    model = driven(drive, coupling="slope", parameters={"kp": 500.0, "kd": 700.0})
    assert error(angle(model), angle(servo(500.0, 700.0))) < 1e-10


@pytest.mark.parametrize("lag", [1e-6, 3e-5])
@pytest.mark.parametrize("n", [1, 5, 20])
def test_a_controller_with_a_short_lag_is_stable_by_its_reaction_over_a_step(lag, n, drive):
    model = driven(
        drive,
        600,
        step=n * H,
        coupling="slope",
        parameters={"kp": 500.0, "kd": 700.0, "lag": lag},
    )
    assert error(angle(model), angle(servo(500.0, 700.0, 600))) < 1.5e-3 * n


def test_the_slope_is_measured_again_where_a_limit_changes_it(drive):
    parameters = {"kp": 500.0, "kd": 200.0, "limit": 20.0}
    found = angle(driven(drive, 600, coupling="slope", parameters=parameters))
    limited = servo(500.0, 200.0, 600)
    limited = replace(limited, motors=[replace(limited.motors[0], limit=20.0)])
    assert error(found, angle(limited)) < 1e-4


def test_steady_slopes_cost_few_repeats(drive, monkeypatch):
    steps = []
    monkeypatch.setattr(
        FMUInstance, "step", lambda self, *given: (steps.append(given), STEP(self, *given))[1]
    )
    angle(driven(drive, coupling="slope", parameters={"kp": 500.0, "kd": 20.0}))
    # Two inputs are changed each time, at first and then every 64 steps.
    assert len(steps) == 300 + 2 * 5


def test_what_the_fmu_gives_at_first_acts_from_the_start(drive):
    model = driven(drive, parameters={"kp": 50.0})
    results = simulate(model)
    assert results.fmu("drive").outputs["tau"][0] == 50.0
    assert results.motor("m").torque[0] == 50.0
    assert results.body("hub").angular_acceleration[0, 2] == pytest.approx(50.0 / J, rel=1e-14)


def test_an_equilibrium_that_an_fmu_ends_is_warned_of(drive):
    model = driven(drive, settings={"start": "equilibrium"})
    with pytest.warns(ValidityWarning, match=r"input 'tau' jumps as the run begins, from 0 to 50"):
        results = simulate(model)
    assert results.motor("m").torque[0] == 0.0


def test_what_an_fmu_gives_is_recorded_with_its_unit(drive, tmp_path):
    model = driven(drive, settings={"output": OutputRequest(every=7)})
    simulate(model, output=tmp_path / "run.h5")
    results = Results.read(tmp_path / "run.h5")
    assert results.fmus == ("drive",)
    assert "fmus/drive" in results.recorded
    assert results.unit("fmus", "drive", "tau") == "N m"
    given = results.fmu("drive").outputs["tau"]
    np.testing.assert_allclose(given, results.motor("m").torque, rtol=1e-12)


def test_between_communication_points_inputs_are_linear(drive):
    given = simulate(driven(drive, step=5 * H)).fmu("drive").outputs["tau"]
    second = np.diff(given, n=2)
    corners = np.arange(1, 300) % 5 == 0
    assert np.abs(second[~corners]).max() < 1e-10
    assert np.abs(second[corners]).min() > 1e-6


def test_an_fmu_that_gives_nothing_changes_no_bit(coarse, drive, tmp_path):
    rim = {"rim": Frame([0.05, 0, 0])}
    model = Model(
        {
            "hub": RigidBody(0.01, [0.006, 0.007, 0.01], rim),
            "beam": FlexibleBody(coarse, Start(place=Place("root", "hub.rim"))),
        },
        joints=[
            Revolute("ground", "hub", [0, 0, 1], name="pivot"),
            Fixed("hub.rim", "beam.root", name="clamp"),
        ],
        loads=[Torque("hub", [0, 0, 1], Table([0.0, 0.01], [0.0, 1.0]))],
        settings=Settings(t_end=0.03, step=5e-4, output=OutputRequest(every=2)),
    )
    watched = FMU("watch", drive, {"angle": "frames/beam.tip/position[2]"})
    plain, seen = simulate(model), simulate(replace(model, fmus=[watched]))
    for name in ("body_position", "frame_force", "joint_rate"):
        np.testing.assert_array_equal(plain.variable(name), seen.variable(name))


@pytest.mark.parametrize(("coupling", "n"), [("explicit", 4), ("slope", 1)])
def test_runs_with_fmus_go_on_to_the_bit(coupling, n, file, tmp_path):
    parameters = {"kp": 500.0, "kd": 20.0, "ki": 1e4, "lag": 1e-4, "limit": 30.0}
    whole = driven(
        file,
        90,
        {"checkpoint": {"every": 29}},
        coupling=coupling,
        step=n * H,
        parameters=parameters,
    )
    simulate(whole, output=tmp_path / "whole.h5")
    for number, end in enumerate((14, 62, 90)):
        part = whole.with_settings(t_end=end * H)
        simulate(part, output=tmp_path / "parts.h5", resume=number > 0)
    assert_same(tmp_path / "parts.h5", tmp_path / "whole.h5")


@pytest.mark.parametrize("coupling", ["explicit", "slope"])
def test_a_simulator_steps_fmus_as_a_run_does(coupling, file, tmp_path):
    parameters = {"kp": 500.0, "kd": 20.0, "lag": 1e-4}
    model = driven(file, 60, coupling=coupling, step=4 * H, parameters=parameters)
    simulate(model, output=tmp_path / "run.h5")
    with Simulator(model, ["fmus/drive/tau"], results=tmp_path / "steps.h5") as simulator:
        assert simulator.inputs == ()
        given = [simulator.outputs[0], *(simulator.step([])[0] for _ in range(60))]
    assert_same(tmp_path / "steps.h5", tmp_path / "run.h5")
    assert given == Results.read(tmp_path / "run.h5").fmu("drive").outputs["tau"].tolist()


@pytest.mark.parametrize("coupling", ["explicit", "slope"])
def test_a_simulator_goes_back_with_its_fmus(coupling, file, tmp_path):
    parameters = {"kp": 500.0, "kd": 20.0, "lag": 1e-4, "ki": 1e3}
    model = driven(file, 60, coupling=coupling, step=4 * H, parameters=parameters)
    with Simulator(model, ["joints/pivot/angle"]) as simulator:
        for _ in range(21):
            simulator.step([])
        simulator.save().write(tmp_path / "state")
        state = simulator.save()
        first = [simulator.step([])[0] for _ in range(30)]
        simulator.restore(state)
        assert [simulator.step([])[0] for _ in range(30)] == first
        simulator.restore(type(state).read(tmp_path / "state"))
        assert [simulator.step([])[0] for _ in range(30)] == first


def test_two_fmus_of_one_file_keep_apart(drive):
    arms = {name: RigidBody(0.01, [0.0095, 0.0095, J]) for name in ("a", "b")}
    model = Model(
        arms,
        joints=[Revolute("ground", name, [0, 0, 1], name=f"of {name}") for name in arms],
        motors=[Motor(name, f"of {name}", "angle", torque=Input(f"t {name}")) for name in arms],
        fmus=[
            FMU(
                f"for {name}",
                drive,
                {"angle": f"joints/of {name}/angle"},
                {"torque": f"t {name}"},
                {"kp": kp},
            )
            for name, kp in (("a", 50.0), ("b", 20.0))
        ],
        settings=Settings(t_end=300 * H, step=H),
    )
    results = simulate(model)
    alone = simulate(driven(drive, inputs={"angle": INPUTS["angle"]}, parameters={"kp": 20.0}))
    np.testing.assert_array_equal(results.joint("of b").angle, alone.joint("pivot").angle)
    assert results.joint("of a").angle[-1] > 2.0 * results.joint("of b").angle[-1]


def test_one_fmu_gets_what_another_gives(drive):
    watch = FMU(
        "watch", drive, {"angle": "fmus/drive/tau"}, {"torque": "n"}, {"kp": -1.0, "reference": 0.0}
    )
    model = driven(drive)
    model = replace(model, fmus=[*model.fmus, watch], loads=[Torque("hub", [1, 0, 0], Input("n"))])
    results = simulate(model)
    given, seen = results.fmu("drive").outputs["tau"], results.fmu("watch").outputs["n"]
    np.testing.assert_allclose(seen[1:], given[:-1], rtol=1e-12)


@pytest.mark.parametrize("coupling", ["explicit", "slope"])
def test_fmus_run_beside_two_sizes_of_steps(coupling, drive):
    def stopped(**settings):
        model = driven(
            drive,
            steps=400,
            settings=settings,
            coupling=coupling,
            step=2 * H,
            parameters={"kp": 30.0, "kd": 0.3},
        )
        stop = Stop("stop", "pivot", "angle", [-1.0, 0.1], Impact(stiffness=1e4, restitution=0.9))
        return replace(model, stops=[stop])

    two = simulate(stopped(contact_step=H / 10))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ValidityWarning)
        fine = simulate(stopped().with_settings(step=H / 10))
    assert two.stop("stop").events.impacts >= 1
    assert len(two.time) < 0.5 * len(fine.time)
    expected = np.interp(two.time, fine.time, fine.joint("pivot").angle)
    np.testing.assert_allclose(two.joint("pivot").angle, expected, atol=2e-3)


def test_linear_analyses_leave_fmus_out_and_say_so(drive):
    model = driven(drive, coupling="slope")
    coil = Spring("coil", "torsion", ("ground", "hub"), axis=[0, 0, 1], stiffness=J)
    with pytest.warns(ValidityWarning, match="fmu 'drive': linear analyses leave FMUs out"):
        linear = linearize(replace(model, springs=[coil]))
    assert 2.0 * np.pi * linear.modes().frequencies[0] == pytest.approx(1.0)
    response = linear.frf(["tau"], ["coordinate:pivot:angle"], [1e-4])
    assert abs(response.values[0, 0, 0]) == pytest.approx(1.0 / J, rel=1e-6)


def test_the_file_of_an_fmu_belongs_to_the_state_of_a_run(tmp_path):
    model = driven(controller(tmp_path / "drive.fmu", 3), 20, {"checkpoint": {"every": 5}})
    simulate(model.with_settings(t_end=10 * H), output=tmp_path / "run.h5")
    controller(tmp_path / "drive.fmu", 2)
    other = driven(tmp_path / "drive.fmu", 20, {"checkpoint": {"every": 5}})
    with pytest.raises(StateError, match=r"fmus.drive.file: was '"):
        simulate(other, output=tmp_path / "run.h5", resume=True)


def test_a_model_with_fmus_is_checked_by_its_first_steps(drive, tmp_path):
    found = check(driven(drive, 300))
    assert found.steps == 300
    wrong = driven(drive, inputs={"angel": INPUTS["angle"]})
    with pytest.raises(ModelError, match="no variable 'angel'"):
        check(wrong)


def test_a_model_with_fmus_is_written_and_read(drive, tmp_path):
    model = driven(drive, step=2 * H, coupling="slope", parameters={"kp": 3.0})
    write_model(model, tmp_path / "model.toml")
    text = (tmp_path / "model.toml").read_text()
    assert "[[fmus]]" in text
    assert str(drive) not in text
    (fmu,) = read_model(tmp_path / "model.toml").fmus
    assert (fmu.name, fmu.coupling, fmu.step, fmu.parameters) == (
        "drive",
        "slope",
        2 * H,
        {"kp": 3.0},
    )
    assert (fmu.inputs, fmu.outputs, fmu.file) == (INPUTS, {"torque": "tau"}, str(drive))
