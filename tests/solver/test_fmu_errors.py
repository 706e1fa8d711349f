"""FMUs that do not fit their model or this machine, or that fail: one clear error each."""

import sys
import tempfile
import zipfile
from dataclasses import replace
from pathlib import Path

import pytest
from duhamel.results import Results
from duhamel.solver import (
    FMU,
    Input,
    ModelError,
    Motor,
    Simulator,
    StartFrom,
    Torque,
    simulate,
)
from duhamel.solver.cosimulation.instance import FMUInstance

from .controller_fmu import controller
from .test_fmus import INPUTS, H, driven, hub


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    return controller(tmp_path_factory.mktemp("fmus") / "drive.fmu")


@pytest.fixture(autouse=True)
def temporary(tmp_path, monkeypatch):
    """The folder of temporary folders, which must be empty after each test."""
    place = tmp_path / "temporary"
    place.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(place))
    yield place
    assert not list(place.iterdir())


def refused(message, make):
    with pytest.raises(ModelError, match=message):
        make()


MOTOR = Motor("m", "pivot", "angle", torque=Input("tau"))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"inputs": {"angel": "joints/pivot/angle"}}, "inputs: no variable 'angel' in .*drive.fmu"),
        ({"inputs": {"angel": "joints/pivot/angle"}}, "did you mean 'angle'"),
        ({"inputs": {"torque": "joints/pivot/angle"}}, "inputs: torque: .*input, found output"),
        ({"inputs": {"mode": "joints/pivot/angle"}}, "mode: expected a real.*found Boolean"),
        ({"inputs": {"angle": "joints/pivto/angle"}}, "inputs: angle: no output 'joints/pivto"),
        ({"inputs": {"angle": "joints/pivto/angle"}}, "did you mean 'joints/pivot/angle'"),
        ({"inputs": {"angle": "bodies/hub/x"}}, r"has 3 numbers: expected .*'bodies/hub/x\[1\]'"),
        ({"inputs": {"angle": "bodies/hub/x[4]"}}, r"expected .*'bodies/hub/x\[3\]', got"),
        ({"inputs": {"angle": "joints/pivot/angle[2]"}}, r"expected .*angle\[1\]', got"),
        ({"outputs": {"torqe": "tau"}}, "outputs: no variable 'torqe'.*did you mean 'torque'"),
        ({"outputs": {"kp": "tau"}}, "outputs: kp: expected .*output, found parameter"),
        ({"outputs": {"z": "tau"}}, "outputs: z: expected .*output, found local"),
        ({"parameters": {"kpp": 1.0}}, "parameters: no variable 'kpp'.*did you mean 'kp'"),
        ({"parameters": {"K": 1.0}}, "no variable 'K' in .*; it has: kp, kd, ki, lag"),
        ({"parameters": {"torque": 1.0}}, "parameters: torque: .*parameter, found output"),
        ({"parameters": {"kp": "high"}}, r"parameters: kp: expected a number \(Float64\)"),
        ({"parameters": {"kp": True}}, r"kp: expected a number \(Float64\), got True"),
        ({"parameters": {"turns": 2.5}}, r"turns: expected a whole number \(Int32\), got 2.5"),
        ({"step": 1.5 * H}, "step: expected a multiple of the time step, 6e-05 s, got 9e-05 s"),
        ({"step": 0.1 * H}, "step: expected a multiple of the time step"),
    ],
)
def test_what_does_not_fit_the_model_is_named(given, message, drive):
    values = {"inputs": INPUTS, "outputs": {"torque": "tau"}} | given
    model = hub(MOTOR, FMU("drive", drive, **values))
    refused(f"fmu 'drive': .*{message}", lambda: simulate(model))


@pytest.mark.parametrize(
    ("offered", "message"),
    [
        ({"platform": "risc-v"}, "expected a library for .*, found risc-v"),
        ({"tool": True}, "it runs only inside Sketch"),
        ({"interface": "ModelExchange"}, "expected co-simulation, found model exchange alone"),
        ({"step": 7e-5}, "found 7e-05 s, the step of .*give one"),
    ],
)
@pytest.mark.parametrize("version", [2, 3])
def test_an_fmu_that_cannot_run_here_is_refused(offered, message, version, tmp_path):
    drive = controller(tmp_path / "drive.fmu", version, **offered)
    refused(f"fmu 'drive': .*{message}", lambda: simulate(driven(drive)))


@pytest.mark.parametrize("own", [H / 3, H, 2 * H])
def test_the_own_step_of_an_fmu_is_its_communication_step_where_it_fits(own, tmp_path):
    drive = controller(tmp_path / "drive.fmu", step=own)
    model = driven(drive, steps=20)
    fmu = replace(model.fmus[0], step=max(own, H))
    given = simulate(replace(model, fmus=[fmu])).fmu("drive").outputs["tau"]
    assert simulate(model).fmu("drive").outputs["tau"].tolist() == given.tolist()


def test_files_that_are_no_fmus_are_refused(tmp_path):
    path = tmp_path / "drive.fmu"
    refused("file: .*drive.fmu: no such file", lambda: driven(path))
    path.write_text("nothing")
    refused("expected an FMU, found File is not a zip file", lambda: simulate(driven(path)))
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("readme.txt", "")
    refused("archive without modelDescription.xml", lambda: simulate(driven(path)))
    for text, message in (
        ("<fmiModelDescription", "a damaged modelDescription.xml"),
        ('<fmiModelDescription fmiVersion="1.0"/>', "expected FMI 2 or 3, found 1.0"),
        ("<fmiModelDescription/>", "expected FMI 2 or 3, found no version"),
    ):
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("modelDescription.xml", text)
        refused(message, lambda: simulate(driven(path)))


def test_a_library_that_cannot_be_loaded_is_an_error(drive, tmp_path):
    broken = tmp_path / "broken.fmu"
    with zipfile.ZipFile(drive) as source, zipfile.ZipFile(broken, "w") as target:
        for name in source.namelist():
            content = source.read(name)
            target.writestr(name, b"nothing" if name.startswith("binaries") else content)
    before = Path.cwd()
    refused("at t = 0 s it cannot be loaded: ", lambda: simulate(driven(broken)))
    assert Path.cwd() == before


def test_without_fmpy_the_error_says_what_to_install(drive, monkeypatch):
    monkeypatch.setitem(sys.modules, "fmpy", None)
    refused(r"fmu 'drive': FMUs need FMPy.*duhamel\[fmu\]", lambda: simulate(driven(drive)))


def test_names_of_inputs_are_checked_when_a_model_is_made(drive):
    fmu = FMU("drive", drive, INPUTS, {"torque": "tua"})
    refused("outputs: torque: no load or motor.*did you mean 'tau'", lambda: hub(MOTOR, fmu))
    fmus = [FMU(name, drive, INPUTS, {"torque": "tau"}) for name in ("one", "two")]
    refused("fmu 'two': .*'tau', found fmu 'one' too", lambda: hub(MOTOR, *fmus))
    refused("outputs: expected 1 to 100", lambda: FMU("a", drive, {}, {"torque": "a/b"}))
    refused("inputs: expected a table of names", lambda: FMU("a", drive, {"angle": 3}))
    refused("parameters: expected a table", lambda: FMU("a", drive, parameters={"kp": [1.0]}))
    refused("coupling: expected 'explicit' or 'slope'", lambda: FMU("a", drive, coupling="weak"))


def test_a_slope_needs_a_motor_on_a_coordinate_that_the_fmu_gets(drive, tmp_path):
    other = {"angle": "bodies/hub/x[1]"}
    slope = FMU("drive", drive, other, {"torque": "tau"}, coupling="slope")
    refused('coupling: "slope" needs a motor whose', lambda: hub(MOTOR, slope))
    slope = replace(slope, inputs=INPUTS)
    load = replace(MOTOR, torque=Input("other"))
    torque = Torque("hub", [0, 0, 1], Input("tau"))
    model = hub(load)
    refused("needs a motor whose", lambda: replace(model, loads=[torque], fmus=[slope]))
    refused("found gains of motor 'm'", lambda: hub(replace(MOTOR, damping=1.0), slope))
    blind = controller(tmp_path / "blind.fmu", states=False)
    refused("can save its state", lambda: simulate(driven(blind, coupling="slope")))


def test_a_state_that_cannot_be_serialized_is_not_promised(tmp_path):
    drive = controller(tmp_path / "drive.fmu", serializes=False)
    model = driven(drive, steps=10)
    kept = model.with_settings(checkpoint={"every": 2})
    simulate(kept)
    message = "checkpoint: fmu 'drive' cannot serialize its state"
    refused(message, lambda: simulate(kept, output=tmp_path / "run.h5"))
    assert not (tmp_path / "run.h5").exists()
    with Simulator(model, []) as simulator:
        refused("save: fmu 'drive' cannot serialize its state", simulator.save)


def test_a_run_does_not_start_from_the_states_of_fmus(drive, tmp_path):
    model = driven(drive, steps=10, settings={"checkpoint": {"every": 10}})
    simulate(model, output=tmp_path / "run.h5")
    later = model.with_settings(t_end=20 * H, start=StartFrom(str(tmp_path / "run.h5")))
    refused("start: the run that it starts from has FMUs", lambda: simulate(later))


@pytest.mark.parametrize("version", [2, 3])
def test_an_fmu_that_fails_says_when_and_why_and_leaves_what_was_before(version, tmp_path):
    drive = controller(tmp_path / "drive.fmu", version)
    model = driven(drive, steps=100, parameters={"fails_at": 50.5 * H})
    with pytest.raises(ModelError) as caught:
        simulate(model, output=tmp_path / "run.h5")
    message = str(caught.value)
    assert "fmu 'drive': at t = 0.003 s it fails in its step: " in message
    assert "error" in message
    assert "its log: the drive is too hot" in message
    assert len(Results.read(tmp_path / "run.h5").time) == 51
    with Simulator(model, []) as simulator:
        for _ in range(50):
            simulator.step([])
        refused("too hot", lambda: simulator.step([]))


def test_what_is_no_number_stops_the_run(drive):
    model = driven(drive, parameters={"fails_at": -1.0})
    refused("at t = 0 s it gives nan as torque: expected a number", lambda: simulate(model))


def test_folders_of_fmus_go_where_a_run_is_interrupted(drive, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(FMUInstance, "step", interrupted)
    with pytest.raises(KeyboardInterrupt):
        simulate(driven(drive))
