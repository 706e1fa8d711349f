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
    monkeypatch.setattr(dyadic, "BLOCK", block)
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
        stiffness = [(0.5 * np.pi / H) ** 2, 0.0, 0.0, 0.0, 0.0, 0.0]

    spring = Spring("spring", "bushing", ("ground.wall", "mass"), stiffness=stiffness)
    return Model(
        {"mass": mass},
        springs=[spring],
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
    with pytest.warns(ValidityWarning, match="time steps per period") as told:  # noqa: SIM117
        with Simulator(stiff(), []) as simulator:
            for _ in range(50):
                simulator.step([])
    assert [str(each.message) for each in told] == list(simulator.validity.brief())
