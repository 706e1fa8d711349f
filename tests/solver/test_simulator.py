"""One step at a time: to the last bit what `simulate` gives; steps of bounded cost, and how far they are off."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    ConvergenceError,
    FlexibleBody,
    Frame,
    Input,
    Joint,
    Load,
    Model,
    ModelError,
    Place,
    Polynomial,
    RigidBody,
    Simulator,
    Spline,
    Start,
    Steps,
    Table,
    read_model,
    simulate,
)

STEPS, H = 60, 5e-4
OUTPUTS = ("joints/pivot/angle", "frames/beam.tip/position", "joints/clamp/multipliers", "energy/work")


def rotor(coarse, load, angle=None, **settings):
    """A hub with a beam; a torque, the same load as a force on the tip, and a force that no one gives step by step."""
    hub = RigidBody(0.01, [0.006, 0.007, 0.01], {"rim": Frame([0.05, 0, 0])})
    return Model(
        bodies={"hub": hub, "beam": FlexibleBody(coarse, Start(place=Place("root", "hub.rim")))},
        joints=(
            Joint("pivot", "revolute", ("ground", "hub"), [0, 0, 1], angle=angle),
            Joint("clamp", "fixed", ("hub.rim", "beam.root")),
        ),
        loads=(
            Load("torque", "hub", [0, 0, 1], load),
            Load("force", "beam.tip", [0, 0, 0.2], Steps((0.0, 0.0103), (1.0, -2.0))),
            Load("force", "beam.tip", [0, 1, 0], load, follower=True),
        ),
        **{"step": H, "t_end": STEPS * H, **settings},
    )


def recorded(model):
    """The outputs of all steps (n, n_out)."""
    results = simulate(model)
    return np.column_stack(
        [
            results.joint("pivot").coordinates["angle"] if model.joints[0].angle is None else results.time,
            results.frame("beam.tip").position,
            results.joint("clamp").multipliers,
            results.energy.work,
        ]
    )


def values_at(steps):
    return np.sin(40.0 * H * np.asarray(steps)) + 0.3


@pytest.mark.parametrize("prepared", [True, False])
@pytest.mark.parametrize("history", ["recursive", "direct"])
@pytest.mark.parametrize("corrections", [None, 2])
def test_step_by_step_is_simulate_to_the_last_bit(prepared, history, corrections, coarse):
    settings = {"history": history, "corrections": corrections}
    values = values_at(range(STEPS + 1))
    told = Table(tuple(H * np.arange(STEPS + 1)), tuple(values))
    expected = recorded(rotor(coarse, told, **settings))
    simulator = Simulator(rotor(coarse, Input("motor", values[0]), **settings), OUTPUTS)
    assert simulator.inputs == ("motor",)
    found = [simulator.outputs]
    for value in values[1:]:
        if prepared:
            simulator.prepare()
        found.append(simulator.step([value]))
    np.testing.assert_array_equal(found, expected)
    assert simulator.time == pytest.approx(STEPS * H, rel=1e-14)
