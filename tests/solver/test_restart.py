"""Runs that go on from the state that they kept: to the bit those that were never interrupted."""

import os
import re
import signal
import subprocess
import sys
import time
from dataclasses import replace
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from duhamel.results import Results, ResultsError
from duhamel.solver import (
    Contact,
    ConvergenceError,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Function,
    Harmonic,
    Impact,
    Model,
    ModelError,
    OutOfRangeError,
    OutputRequest,
    Place,
    Revolute,
    RigidBody,
    Settings,
    Spring,
    Start,
    StateError,
    Steps,
    Stop,
    TabulatedLaw,
    Torque,
    simulate,
    simulation,
    write_model,
)
from duhamel.solver.checkpoint.file import read_state
from duhamel.solver.control import RUN_CONTROL, RunControl
from duhamel.solver.output.keeper import checkpoint_of
from duhamel.solver.step.system import State, Workspace
from duhamel.superelement import sample_kernel, write

H, STEPS = 5e-4, 80
FREE = {"seconds", "run"}
HISTORIES = ("recursive", "fft", "direct")


@pytest.fixture(autouse=True)
def _small_blocks(monkeypatch):
    monkeypatch.setattr("duhamel.solver.history.dyadic.DIRECT_STEPS", 8)


def machine(element, steps=STEPS, every=1, **settings):
    """A hub that turns many times, with a beam that hits a bumper; a driven arm between limits, a
    stop, and loads of all kinds.
    """
    hub = RigidBody(
        0.01,
        [0.006, 0.007, 0.01],
        {"rim": Frame([0.05, 0, 0]), "pin": Frame([0, 0.05, 0])},
        Start(angular_velocity=[0, 0, 300.0], position=[0.1, 0.2, 0.3]),
    )
    arm = RigidBody(
        0.02,
        [1e-4, 2e-4, 2e-4],
        {"pin": Frame([-0.05, 0, 0]), "end": Frame([0.05, 0, 0])},
        Start(place=Place("pin", "hub.pin")),
    )
    beam = FlexibleBody(element, Start(place=Place("root", "hub.rim")))
    stop = TabulatedLaw([-1.0, 0.0, 0.02], [0.0, 0.0, 50.0])
    bump = Contact(
        "bump",
        ("ground.bumper", "beam.tip"),
        "sphere",
        ball=0.05,
        radius=0.3,
        impact=Impact(stiffness=200.0, restitution=0.8),
        friction=0.3,
        tangential_stiffness=50.0,
    )
    return Model(
        bodies={"hub": hub, "beam": beam, "arm": arm},
        joints=(
            Revolute("ground.pivot", "hub", [0, 0, 1], name="pivot"),
            Fixed("hub.rim", "beam.root", name="clamp"),
            Revolute("hub.pin", "arm.pin", [0, 0, 1], name="wrist", angle=Harmonic(0.3, 30.0)),
        ),
        loads=(
            Torque("hub", [0, 0, 1], Steps((0.0, 0.0131), (1.0, -2.0))),
            Force("beam.tip", [0, 3, 0], Harmonic(1.0, 70.0), follower=True),
        ),
        springs=(
            Spring("coil", "bushing", ("ground", "beam.tip"), stiffness=[5.0] * 6),
            Spring("stop", "point", ("ground.wall", "arm.end"), law=stop),
        ),
        contacts=(bump,),
        stops=(Stop("limit", "wrist", "angle", [-0.1, 0.2], Impact(stiffness=1.0)),),
        ground_frames={
            "pivot": Frame([0.1, 0.2, 0.3]),
            "wall": Frame([0.1, 0.5, 0.3]),
            "bumper": Frame([-0.7, 0.2, 0.3]),
        },
        gravity=[0, -9.81, 0],
        settings=Settings(step=H, t_end=steps * H, output=OutputRequest(every), **settings),
    )


def contents(path):
    """The datasets and attributes of a results file that do not depend on when it was made."""
    with h5py.File(path) as file:
        found = {name: item[()] for name, item in file.items() if isinstance(item, h5py.Dataset)}
        notes = {key: value for key, value in file["solver"].attrs.items() if key not in FREE}
        return found, {**notes, "model": file.attrs["model"]}


def assert_same(left, right):
    (found, notes), (expected, expected_notes) = contents(left), contents(right)
    assert found.keys() == expected.keys()
    for name, array in expected.items():
        np.testing.assert_array_equal(found[name], array, err_msg=name)
    assert notes == expected_notes


def in_parts(model, path, *ends):
    """A run to each of the steps in turn, from the state at the one before."""
    for number, end in enumerate(ends):
        part = model.with_settings(t_end=end * H, checkpoint={"every": 29})
        results = simulate(part, output=path, resume=number > 0)
    return results


@pytest.mark.parametrize("history", HISTORIES)
@pytest.mark.parametrize("ends", [(13, 80), (1, 2, 7, 8, 9, 31, 64, 65, 79, 80)])
def test_a_run_in_parts_is_that_in_one_to_the_bit(coarse, history, ends, tmp_path):
    model = machine(coarse, history=history)
    simulate(model, output=tmp_path / "whole.h5")
    results = in_parts(model, tmp_path / "parts.h5", *ends)
    assert_same(tmp_path / "parts.h5", tmp_path / "whole.h5")
    assert np.ptp(results.joint("pivot").coordinates["angle"]) > 2.0 * np.pi


@pytest.mark.parametrize("history", HISTORIES)
@pytest.mark.parametrize("between", ["events", "in bump", "in limit"])
def test_a_run_goes_on_in_the_middle_of_a_contact(coarse, history, between, tmp_path):
    """The contact that the state found closed is one event, not two; none is missing or twice."""
    model, path = machine(coarse, history=history), tmp_path / "parts.h5"
    events = simulate(model, output=tmp_path / "whole.h5").events
    bumps, limits = events["bump"], events["limit"]
    assert bumps.impacts >= 1
    assert limits.impacts >= 2
    end = {
        "events": int(limits.end[0] / H) + 2,
        "in bump": int(bumps.start[0] / H) + 2,
        "in limit": int(0.5 * (limits.start[1] + limits.end[1]) / H),
    }[between]
    first = in_parts(model, path, end)
    still = [e for e in first.events.values() for k in np.flatnonzero(e.still_closed)]
    assert bool(still) == (between != "events")
    in_parts(model, path, end, 80)
    assert_same(path, tmp_path / "whole.h5")


@pytest.mark.parametrize(
    "settings",
    [
        {"every": 3, "history": "fft"},
        *({"rule": "paper", "history": history} for history in HISTORIES),
        {"history": "auto"},
    ],
)
def test_it_is_so_with_other_settings(coarse_beam, settings, tmp_path):
    model = machine(coarse_beam.element, **settings)
    simulate(model, output=tmp_path / "whole.h5")
    in_parts(model, tmp_path / "parts.h5", 37, 50, 80)
    assert_same(tmp_path / "parts.h5", tmp_path / "whole.h5")


def test_rows_play_no_part_in_steps_of_fixed_iterations(coarse, tmp_path):
    """A part records its last step, which the whole run does not."""
    model = machine(coarse, 60, every=7, fixed_iterations=3)
    simulate(model, output=tmp_path / "whole.h5")
    in_parts(model, tmp_path / "parts.h5", 37, 50, 60)
    assert_same(tmp_path / "parts.h5", tmp_path / "whole.h5")


def damped(element):
    modes = replace(element.modes, zeta=np.full_like(element.modes.zeta, 0.7))
    kernel = sample_kernel(modes, H, element.kernel.scheme, 500)
    return replace(element, modes=modes, kernel=kernel)


@pytest.mark.parametrize("history", ["fft", "direct"])
def test_it_is_so_where_memory_ends(coarse, history, tmp_path):
    model = machine(damped(coarse), history=history, kernel_length=25 * H)
    whole = simulate(model, output=tmp_path / "whole.h5")
    assert whole.solver["truncation"] > 0.0
    in_parts(model, tmp_path / "parts.h5", 37, 50, 80)
    assert_same(tmp_path / "parts.h5", tmp_path / "whole.h5")
    in_parts(model, tmp_path / "short.h5", 20)
    with pytest.raises(StateError, match="'beam': memory: its impulse responses are truncated in"):
        simulate(model, output=tmp_path / "short.h5", resume=True)


@pytest.mark.parametrize("form", ["fft", "direct"])
def test_it_is_so_for_a_body_without_modes(random_element, measured, form, tmp_path):
    element = replace(random_element(1, (True, True)), modes=None)
    body = FlexibleBody(element, Start(angular_velocity=[0, 0, 90.0]))
    model = Model(
        {"b": body},
        loads=(Force("b.i0", [0, 1, 0], Harmonic(1e-3, 50.0)),),
        settings=Settings(t_end=0.15, history=form),
    )
    simulate(model, output=tmp_path / "whole.h5")
    for t_end in (0.05, 0.15):
        part = model.with_settings(t_end=t_end, checkpoint=1e3)
        simulate(part, output=tmp_path / "parts.h5", resume=t_end > 0.05)
    assert_same(tmp_path / "parts.h5", tmp_path / "whole.h5")


def test_nothing_else_is_carried_from_step_to_step(coarse, tmp_path, monkeypatch):
    """What a checkpoint does not bring would be no number."""
    model, poisoned = machine(coarse, history="fft"), []
    simulate(model, output=tmp_path / "whole.h5")
    in_parts(model, tmp_path / "parts.h5", 37)

    def allocated(lowered):
        state, work = real(lowered)
        for record in (state, work):
            for array in record.arrays():
                array[...] = -(2**40) if array.dtype == np.int64 else np.nan
        poisoned.append((type(state), type(work)))
        return state, work

    real = simulation.allocate
    monkeypatch.setattr(simulation, "allocate", allocated)
    simulate(model.with_settings(checkpoint=1e3), output=tmp_path / "parts.h5", resume=True)
    assert poisoned == [(State, Workspace)]
    assert_same(tmp_path / "parts.h5", tmp_path / "whole.h5")


def interrupting(model, at, error):
    """The model with a load of nothing that ends the run once, when it asks for step `at`."""
    done = []

    def value(t):
        if round(t / H) >= at and not done:
            done.append(t)
            raise error
        return 0.0

    return replace(model, loads=(*model.loads, Force("hub", [1, 0, 0], Function(value))))


@pytest.mark.parametrize("at", [0, 1, 17, 80])
def test_a_run_goes_on_after_an_interrupt(coarse, at, tmp_path):
    model = machine(coarse, checkpoint=1e3)
    simulate(interrupting(model, 10**9, OSError()), output=tmp_path / "whole.h5")
    broken = interrupting(model, at, KeyboardInterrupt())
    path = tmp_path / "parts.h5"
    with pytest.raises(KeyboardInterrupt):
        simulate(broken, output=path)
    if at == 0:  # there was no state yet
        with pytest.raises(StateError, match=f"{path}: no such file: there is no run to continue"):
            simulate(broken, output=path, resume=True)
        return
    assert read_state(tmp_path / "parts.h5.checkpoint").snapshot.step < at
    simulate(broken, output=path, resume=True)
    assert_same(path, tmp_path / "whole.h5")


def test_a_run_that_fails_keeps_the_state_before(coarse, tmp_path):
    model, path = machine(coarse, checkpoint={"every": 10}), tmp_path / "out.h5"
    kick = Force("beam.tip", [1, 0, 0], Steps((0.0, 55.5 * H), (0.0, 1e60)))
    failing = replace(model, loads=(*model.loads, kick))
    with pytest.raises((ConvergenceError, OutOfRangeError), match=r"step 5[56]"):
        simulate(failing, output=path)
    assert 50 <= read_state(tmp_path / "out.h5.checkpoint").snapshot.step <= 55
    assert len(Results.read(path).time) >= 51


@pytest.mark.parametrize("earlier", [False, True])
def test_a_run_that_goes_on_and_is_stopped_at_once_keeps_its_rows(coarse, earlier, tmp_path):
    model, path = machine(coarse, 40, checkpoint={"every": 8}), tmp_path / "out.h5"
    if earlier:
        simulate(model.with_settings(t_end=20 * H), output=path)
    simulate(interrupting(model, 10**9, OSError()), output=tmp_path / "whole.h5")
    with pytest.raises(KeyboardInterrupt):
        simulate(interrupting(model, 25, KeyboardInterrupt()), output=path)
    before = {entry.name for entry in tmp_path.iterdir()}
    token = RUN_CONTROL.set(control := RunControl())
    try:
        control.stop()
        with pytest.raises(KeyboardInterrupt, match="--continue goes on from that"):
            simulate(interrupting(model, 10**9, OSError()), output=path, resume=True)
    finally:
        RUN_CONTROL.reset(token)
    # As by Ctrl-C in the first batch.
    with pytest.raises(KeyboardInterrupt, match="--continue goes on from that"):
        simulate(interrupting(model, 0, KeyboardInterrupt()), output=path, resume=True)
    assert {entry.name for entry in tmp_path.iterdir()} == before
    simulate(interrupting(model, 10**9, OSError()), output=path, resume=True)
    assert_same(path, tmp_path / "whole.h5")


@pytest.mark.parametrize("earlier", [False, True])
def test_a_run_that_goes_on_and_fails_at_once_keeps_its_rows(coarse, earlier, tmp_path):
    model, path = machine(coarse, 40, checkpoint={"every": 5}), tmp_path / "out.h5"
    if earlier:
        simulate(model.with_settings(t_end=20 * H), output=path)
    kick = Force("beam.tip", [1, 0, 0], Steps((0.0, 25.5 * H), (0.0, 1e60)))
    failing = replace(model, loads=(*model.loads, kick))
    for resume in (False, True, True):
        with pytest.raises((ConvergenceError, OutOfRangeError), match=r"step 2[56]"):
            simulate(failing, output=path, resume=resume)
        file = tmp_path / ("out.h5.partial" if earlier else "out.h5")
        assert len(Results.read(file).time) >= 25
        assert read_state(checkpoint_of(file)).snapshot.step == 20


def test_rows_after_the_state_are_written_anew(coarse, tmp_path):
    """As after a kill between two states."""
    model, path = machine(coarse), tmp_path / "out.h5"
    simulate(model, output=tmp_path / "whole.h5")
    in_parts(model, path, 30)
    state = (tmp_path / "out.h5.checkpoint").read_bytes()
    in_parts(model, path, 30, 50)
    (tmp_path / "out.h5.checkpoint").write_bytes(state)
    with h5py.File(path, "r+") as file:  # the second run is another one
        file["solver"].attrs["run"] = read_state(tmp_path / "out.h5.checkpoint").run
        file["body_position"][31:] = 7.0
    simulate(model.with_settings(checkpoint=1e3), output=path, resume=True)
    assert_same(path, tmp_path / "whole.h5")


def test_a_shorter_t_end_than_the_state_is_refused(coarse, tmp_path):
    model = machine(coarse)
    in_parts(model, tmp_path / "out.h5", 30)
    message = "t_end: expected the time of the state, 0.015 s, or more, got 0.01"
    with pytest.raises(ModelError, match=message):
        simulate(model.with_settings(t_end=0.01), output=tmp_path / "out.h5", resume=True)
    results = simulate(model.with_settings(t_end=0.015), output=tmp_path / "out.h5", resume=True)
    assert len(results.time) == 31


def test_a_run_that_has_ended_keeps_its_last_row(coarse, tmp_path):
    """Also where the last step is not one of those that are recorded on the way."""
    model = machine(coarse, every=7)
    simulate(model, output=tmp_path / "whole.h5")
    in_parts(model, tmp_path / "parts.h5", 37, 80, 80, 80)
    assert_same(tmp_path / "parts.h5", tmp_path / "whole.h5")


def test_an_end_at_a_state_whose_step_was_not_recorded_is_refused(coarse, tmp_path):
    """Its row is not there, and no step is left that would give it."""
    model, path = machine(coarse, every=7), tmp_path / "out.h5"
    broken = interrupting(model.with_settings(checkpoint={"every": 29}), 40, KeyboardInterrupt())
    with pytest.raises(KeyboardInterrupt):
        simulate(broken, output=path)
    step = read_state(tmp_path / "out.h5.checkpoint").snapshot.step
    assert step % 7
    message = f"t_end: expected more than the time of the state, {step * H:.9g} s, got"
    with pytest.raises(ModelError, match=message):
        simulate(broken.with_settings(t_end=step * H), output=path, resume=True)
    simulate(broken, output=path, resume=True)
    simulate(broken, output=tmp_path / "whole.h5")
    assert_same(path, tmp_path / "whole.h5")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"tolerance": 1e-9}, "simulation.tolerance: was 1e-10, is 1e-09"),
        ({"history": "direct"}, "simulation.history: was 'auto', is 'direct'"),
        ({"output": OutputRequest(2)}, "output.every: was 1, is 2"),
        ({"gravity": [0, -9.8, 0]}, "simulation.gravity: was .*-9.81.*, is .*-9.8"),
        ({"springs": ()}, "springs.coil.*was .* is no longer there"),
        (
            {
                "ground_frames": {
                    "pivot": Frame([0, 0, 1]),
                    "wall": Frame([0, 2, 0]),
                    "bumper": Frame([0, 3, 0]),
                }
            },
            "ground.frames.pivot.position: was",
        ),
        ({"arm": 0.03}, "bodies.arm.mass: was 0.02, is 0.03"),
        ({"beam": 1.0001}, "bodies.beam.superelement: was '[0-9a-f]*', is '[0-9a-f]*'"),
        ({"torque": 3.0}, "loads.1.signal.values: was .*1.0, -2.0.*, is .*1.0, 3.0"),
    ],
)
def test_a_changed_model_is_refused_by_the_key(coarse, change, message, tmp_path):
    model = machine(coarse, 20)
    in_parts(model, tmp_path / "out.h5", 10)
    with pytest.raises(StateError, match=message) as caught:
        simulate(changed(model, **change), output=tmp_path / "out.h5", resume=True)
    assert "\n" not in str(caught.value)
    assert len(Results.read(tmp_path / "out.h5").time) == 11


def changed(model, arm=None, beam=None, torque=None, **values):
    bodies, (first, *loads) = dict(model.bodies), model.loads
    if arm is not None:
        bodies["arm"] = replace(bodies["arm"], mass=arm)
    if beam is not None:
        element = bodies["beam"].superelement
        element = replace(element, mass=beam * element.mass)
        bodies["beam"] = replace(bodies["beam"], superelement=element)
    if torque is not None:
        first = replace(first, signal=replace(first.signal, values=(1.0, torque)))
    settings = {key: values.pop(key) for key in list(values) if hasattr(model.settings, key)}
    model = replace(model, bodies=bodies, loads=(first, *loads), **values)
    return model.with_settings(**settings)


def test_a_changed_model_is_accepted_anyway_where_it_has_the_same_unknowns(coarse, tmp_path):
    model, path = machine(coarse, 20), tmp_path / "out.h5"
    in_parts(model, path, 10)
    results = simulate(changed(model, torque=3.0), output=path, resume=True, force=True)
    assert len(results.time) == 21
    in_parts(model, path, 10)
    with pytest.raises(StateError, match=r"expected float64 .*found"):
        simulate(replace(model, springs=()), output=path, resume=True, anyway=True)


def test_other_software_is_refused_by_name(coarse, tmp_path):
    path, state = tmp_path / "out.h5", tmp_path / "out.h5.checkpoint"
    model = machine(coarse, 20)
    in_parts(model, path, 10)
    kept = read_state(state)
    for name in kept.identity.software:
        software = {**kept.identity.software, name: "0.0"}
        replace(kept, identity=replace(kept.identity, software=software)).write(state)
        with pytest.raises(StateError, match=f"{name}: was '0.0', is "):
            simulate(model, output=path, resume=True)


def test_another_compiler_is_refused_for_it_rounds_otherwise(coarse, tmp_path, monkeypatch):
    model = machine(coarse, 20)
    in_parts(model, tmp_path / "out.h5", 10)
    monkeypatch.setenv("DUHAMEL_COMPILER", "stock")
    with pytest.raises(StateError, match="compiler of the time step: was 'quick', is 'stock'"):
        simulate(model, output=tmp_path / "out.h5", resume=True)


def test_what_is_missing_or_of_another_run_is_named(coarse, tmp_path):
    model, path, state = machine(coarse, 20), tmp_path / "out.h5", tmp_path / "out.h5.checkpoint"
    with pytest.raises(StateError, match=f"{path}: no such file: there is no run to continue"):
        simulate(model, output=path, resume=True)
    simulate(model, output=path)
    with pytest.raises(StateError, match=f"{state}: no such file: the run saved no state"):
        simulate(model, output=path, resume=True)
    in_parts(model, path, 10)
    kept = state.read_bytes()
    in_parts(model, path, 10)
    state.write_bytes(kept)
    with pytest.raises(ResultsError, match=f"{path}: these results are not of the run"):
        simulate(model, output=path, resume=True)
    with pytest.raises(StateError, match="resume: expected the file of the results as output"):
        simulate(model, resume=True)


def test_results_with_fewer_rows_than_the_state_are_refused(coarse, tmp_path):
    model, path = machine(coarse, 20), tmp_path / "out.h5"
    in_parts(model, path, 10)
    with h5py.File(path, "r+") as file:
        file["solver"].attrs.modify("written", 5)
    with pytest.raises(
        ResultsError, match=f"{path}: expected 11 rows or more, as in the state.* 5$"
    ):
        simulate(model, output=path, resume=True)


def test_a_damaged_state_is_one_line(coarse, tmp_path):
    model, path, state = machine(coarse, 20), tmp_path / "out.h5", tmp_path / "out.h5.checkpoint"
    in_parts(model, path, 10)
    whole, rng = state.read_bytes(), np.random.default_rng(0)
    for number in range(60):
        damaged = bytearray(whole)
        if number % 3:
            for at in rng.integers(len(whole), size=1 + number % 5).tolist():
                damaged[at] ^= 1 << int(rng.integers(8))
        else:
            del damaged[int(rng.integers(len(whole))) :]
        state.write_bytes(damaged)
        with pytest.raises((StateError, ResultsError), match=f"^{state}: ") as caught:
            simulate(model, output=path, resume=True)
        assert "\n" not in str(caught.value)


def test_a_pipe_in_the_place_of_a_state_is_one_line(coarse, tmp_path):
    model, state = machine(coarse, 20), tmp_path / "out.h5.checkpoint"
    in_parts(model, tmp_path / "out.h5", 10)
    state.unlink()
    os.mkfifo(state)
    with pytest.raises(StateError, match=f"^{state}: .*expected a regular file, found a pipe$"):
        simulate(model, output=tmp_path / "out.h5", resume=True)


def test_an_earlier_state_stays_where_a_new_one_cannot_be_written(coarse, tmp_path, monkeypatch):
    from duhamel.files import outputs

    model, path, state = machine(coarse, 20), tmp_path / "out.h5", tmp_path / "out.h5.checkpoint"
    calls = []

    def full(handle):
        calls.append(handle)
        if len(calls) > 2:  # the first state and its folder
            raise OSError(28, "No space left on device")
        os.fsync(handle)

    monkeypatch.setattr(outputs, "os", SimpleNamespace(**{**vars(os), "fsync": full}))
    message = f"^{state}: cannot be written: No space left on device; the state of step 0 stays$"
    with pytest.raises(ResultsError, match=message):
        simulate(model.with_settings(checkpoint={"every": 5}), output=path)
    assert read_state(state).snapshot.step == 0
    monkeypatch.undo()
    monkeypatch.setattr("duhamel.solver.history.dyadic.DIRECT_STEPS", 8)
    simulate(model, output=path, resume=True)
    simulate(model, output=tmp_path / "whole.h5")
    assert_same(path, tmp_path / "whole.h5")


def test_an_earlier_result_and_its_state_stay_until_the_run_has_ended(coarse, tmp_path):
    model, path = machine(coarse, 20, checkpoint={"every": 3}), tmp_path / "out.h5"
    simulate(model, output=path)
    first = contents(path)[0]
    state = (tmp_path / "out.h5.checkpoint").read_bytes()
    longer = model.with_settings(t_end=40 * H)
    with pytest.raises(KeyboardInterrupt, match=f"its 2[0-9] rows are in {path}.partial"):
        simulate(interrupting(longer, 25, KeyboardInterrupt()), output=path)
    np.testing.assert_array_equal(contents(path)[0]["body_position"], first["body_position"])
    assert (tmp_path / "out.h5.checkpoint").read_bytes() == state
    names = ["out.h5", "out.h5.checkpoint", "out.h5.partial", "out.h5.partial.checkpoint"]
    assert sorted(entry.name for entry in tmp_path.iterdir()) == names
    simulate(interrupting(longer, 10**9, OSError()), output=path, resume=True)
    assert sorted(entry.name for entry in tmp_path.iterdir()) == names[:2]
    assert len(Results.read(path).time) == 41
    simulate(model.with_settings(checkpoint=None), output=path)
    assert [entry.name for entry in tmp_path.iterdir()] == ["out.h5"]


def test_no_state_of_a_run_without_results_is_left(coarse, tmp_path):
    """Neither of one that failed in its first step, nor of an earlier one at the same path."""
    model, path = machine(coarse, 20), tmp_path / "out.h5"
    simulate(model, output=path)
    kept = model.with_settings(checkpoint=1e3)
    with pytest.raises(KeyboardInterrupt):
        simulate(interrupting(kept, 1, KeyboardInterrupt()), output=path)
    assert [entry.name for entry in tmp_path.iterdir()] == ["out.h5"]
    with pytest.raises(KeyboardInterrupt):
        simulate(interrupting(kept, 18, KeyboardInterrupt()), output=path)
    assert (tmp_path / "out.h5.partial.checkpoint").exists()
    simulate(model, output=path)
    assert [entry.name for entry in tmp_path.iterdir()] == ["out.h5"]


DUHAMEL = [sys.executable, "-c", "from duhamel.cli.app import app; app()"]


@pytest.fixture(scope="module")
def model_file(coarse, tmp_path_factory):
    """A model file of many steps, and the results of a run that was never interrupted."""
    folder = tmp_path_factory.mktemp("model")
    write(folder / "coarse.h5", coarse)
    hub = RigidBody(0.01, [0.006, 0.007, 0.01], {"rim": Frame([0.05, 0, 0])})
    place = Start(place=Place("root", "hub.rim"))
    model = Model(
        {"hub": hub, "beam": FlexibleBody(coarse, place, str(folder / "coarse.h5"))},
        joints=(
            Revolute("ground", "hub", [0, 0, 1], name="pivot"),
            Fixed("hub.rim", "beam.root", name="clamp"),
        ),
        loads=(Torque("hub", [0, 0, 1], Harmonic(0.05, 3.0)),),
        settings=Settings(t_end=12_000 * H, step=H, checkpoint=0.05),
    )
    write_model(folder / "model.toml", model)
    subprocess.run([*DUHAMEL, "run", "model.toml", "-o", "whole.h5"], cwd=folder, check=True)
    return folder / "model.toml"


def run(model_file, output, *options, limit=""):
    command = [*DUHAMEL, "run", str(model_file), "-o", str(output), *options]
    if limit:
        command = ["bash", "-c", f'ulimit -f {limit}; exec "$@"', "bash", *command]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def test_a_run_that_is_killed_again_and_again_goes_on_to_the_bit(model_file, tmp_path):
    """At moments of its steps and of its writes."""
    path, rng = tmp_path / "out.h5", np.random.default_rng(0)
    options = []
    for _ in range(4):
        with run(model_file, path, *options) as process:
            while process.poll() is None and not (tmp_path / "out.h5.checkpoint").exists():
                time.sleep(0.01)
            time.sleep(rng.uniform(0.0, 0.6))
            process.send_signal(signal.SIGKILL)
        results = Results.read(path)
        assert len(results.time) == results.solver["written"] > 0
        options = ["--continue"]
    with run(model_file, path, "--continue") as process:
        assert process.communicate()[1].strip() == ""
    assert_same(path, model_file.with_name("whole.h5"))
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["out.h5", "out.h5.checkpoint"]


def test_a_run_goes_on_when_the_disk_has_room_again(model_file, tmp_path):
    path = tmp_path / "out.h5"
    with run(model_file, path, limit=12_000) as process:
        output, errors = process.communicate()
    assert process.returncode == 1, output
    assert errors.strip().startswith(f"error: {path}: cannot be written: File too large; ")
    assert errors.endswith(" rows are in it\n")
    assert len(Results.read(path).time) == int(errors.split()[-5])
    with run(model_file, path, "--continue") as process:
        assert process.communicate()[1].strip() == ""
    assert_same(path, model_file.with_name("whole.h5"))


def test_an_interrupt_is_one_line(model_file, tmp_path):
    path = tmp_path / "out.h5"
    with run(model_file, path) as process:
        while process.poll() is None and not (tmp_path / "out.h5.checkpoint").exists():
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        (told,) = process.communicate()[1].splitlines()
        assert re.fullmatch(
            rf"interrupted at t = \S+ s of \S+ s; its [0-9]+ rows are in {path}, "
            "and its last state beside them: --continue goes on from that",
            told,
        )
    assert process.returncode == 130
    with run(model_file, path, "--continue") as process:
        assert process.communicate()[1].strip() == ""
    assert_same(path, model_file.with_name("whole.h5"))
