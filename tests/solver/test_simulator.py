"""One step at a time: to the last bit what `simulate` gives; steps of bounded cost, and how far
they are off.
"""

import warnings
from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    Contact,
    ConvergenceError,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Impact,
    Input,
    Model,
    ModelError,
    Motor,
    OutputRequest,
    Place,
    Polynomial,
    Pulse,
    Results,
    Revolute,
    RigidBody,
    Settings,
    Simulator,
    Spring,
    Start,
    Steps,
    Table,
    Torque,
    ValidityWarning,
    read_model,
    simulate,
)
from duhamel.solver.history import dyadic

STEPS, H = 60, 5e-4
OUTPUTS = (
    "joints/pivot/angle",
    "frames/beam.tip/position",
    "joints/clamp/multipliers",
    "energy/work",
)


def rotor(coarse, load, angle=None, **settings):
    """A hub with a beam; a torque, the same load as a force on the tip, and a force that no one
    gives step by step.
    """
    hub = RigidBody(0.01, [0.006, 0.007, 0.01], {"rim": Frame([0.05, 0, 0])})
    loads = (
        Torque("hub", [0, 0, 1], load),
        Force("beam.tip", [0, 0, 0.2], Steps((0.0, 0.0103), (1.0, -2.0))),
        Force("beam.tip", [0, 1, 0], load, follower=True),
    )
    model = Model(
        bodies={"hub": hub, "beam": FlexibleBody(coarse, Start(place=Place("root", "hub.rim")))},
        joints=(
            Revolute("ground", "hub", [0, 0, 1], name="pivot", angle=angle),
            Fixed("hub.rim", "beam.root", name="clamp"),
        ),
        loads=loads,
        settings=Settings(step=H, t_end=STEPS * H),
    )
    if "loads" in settings:
        model = replace(model, loads=settings.pop("loads"))
    return model.with_settings(**settings)


def recorded(model):
    """The outputs of all steps (n, n_out)."""
    results = simulate(model)
    return np.column_stack(
        [
            results.joint("pivot").coordinates["angle"],
            results.frame("beam.tip").position,
            results.joint("clamp").multipliers,
            results.energy.work,
        ]
    )


def values_at(steps):
    return np.sin(40.0 * H * np.asarray(steps)) + 0.3


@pytest.mark.parametrize("block", [4, 8, 16])
def test_partitions_of_the_past_give_the_direct_sum(block, coarse, monkeypatch):
    """Blocks of 4, 8 and 16 of 60 steps; with kernels that end after 27 steps, loads are let go of
    besides.
    """
    monkeypatch.setattr(dyadic, "DIRECT_STEPS", block)
    damped = replace(coarse.modes, zeta=np.full(len(coarse.modes.omega), 0.5))
    soft = replace(coarse, modes=damped, compliance=damped.compliance)
    values = values_at(range(STEPS + 1))
    told = Table(tuple(H * np.arange(STEPS + 1)), tuple(values))
    for element, memory in ((coarse, None), (soft, 27 * H)):
        expected = recorded(rotor(element, told, history="direct", kernel_length=memory))
        simulator = Simulator(
            rotor(element, Input("motor", values[0]), history="fft", kernel_length=memory), OUTPUTS
        )
        found = np.array([simulator.outputs, *(simulator.step([value]) for value in values[1:])])
        error, scale = np.abs(found - expected).max(axis=0), np.abs(expected).max(axis=0)
        motion = [0, 1, 2, 3]  # multipliers follow from it over h^2
        assert (error[motion] < 1e-13).all()
        assert error.max() < 1e-8 * scale[4:].max()


@pytest.mark.parametrize("history", ["recursive", "direct"])
@pytest.mark.parametrize("corrections", [None, 2])
def test_step_by_step_is_simulate_to_the_last_bit(history, corrections, coarse):
    settings = {"history": history, "fixed_iterations": corrections}
    values = values_at(range(STEPS + 1))
    told = Table(tuple(H * np.arange(STEPS + 1)), tuple(values))
    expected = recorded(rotor(coarse, told, **settings))
    simulator = Simulator(rotor(coarse, Input("motor", values[0]), **settings), OUTPUTS)
    assert simulator.inputs == ("motor",)
    found = [simulator.outputs, *(simulator.step([value]) for value in values[1:])]
    np.testing.assert_array_equal(found, expected)
    assert simulator.time == pytest.approx(STEPS * H, rel=1e-14)


def test_a_joint_driven_by_an_input_is_one_driven_by_the_same_values(coarse):
    """The drive t^3 starts as an input does, without speed or acceleration."""
    drive = Polynomial((0.0, 0.0, 0.0, 8000.0))
    expected = simulate(rotor(coarse, Steps((0.0,), (1.0,)), drive)).frame("beam.tip").position
    driven = rotor(coarse, Steps((0.0,), (1.0,)), Input("angle"))
    simulator = Simulator(driven, ["frames/beam.tip/position"])
    found = [simulator.outputs, *(simulator.step([drive(H * n)]) for n in range(1, STEPS + 1))]
    np.testing.assert_array_equal(found, expected)


def test_a_simulator_closes_a_loop(coarse):
    """A torque -k angle, told a step late, and a spring of stiffness k: apart by what a step of
    delay does, order 1.
    """
    k = 30.0

    def apart(step):
        loads = tuple(
            Torque("hub", [0, 0, 1], signal) for signal in (Input("motor"), Pulse(5.0, 0.0, 5e-3))
        )
        model = rotor(coarse, Input("motor"), step=step, loads=loads)
        simulator, angle = Simulator(model, ["joints/pivot/angle"]), 0.0
        while simulator.time < model.settings.t_end - 0.5 * step:
            (angle,) = simulator.step([-k * angle])
        spring = Spring("spring", "torsion", ("ground", "hub"), [0, 0, 1], stiffness=k)
        sprung = replace(model, loads=loads[1:], springs=(spring,))
        return abs(simulate(sprung).joint("pivot").coordinates["angle"][-1] - angle)

    steps = [2e-4, 1e-4, 5e-5]
    errors = [apart(step) for step in steps]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    np.testing.assert_allclose(orders, 1.0, atol=0.1)


def test_corrections_with_the_factors_of_the_step_before_converge_fast(coarse):
    """Each brings a run a hundred times closer, or more, to that of Newton's method; no step takes
    more of them.
    """
    load = Steps((0.0, 0.01), (5.0, -5.0))

    def run(corrections):
        return simulate(rotor(coarse, load, fixed_iterations=corrections))

    exact = run(None).frame("beam.tip").position
    runs = [run(corrections) for corrections in (1, 2, 3)]
    errors = [np.abs(run.frame("beam.tip").position - exact).max() for run in runs]
    assert errors[0] < 1e-3
    assert errors[1] < 1e-2 * errors[0]
    assert errors[2] < 1e-2 * errors[1]
    assert [run.iterations.max() for run in runs] == [1, 2, 3]


def test_what_a_simulator_cannot_do_is_told(coarse):
    model = rotor(coarse, Input("motor"))
    with pytest.raises(
        ModelError,
        match=r"rotor.toml: outputs: no 'joints/pivot/angel'; did you mean 'joints/pivot/angle'",
    ):
        Simulator(replace(model, path="rotor.toml"), ["joints/pivot/angel"])
    simulator = Simulator(model.with_settings(t_end=2 * H), OUTPUTS)
    with pytest.raises(
        ModelError, match=r"inputs: expected values of \['motor'\], got \[1.0, 2.0\]"
    ):
        simulator.step([1, 2])
    simulator.step([0.0])
    simulator.step([0.0])
    with pytest.raises(ModelError, match=r"t_end = 0.001 s has been reached"):
        simulator.step([0.0])
    lost = Simulator(model, OUTPUTS)
    with pytest.raises(ConvergenceError, match="no convergence in step 1 "):
        lost.step([1e12])


def test_an_input_in_a_model_file_is_its_value_when_simulated(tmp_path):
    path = tmp_path / "stone.toml"
    path.write_text(FILE)
    model = read_model(path)
    np.testing.assert_allclose(
        simulate(model).body("stone").v[:, 0], 3.0 * 1e-3 * np.arange(11), rtol=0, atol=1e-13
    )
    simulator = Simulator(model, ["bodies/stone/v"])
    assert simulator.inputs == ("thrust",)
    assert simulator.step([3.0])[0] == pytest.approx(3e-3, rel=1e-12)


FILE = """
[simulation]
t_end = 0.01
step = 1e-3

[bodies.stone]
mass = 1.0
inertia = [1, 1, 1]

[[loads]]
type = "force"
on = "stone"
direction = [1, 0, 0]
signal = {input = "thrust", value = 3}
"""


def hit(coarse, load, **settings):
    """The rotor, whose tip strikes a wall."""
    model = rotor(coarse, load, **settings)
    wall = Contact(
        "wall",
        ("ground.wall", "beam.tip"),
        "plane",
        0.01,
        [0, -1, 0],
        impact=Impact(stiffness=1e6, restitution=0.5),
    )
    return replace(model, contacts=[wall], ground_frames={"wall": Frame([0, 0.012, 0])})


@pytest.mark.parametrize("every", [1, 7])
def test_its_results_file_is_that_of_a_run(every, coarse, tmp_path):
    values = values_at(range(STEPS + 1))
    told = Table(tuple(H * np.arange(STEPS + 1)), tuple(values))
    settings = {"output": OutputRequest(every=every)}
    simulate(hit(coarse, told, **settings), output=tmp_path / "run.h5")
    model = hit(coarse, Input("motor", values[0]), **settings)
    with Simulator(model, OUTPUTS, results=tmp_path / "steps.h5") as simulator:
        events = [simulator.events]
        for value in values[1:]:
            simulator.step([value])
            events.append(simulator.events)
        energy, validity = simulator.energy, simulator.validity
    run, steps = Results.read(tmp_path / "run.h5"), Results.read(tmp_path / "steps.h5")
    assert steps.contents.quantities == run.contents.quantities
    for name in ("time", "iterations", "residual"):
        np.testing.assert_array_equal(getattr(steps, name), getattr(run, name))
    for part in ("energy", "momentum"):
        for name, column in vars(getattr(run, part)).items():
            np.testing.assert_array_equal(vars(getattr(steps, part))[name], column)
    np.testing.assert_array_equal(steps.joint("clamp").force, run.joint("clamp").force)
    found, expected = steps.contact("wall").events, run.contact("wall").events
    assert len(found.start) == sum(len(each["wall"].start) for each in events) > 0
    np.testing.assert_array_equal(found.impulse, expected.impulse)
    assert steps.validity == run.validity == validity
    assert steps.solver["finished"]
    assert steps.solver["steps"] == STEPS
    if every == 1:
        for name, column in vars(energy).items():
            np.testing.assert_array_equal(column, vars(run.energy)[name][-1:])


def test_a_results_file_holds_the_steps_before_an_error_or_an_early_end(coarse, tmp_path):
    model, path = rotor(coarse, Input("motor")), tmp_path / "steps.h5"
    with suppress(ZeroDivisionError), Simulator(model, OUTPUTS, results=path) as simulator:
        for k in range(9):
            simulator.step([1.0 / (5.0 - k)])
    assert len(Results.read(path).time) == 6
    assert not Results.read(path).solver["finished"]
    simulator = Simulator(model, OUTPUTS, results=path)
    moment = simulator.save()
    simulator.step([1.0])
    with pytest.raises(ModelError, match="restore: expected a Simulator without a results file"):
        simulator.restore(moment)
    assert simulator.finish().time.tolist() == [0.0, H]
    with pytest.raises(ModelError, match="finish has already ended the results"):
        simulator.step([1.0])
    with pytest.raises(ModelError, match="finish: this Simulator writes no results"):
        Simulator(model, OUTPUTS).finish()


def damped_wheel(damping, steps, **options):
    """A wheel under a damper d that is told a step late and linear in between, for some steps.

    It is stable for d < 2 J / h = 40 N m s / rad:

        z^2 + (a / 2 - 1) z + a / 2 = 0 with a = d h / J
    """
    J, h, limit = 0.02, 1e-3, options.pop("limit", np.inf)
    model = Model(
        {"wheel": RigidBody(1.0, [J, J, J], start=Start(angular_velocity=[0, 0, 1.0]))},
        [Revolute("ground", "wheel", [0, 0, 1], name="axle")],
        motors=[Motor("drive", "axle", "angle", torque=Input("torque"))],
        settings=Settings(t_end=0.6, step=h),
    )
    with Simulator(model, ["joints/axle/angle_rate"], **options) as simulator:
        for _ in range(steps):
            simulator.step([np.clip(-damping * simulator.outputs[0], -limit, limit)])
    return float(simulator.outputs[0])


@pytest.mark.parametrize(("damping", "is_stable"), [(15.0, True), (45.0, False)])
def test_a_controller_whose_gain_is_too_large_for_its_delay_is_told(damping, is_stable):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        rate = damped_wheel(damping, 600, limit=30.0)
    told = [str(each.message) for each in caught if each.category is ValidityWarning]
    told = [line for line in told if line.startswith("input ")]
    assert len(told) == (0 if is_stable else 1)
    assert is_stable or told[0].startswith("input 'torque' chatters: until t = 0.512 s")
    assert (abs(rate) < 1e-3) == is_stable


def test_an_input_that_chatters_to_the_end_of_a_short_run_is_told(tmp_path):
    with pytest.warns(ValidityWarning, match=r"input 'torque' chatters: until t = 0\.4 s"):
        damped_wheel(45.0, 400, limit=30.0, results=tmp_path / "wheel.h5")


@pytest.mark.parametrize("damping", [100.0, 1e4])
def test_a_step_that_fails_for_a_controller_names_its_input(damping):
    with pytest.raises(ConvergenceError, match="likely cause: input 'torque' goes up and down"):
        damped_wheel(damping, 600)


def stiff():
    """A mass on a spring, four steps in a period."""
    mass = RigidBody(1.0, [0.1] * 3, start=Start(velocity=[1.0, 0, 0]))
    stiffness = [(0.5 * np.pi / H) ** 2, 0.0, 0.0, 0.0, 0.0, 0.0]
    return Model(
        {"mass": mass},
        springs=[Spring("spring", "bushing", ("ground.wall", "mass"), stiffness=stiffness)],
        ground_frames={"wall": Frame()},
        settings=Settings(t_end=60 * H, step=H),
    )


def test_a_simulator_warns_at_t_end_of_limits_that_were_passed():
    simulator = Simulator(stiff(), [])
    for _ in range(59):
        simulator.step([])
    with pytest.warns(ValidityWarning, match="time steps per period") as told:
        simulator.step([])
    assert [str(each.message) for each in told] == list(simulator.validity.brief())


def test_a_simulator_warns_at_the_end_of_its_block_once():
    def run(simulator):
        with simulator:
            for _ in range(50):
                simulator.step([])

    simulator = Simulator(stiff(), [])
    with pytest.warns(ValidityWarning, match="time steps per period") as told:
        run(simulator)
    assert [str(each.message) for each in told] == list(simulator.validity.brief())
