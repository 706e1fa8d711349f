"""Simulators that go back to a state that they saved, in memory and in files."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    ConvergenceError,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Input,
    Model,
    Place,
    Revolute,
    RigidBody,
    SavedState,
    Settings,
    Simulator,
    Spline,
    Spring,
    Start,
    StateError,
    Torque,
)
from duhamel.solver.history import uniform

H, STEPS = 5e-4, 90
OUTPUTS = ("frames/beam.tip/position", "joints/pivot/angle", "energy/work", "energy/elastic")


@pytest.fixture(autouse=True)
def _small_blocks(monkeypatch):
    monkeypatch.setattr("duhamel.solver.history.dyadic.DIRECT_STEPS", 8)
    monkeypatch.setattr("duhamel.solver.simulator.STEPS_AHEAD", 16)
    assert uniform.dyadic.DIRECT_STEPS == 8


def rotor(element, **settings):
    """A hub that turns more than once, a beam, a spring, a signal, and an input."""
    hub = RigidBody(
        0.01,
        [0.006, 0.007, 0.01],
        {"rim": Frame([0.05, 0, 0])},
        Start(angular_velocity=[0, 0, 200.0]),
    )
    beam = FlexibleBody(element, Start(place=Place("root", "hub.rim")))
    ramp = Spline((0.0, 0.02, 0.05), (0.0, 1.0, -1.0))
    return Model(
        bodies={"hub": hub, "beam": beam},
        joints=(
            Revolute("ground", "hub", [0, 0, 1], name="pivot"),
            Fixed("hub.rim", "beam.root", name="clamp"),
        ),
        loads=(
            Torque("hub", [0, 0, 1], Input("torque")),
            Force("beam.tip", [0, 1, 0], ramp, follower=True),
        ),
        springs=(Spring("coil", "bushing", ("ground", "beam.tip"), stiffness=[5.0] * 6),),
        settings=Settings(step=H, t_end=STEPS * H, **settings),
    )


def torque(n):
    return [np.sin(0.7 * n) + 0.3]


@pytest.mark.parametrize("history", ["recursive", "fft", "direct"])
@pytest.mark.parametrize("fixed_iterations", [None, 2])
def test_a_saved_state_goes_on_to_the_bit_in_any_order(coarse, history, fixed_iterations):
    simulator = Simulator(
        rotor(coarse, history=history, fixed_iterations=fixed_iterations), OUTPUTS
    )
    saved, rows = [simulator.save()], [simulator.outputs]
    for n in range(1, STEPS + 1):
        rows.append(simulator.step(torque(n)))
        saved.append(simulator.save())
    for n in np.random.default_rng(0).permutation(STEPS + 1).tolist():
        np.testing.assert_array_equal(simulator.restore(saved[n]), rows[n])
        assert simulator.time == H * n
        for later in range(n + 1, min(n + 20, STEPS + 1)):
            np.testing.assert_array_equal(simulator.step(torque(later)), rows[later])


@pytest.mark.parametrize("history", ["recursive", "fft", "direct"])
def test_a_state_in_a_file_serves_another_simulator(coarse, history, tmp_path):
    model = rotor(coarse, history=history)
    simulator, path = Simulator(model, OUTPUTS), tmp_path / "moment.h5"
    for n in range(1, 44):
        simulator.step(torque(n))
    simulator.save().write(path)
    rows = [simulator.step(torque(n)) for n in range(44, STEPS + 1)]
    other = Simulator(model, OUTPUTS)
    other.restore(SavedState.read(path))
    for n, row in enumerate(rows, start=44):
        np.testing.assert_array_equal(other.step(torque(n)), row)
    assert [entry.name for entry in tmp_path.iterdir()] == ["moment.h5"]


def test_a_failed_step_can_be_taken_again_from_a_saved_state(coarse):
    simulator = Simulator(rotor(coarse), OUTPUTS)
    simulator.step([0.0])
    saved = simulator.save()
    with pytest.raises(ConvergenceError):
        simulator.step([float("nan")])
    simulator.restore(saved)
    found = simulator.step([1.0])
    expected = Simulator(rotor(coarse), OUTPUTS)
    expected.step([0.0])
    np.testing.assert_array_equal(found, expected.step([1.0]))


def test_a_state_of_another_model_is_refused_by_the_key(coarse, tmp_path):
    model = rotor(coarse)
    Simulator(model, OUTPUTS).save().write(tmp_path / "moment.h5")
    moment = SavedState.read(tmp_path / "moment.h5")
    heavier = RigidBody(0.02, [0.006, 0.007, 0.01], model.bodies["hub"].frames)
    changed = {
        "bodies.hub.mass: was 0.01, is 0.02": replace(
            model, bodies={**model.bodies, "hub": heavier}
        ),
        "springs.coil: was .* is no longer there": replace(model, springs=()),
        "t_end: was 90 steps, is 100": model.with_settings(t_end=100 * H),
        "simulation.tolerance: was 1e-10, is 1e-08": model.with_settings(tolerance=1e-8),
        "simulation.history: was 'auto', is 'direct'": model.with_settings(history="direct"),
    }
    for message, other in changed.items():
        with pytest.raises(StateError, match=message.replace("coil", "coil.*")):
            Simulator(other, OUTPUTS).restore(moment)
