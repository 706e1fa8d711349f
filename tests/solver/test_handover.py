"""Models that start from the end of another run, with its vibration and its past."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    Frame,
    Harmonic,
    Model,
    ModelError,
    Polynomial,
    ResultsError,
    RigidBody,
    Settings,
    Simulator,
    Spherical,
    Start,
    StateError,
    check,
    read_model,
    simulate,
    write_model,
)
from duhamel.superelement import write

from .test_restart import H, machine

FIRST, LAST = 37, 80


@pytest.fixture(autouse=True)
def _small_blocks(monkeypatch):
    monkeypatch.setattr("duhamel.solver.history.dyadic.DIRECT_STEPS", 8)


def first_run(model, path):
    simulate(model.with_settings(t_end=FIRST * H, checkpoint=1e3), output=path)
    return {"from": str(path)}


@pytest.mark.parametrize("history", ["recursive", "fft", "direct"])
def test_the_same_model_goes_on_as_if_it_were_one_run(coarse, history, tmp_path):
    """To rounding: the factors of the matrix are made anew."""
    model = machine(coarse, LAST, history=history)
    whole = simulate(model)
    second = simulate(model.with_settings(start=first_run(model, tmp_path / "first.h5")))
    np.testing.assert_array_equal(second.time, whole.time[FIRST:])
    taken = [run.solver["steps"] for run in (second, whole)]
    assert taken == [len(run.time) - 1 for run in (second, whole)]
    for found, expected in (
        (second.body("hub").v, whole.body("hub").v),
        (second.body("beam").x, whole.body("beam").x),
        (second.frame("beam.tip").u, whole.frame("beam.tip").u),
        (second.frame("beam.tip").velocity, whole.frame("beam.tip").velocity),
        (second.joint("clamp").force, whole.joint("clamp").force),
        (second.joint("pivot").coordinates["angle"], whole.joint("pivot").coordinates["angle"]),
        (second.spring("coil").force, whole.spring("coil").force),
    ):
        scale = np.abs(expected).max()
        np.testing.assert_allclose(found, expected[FIRST:], rtol=0.0, atol=1e-8 * scale)
    assert whole.joint("pivot").coordinates["angle"][FIRST] > np.pi
    energy, balance = second.energy, np.abs(second.energy.balance)
    assert balance.max() < 3.0 * np.abs(whole.energy.balance).max()
    assert energy.work[0] == 0.0


def test_the_past_is_taken_over_and_not_the_present_alone(coarse, tmp_path):
    """Without its past the vibration would be another one."""
    model = machine(coarse, LAST, history="direct")
    start = first_run(model, tmp_path / "first.h5")
    second = simulate(model.with_settings(start=start)).frame("beam.tip").u
    whole = simulate(model).frame("beam.tip").u[FIRST:]
    assert np.abs(second - whole).max() < 1e-8 * np.abs(whole).max()
    assert np.abs(whole[1:] - whole[0]).max() > 1e-3 * np.abs(whole).max()


def test_a_latch_that_opens_lets_the_body_fly_on(coarse, tmp_path):
    """Momentum and spin of the released bodies are those before."""
    model = replace(
        machine(coarse, LAST), springs=(), contacts=(), stops=(), loads=(), gravity=[0, 0, 0]
    )
    start = first_run(model, tmp_path / "first.h5")
    free = replace(model, joints=model.joints[1:2]).with_settings(start=start)
    results = simulate(replace(free, bodies={name: free.bodies[name] for name in ("hub", "beam")}))
    linear, momentum = results.momentum.linear, results.momentum.angular
    scale = np.abs(linear).max()
    late = linear[1:]  # the joint opens within the first step
    np.testing.assert_allclose(late, late[[-1] * len(late)], rtol=0.0, atol=2e-3 * scale)
    np.testing.assert_allclose(linear[0], late[-1], rtol=0.0, atol=0.1 * scale)
    np.testing.assert_allclose(linear[-1], linear[-2], rtol=0.0, atol=1e-6 * scale)
    spin = np.abs(momentum).max()
    np.testing.assert_allclose(momentum[-1], momentum[-2], rtol=0.0, atol=1e-4 * spin)
    np.testing.assert_allclose(momentum[0], momentum[-1], rtol=0.0, atol=0.02 * spin)
    moved = results.body("hub").x[-1] - results.body("hub").x[0]
    assert np.linalg.norm(moved) > 1e-2


def test_a_new_joint_must_be_closed_where_the_state_begins(coarse, tmp_path):
    model = machine(coarse, LAST)
    start = first_run(model, tmp_path / "first.h5")
    hook = Spherical("ground", "arm.end", name="hook")
    with pytest.raises(StateError, match=r"joint 'hook': is open by 0\.\d+ m in the state"):
        simulate(replace(model, joints=(*model.joints, hook)).with_settings(start=start))
    end = simulate(model.with_settings(t_end=FIRST * H)).frame("arm.end").position[-1]
    model = replace(model, ground_frames={**model.ground_frames, "hook": Frame(end)})
    hook = replace(hook, frame_a="ground.hook")
    with pytest.raises(
        StateError, match=r"joint 'hook': opens at \d+.* closing it would need an impulse"
    ):
        simulate(replace(model, joints=(*model.joints, hook)).with_settings(start=start))


def driven(model, signal):
    return replace(model, joints=(*model.joints[:2], replace(model.joints[2], angle=signal)))


def test_a_joint_that_was_there_may_not_jump(coarse, tmp_path):
    model = machine(coarse, LAST)
    start, t = first_run(model, tmp_path / "first.h5"), FIRST * H
    angle = model.joints[2].angle
    value, (rate, _) = angle(t), angle.derivatives(t)
    moved = {**model.ground_frames, "pivot": Frame([0.1, 0.2, 0.302])}
    cases = {
        r"joint 'pivot': is open by 0\.002 m": replace(model, ground_frames=moved),
        r"joint 'wrist': is open by 0\.\d+ rad": driven(model, Harmonic(0.5, 30.0)),
        r"joint 'wrist': opens at \d+\.\d+ rad/s": driven(model, Polynomial([0, value / t])),
    }
    for message, other in cases.items():
        with pytest.raises(StateError, match=message):
            simulate(other.with_settings(start=start))
    cubic = Polynomial([0, 0, 3 * value / t**2 - rate / t, rate / t**2 - 2 * value / t**3])
    simulate(driven(model, cubic).with_settings(start=start))


def test_results_that_another_run_has_replaced_are_refused(coarse, tmp_path):
    model = machine(coarse, LAST)
    start = first_run(model, tmp_path / "first.h5")
    simulate(model, output=tmp_path / "other.h5")
    (tmp_path / "other.h5").rename(tmp_path / "first.h5")
    with pytest.raises(StateError, match=r"first.h5: the results and the state beside them are"):
        simulate(model.with_settings(start=start))


def test_the_run_to_start_from_is_not_replaced(coarse, tmp_path):
    """As by a model file that names its own results."""
    model, path = machine(coarse, LAST), tmp_path / "first.h5"
    model = model.with_settings(start=first_run(model, path))
    before = path.read_bytes()
    with pytest.raises(ResultsError, match=r"first.h5 is the run that the model starts from"):
        simulate(model, output=path)
    state = tmp_path / "first.h5.checkpoint"
    with pytest.raises(ResultsError, match=r"checkpoint is the state that the model starts from"):
        simulate(model, output=state)
    assert path.read_bytes() == before


def test_a_body_that_is_new_starts_as_the_model_says(coarse, tmp_path):
    model = machine(coarse, LAST)
    start = first_run(model, tmp_path / "first.h5")
    moon = RigidBody(1.0, [1, 1, 1], start=Start([5, 0, 0], velocity=[0, 2.0, 0]))
    other = replace(model, bodies={"moon": moon, **model.bodies}, gravity=[0, 0, 0])
    results = simulate(other.with_settings(start=start))
    np.testing.assert_allclose(
        results.body("moon").x[-1], [5, 2.0 * (LAST - FIRST) * H, 0], rtol=1e-9, atol=1e-12
    )
    known = simulate(model.with_settings(start=start)).frame("beam.tip").position[0]
    np.testing.assert_array_equal(results.frame("beam.tip").position[0], known)


def test_a_run_that_started_from_a_state_goes_on_to_the_bit(coarse, tmp_path):
    from .test_restart import assert_same

    model = machine(coarse, LAST, every=4)
    start = first_run(model, tmp_path / "first.h5")
    model = model.with_settings(start=start, checkpoint=1e3)
    simulate(model, output=tmp_path / "whole.h5")
    for end in (50, 61, LAST):
        part = model.with_settings(t_end=end * H)
        simulate(part, output=tmp_path / "parts.h5", resume=end > 50)
    (tmp_path / "first.h5").unlink()
    assert_same(tmp_path / "parts.h5", tmp_path / "whole.h5")


def changed_element(model, **changes):
    beam = model.bodies["beam"]
    element = replace(beam.superelement, **changes)
    return replace(model, bodies={**model.bodies, "beam": replace(beam, superelement=element)})


def test_what_does_not_fit_is_named(coarse, tmp_path):
    model = machine(coarse, LAST, history="direct")
    start = first_run(model, tmp_path / "first.h5")
    model = model.with_settings(start=start)
    rigid = RigidBody(0.0429, [1e-6, 1e-3, 1e-3], {"root": Frame(), "tip": Frame()})
    cases = {
        "body 'beam': its superelement is not that of the state": changed_element(model, mass=0.05),
        r"the state was computed with another step, rho_inf or rule \(h\)": model.with_settings(
            step=2 * H
        ),
        "body 'beam': its history was direct, is fft": model.with_settings(history="fft"),
        "body 'beam': was flexible, is rigid": replace(
            model, bodies={**model.bodies, "beam": rigid}
        ),
    }
    for message, other in cases.items():
        with pytest.raises(StateError, match=message):
            simulate(other)
    with pytest.raises(
        ModelError, match=r"t_end: expected more than the time of the state, 0.0185 s"
    ):
        simulate(model.with_settings(t_end=FIRST * H))
    with pytest.raises(ModelError, match="start: expected 'given', 'equilibrium' or"):
        model.with_settings(start="again")


def test_a_simulator_starts_from_a_state_too(coarse, tmp_path):
    model = machine(coarse, LAST, history="recursive")
    start = first_run(model, tmp_path / "first.h5")
    expected = simulate(model.with_settings(start=start)).frame("beam.tip").position
    simulator = Simulator(model.with_settings(start=start), ["frames/beam.tip/position"])
    assert simulator.time == FIRST * H
    for row in expected:
        np.testing.assert_array_equal(simulator.outputs, row)
        if simulator.time < LAST * H:
            simulator.step([])
    assert check(model.with_settings(start=start)).degrees_of_freedom == 1
    convolved = model.with_settings(history="direct")
    start = first_run(convolved, tmp_path / "direct.h5")
    with pytest.raises(ModelError, match="start: a Simulator continues a run only"):
        Simulator(convolved.with_settings(start=start), [])


def test_a_model_file_names_the_run_beside_it(coarse, tmp_path):
    write(tmp_path / "coarse.h5", coarse)
    model = machine(coarse, LAST)
    beam = replace(model.bodies["beam"], source=str(tmp_path / "coarse.h5"))
    model = replace(model, bodies={**model.bodies, "beam": beam}, springs=model.springs[:1])
    first_run(model, tmp_path / "first.h5")
    write_model(tmp_path / "model.toml", model)
    text = (tmp_path / "model.toml").read_text()
    (tmp_path / "model.toml").write_text(
        text.replace("[simulation]", '[simulation]\nstart = {from = "first.h5"}')
    )
    results = simulate(read_model(tmp_path / "model.toml"))
    assert results.time[0] == FIRST * H
    (tmp_path / "first.h5.checkpoint").unlink()
    with pytest.raises(StateError, match=r"first.h5.checkpoint: no such file: the run saved no"):
        simulate(read_model(tmp_path / "model.toml"))


def test_a_written_model_names_the_first_run_by_its_place(tmp_path, monkeypatch):
    """Relative to the file, wherever it is read from."""
    monkeypatch.chdir(tmp_path)
    model = Model({"b": RigidBody(1.0, [1, 1, 1])}, settings=Settings(t_end=1.0, step=H))
    (tmp_path / "runs").mkdir()
    write_model("runs/second.toml", model.with_settings(start={"from": "runs/first.h5"}))
    assert 'from = "first.h5"' in (tmp_path / "runs" / "second.toml").read_text()
    assert read_model("runs/second.toml").settings.start.path == "runs/first.h5"


def test_the_results_of_the_first_run_are_not_replaced(coarse, tmp_path):
    path = tmp_path / "first.h5"
    start = first_run(machine(coarse, LAST), path)
    before = path.read_bytes()
    message = f"^{path} is the run that the model starts from, which the results would replace$"
    with pytest.raises(ResultsError, match=message):
        simulate(machine(coarse, LAST).with_settings(start=start), output=path)
    assert path.read_bytes() == before
