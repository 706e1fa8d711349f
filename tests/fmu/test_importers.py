"""What importers do: states, errors, intermediate steps, several instances, odd paths."""

import ctypes
import shutil
import threading
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from duhamel import fmu
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

from .importers import Slave
from .machines import MACHINES, box, rod, servo, values

VERSIONS = pytest.mark.parametrize("version", [3, 2])


@pytest.fixture(scope="module")
def of_rod(exported):
    model = rod()
    return {version: exported(model, version=version) for version in (3, 2)}


def run(instance, inputs, h, first=0, start=0.0):
    rows = []
    for n, value in enumerate(inputs, first):
        instance.set(inputs__u=value)
        instance.step(start + n * h, h)
        rows.append(instance.values())
    return np.array(rows)


@pytest.mark.parametrize(
    ("machine", "version"),
    [*((machine, 3) for machine in MACHINES), ("servo", 2), ("box", 2), ("rotor", 2)],
)
def test_exports_are_valid(machine, version, exported):
    make, more = MACHINES[machine]
    made = exported(make(**more), version=version, outputs=["*"], parameters=["*"])
    assert validate_fmu(str(made.path)) == []


@VERSIONS
def test_a_state_goes_back_to_the_bit_in_any_instance(version, of_rod, slave):
    made, inputs = of_rod[version], values(rod(), 300)
    h = made.experiment.step
    one, other = slave(made.path), slave(made.path)
    run(one, inputs[:100], h)
    state = one.fmu.getFMUState()
    content = one.bytes_of(state)
    expected = run(one, inputs[100:], h, 100)
    one.fmu.setFMUState(state)
    np.testing.assert_array_equal(run(one, inputs[100:], h, 100), expected)
    # The other one has done something else meanwhile.
    run(other, inputs[50:60], h)
    put = other.state_of(content)
    other.fmu.setFMUState(put)
    np.testing.assert_array_equal(run(other, inputs[100:], h, 100), expected)
    one.fmu.freeFMUState(state)
    other.fmu.freeFMUState(put)


@VERSIONS
def test_the_state_of_another_export_is_refused(version, of_rod, exported, slave):
    other = slave(exported(box(), version=version).path)
    content = other.bytes_of(other.fmu.getFMUState())
    one = slave(of_rod[version].path)
    with pytest.raises(FMICallException):
        one.state_of(content)
    with pytest.raises(FMICallException):
        one.state_of(content[:40])
    assert one.log == ["expected a state of this export, got one of another"] * 2


@VERSIONS
def test_parameters_are_those_of_a_model_that_has_them(version, exported, slave):
    wanted = ["motors/elbow servo/*", "springs/return/*", "joints/pivot/*", "gravity"]
    inputs = values(servo(), 800)
    made = exported(servo(), version=version, parameters=wanted, outputs=["joints/*", "motors/*"])
    changed = {
        "motors.'elbow servo'.stiffness": 60.0,
        "motors.'elbow servo'.upper_limit": 4.0,
        "springs.return.stiffness": 5.0,
        "joints.pivot.sliding_friction": 0.15,
        "gravity[2]": -8.0,
    }
    instance = slave(made.path, begin=False)
    starts = {v.name: v.start for v in instance.description.modelVariables if v.start}
    assert float(starts["motors.'elbow servo'.stiffness"]) == 40.0
    assert float(starts["motors.'elbow servo'.lower_limit"]) == -6.0
    instance.begin()
    before = run(instance, inputs[:100], made.experiment.step)
    instance.set_named(changed)
    state = instance.fmu.getFMUState()
    after = run(instance, inputs[100:], made.experiment.step, 100)
    # Parameters belong to the state, and are those of one instance alone.
    untouched = slave(made.path)
    np.testing.assert_array_equal(run(untouched, inputs[:100], made.experiment.step), before)
    assert not np.array_equal(run(untouched, inputs[100:], made.experiment.step, 100), after)
    untouched.fmu.setFMUState(untouched.state_of(instance.bytes_of(state)))
    np.testing.assert_array_equal(run(untouched, inputs[100:], made.experiment.step, 100), after)
    instance.fmu.reset()
    instance.begin()
    np.testing.assert_array_equal(run(instance, inputs[:100], made.experiment.step), before)


def test_a_changed_gain_is_that_of_the_motor(exported, slave):
    """From the first step on, a gain that is set is one of the model."""
    plain = exported(servo(), outputs=["joints/*"])
    tuned = exported(servo(), outputs=["joints/*"], parameters=["motors/elbow servo/damping"])
    other = exported(_with_damping(servo(), 2.5), outputs=["joints/*"])
    inputs, h = values(servo(), 400), plain.experiment.step
    instance = slave(tuned.path, begin=False)
    instance.set_named({"motors.'elbow servo'.damping": 2.5})
    instance.begin()
    found = run(instance, inputs, h)
    np.testing.assert_array_equal(found, run(slave(other.path), inputs, h))
    assert not np.array_equal(found, run(slave(plain.path), inputs, h))


@VERSIONS
def test_a_motor_without_limits_has_infinite_ones(version, exported, slave):
    (motor,) = servo().motors
    model = replace(servo(), motors=(replace(motor, limit=None, tracking_time=None),))
    made = exported(model, version=version, parameters=["motors/*"])
    assert validate_fmu(str(made.path)) == []
    one = slave(made.path)
    assert one.get_number(one.numbers["motors.'elbow servo'.upper_limit"]) == np.inf
    one.set_named({"motors.'elbow servo'.upper_limit": 5.0})
    one.step(0.0, made.experiment.step)


def test_what_follows_gains_and_stays_is_told(exported):
    (motor,) = servo().motors
    model = replace(servo(), motors=(replace(motor, tracking_time=None),))
    made = exported(model, parameters=["motors/elbow servo/damping"])
    (note,) = [note for note in made.notes if "tracking" in note]
    assert note == "motors/elbow servo: tracking_time stays 0.447214 s when its gains change"
    assert not any("tracking" in note for note in exported(model).notes)


def _with_damping(model, damping):
    (motor,) = model.motors
    return replace(model, motors=(replace(motor, damping=damping),))


@VERSIONS
@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda one: one.step(0.0, 1.7e-4), "expected a multiple of the internal step 0.0001 s"),
        (lambda one: one.step(0.0, 0.0), "communicationStepSize: expected"),
        (lambda one: one.step(0.0, float("nan")), "communicationStepSize: expected"),
        (lambda one: one.step(1.0, 1e-4), "currentCommunicationPoint: expected 0 s, got 1"),
        (lambda one: one.step(0.0, 0.2), "ends after stopTime 0.05 s"),
        (lambda one: one.set(inputs__u=float("nan")), "expected a number, got nan"),
        (lambda one: one.set(inputs__u=float("inf")), "expected a number, got inf"),
        (lambda one: one.set_number(99, 1.0), "value reference 99: expected an input"),
        (lambda one: one.set_number(2, 1.0), "value reference 2: expected an input"),
        (lambda one: one.get_number(99), "value reference 99: expected that of a real"),
        (lambda one: one.fmu.exitInitializationMode(), "ExitInitializationMode: not allowed now"),
    ],
)
def test_what_importers_get_wrong_is_told(call, told, version, of_rod, slave):
    one = slave(of_rod[version].path, stop=0.05)
    with pytest.raises(FMICallException):
        call(one)
    assert told in one.log[0]
    # After an error a reset begins anew.
    with pytest.raises(FMICallException):
        one.step(0.0, 1e-4)
    one.fmu.reset()
    one.begin()
    one.step(0.0, 1e-4)


@VERSIONS
def test_the_end_of_its_signals_is_told(version, exported, slave):
    made = exported(rod(), version=version)
    one = slave(made.path)
    one.step(0.0, 0.08)
    with pytest.raises(FMICallException):
        one.step(0.08, 1e-4)
    assert "t = 0.08 s is the end of this export" in one.log[0]


def test_without_signals_and_kernels_time_does_not_end(exported, slave):
    made = exported(box())
    one = slave(made.path)
    for n in range(40):
        one.step(0.1 * n, 0.1)
    assert one.get_number(0) == pytest.approx(4.0, rel=1e-12)


def test_a_token_of_another_export_is_refused(of_rod):
    with pytest.raises(Exception, match="instantiate"):
        Slave(of_rod[3].path, token="0" * 64)


def test_internal_steps_are_told_and_can_end_a_step_early(of_rod, slave):
    made, seen = of_rod[3], []

    def update(environment, time, can_set, can_get, finished, early, output_names, until):
        seen.append((time, bool(can_set), bool(can_get), bool(finished), bool(early)))
        if len(seen) == 4:
            output_names[0] = True
            until[0] = time + 2e-4

    one = slave(made.path, intermediateUpdate=update, earlyReturnAllowed=True)
    *_, early, last = one.step(0.0, 1e-3)
    assert early
    assert last == pytest.approx(6e-4)
    assert [time for time, *_ in seen] == pytest.approx([1e-4, 2e-4, 3e-4, 4e-4, 5e-4])
    assert {rest for _, *rest in map(tuple, seen) for rest in [tuple(rest)]} == {(True,) * 4}
    *_, early, last = one.step(6e-4, 1e-3)
    assert not early
    assert last == pytest.approx(16e-4)


def test_instances_in_threads_do_not_meet(of_rod, slave):
    made = of_rod[3]
    h, n = made.experiment.step, 400
    inputs = [values(rod(), n) * k for k in range(1, 5)]
    expected = [run(slave(made.path), u, h) for u in inputs]
    instances = [slave(made.path) for _ in inputs]
    found = [None] * len(inputs)

    def work(k):
        found[k] = run(instances[k], inputs[k], h)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(len(inputs))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_array_equal(one, other)


def test_paths_with_blanks_and_umlauts(of_rod, tmp_path, monkeypatch, slave):
    folder = tmp_path / "Prüfstand nord"
    folder.mkdir()
    path = folder / "größer als.fmu"
    shutil.copy(of_rod[3].path, path)
    monkeypatch.setenv("TMPDIR", str(folder))
    monkeypatch.setattr("tempfile.tempdir", str(folder))
    one = slave(path)
    assert "Prüfstand nord" in str(one.folder)
    one.step(0.0, 1e-4)


def test_what_two_exports_have_inside_does_not_meet(exported, tmp_path, slave):
    """Under RTLD_GLOBAL a library would take what an earlier one exports by the same name."""
    first, second = exported(rod()), exported(box())
    expected = run(slave(second.path), values(box(), 20), second.experiment.step)
    with zipfile.ZipFile(first.path) as archive:
        (name,) = [n for n in archive.namelist() if n.startswith("binaries/")]
        library = tmp_path / "first.so"
        library.write_bytes(archive.read(name))
    opened = ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
    assert opened.fmi3DoStep
    assert opened.fmi2DoStep
    for hidden in ("duhamel_solver_step_loop_advance", "core_new", "duhamel_image"):
        assert not hasattr(opened, hidden)
    found = run(slave(second.path), values(box(), 20), second.experiment.step)
    np.testing.assert_array_equal(found, expected)


def test_the_same_model_gives_the_same_file(exported):
    first, second = exported(rod()), exported(rod())
    assert first.path != second.path
    assert first.path.read_bytes() == second.path.read_bytes()


def test_nothing_of_this_machine_is_in_the_file(exported):
    made = exported(rod())
    with zipfile.ZipFile(made.path) as archive:
        for name in archive.namelist():
            content = archive.read(name)
            assert str(Path.home()).encode() + b"/" not in content
            assert b"/tmp/" not in content
            assert str(Path(fmu.__file__).parent).encode() not in content


def test_communication_steps_become_multiples(exported, slave):
    made = exported(rod(), communication=1e-3 / 3.0)
    assert made.experiment.step == pytest.approx(1e-3 / 12.0, rel=1e-14)
    assert any("1/4 of the communication step" in note for note in made.notes)
    one = slave(made.path)
    assert float(one.description.defaultExperiment.stepSize) == 1e-3 / 3.0
    for n in range(100):
        one.step(n * (1e-3 / 3.0), 1e-3 / 3.0)


def test_both_sizes_of_steps_follow_the_communication_step(exported, slave):
    model = servo(contact_step=1e-4)
    made = exported(model, communication=1.2e-3)
    assert made.experiment.step == pytest.approx(4e-4, rel=1e-14)
    short = exported(model.with_settings(step=4e-4, contact_step=8e-5))
    found = []
    for one in (slave(made.path), slave(short.path)):
        one.set(inputs__u=0.5)
        for n in range(300):
            one.step(n * 1.2e-3, 1.2e-3)
        found.append(one.values())
    np.testing.assert_allclose(*found, atol=1e-5)
