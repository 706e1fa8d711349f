"""Requested output: every n-th step and chosen quantities, against the whole."""

from dataclasses import replace

import h5py
import numpy as np
import pytest
from duhamel.solver import (
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Harmonic,
    Model,
    ModelError,
    OutputRequest,
    Place,
    RecoveryError,
    Results,
    Revolute,
    RigidBody,
    Settings,
    Spring,
    Start,
    read_model,
    simulate,
)
from duhamel.solver.output import recorder
from duhamel.superelement import Recovery

STEPS, H = 100, 5e-4


@pytest.fixture(scope="module")
def model(coarse):
    """A hub that turns three times while its beam pulls at a damped tether."""
    hub = RigidBody(
        0.01,
        [0.006, 0.007, 0.01],
        {"rim": Frame([0.05, 0, 0])},
        Start(angular_velocity=[0, 0, 400.0]),
    )
    beam = FlexibleBody(coarse, Start(place=Place("root", "hub.rim")))
    return Model(
        bodies={"hub": hub, "beam": beam},
        joints=(
            Revolute("ground", "hub", [0, 0, 1], name="pivot"),
            Fixed("hub.rim", "beam.root", name="clamp"),
        ),
        springs=(
            Spring("tether", "point", ("ground.hook", "beam.tip"), stiffness=2.0, damping=0.01),
        ),
        loads=(Force("beam.tip", [0, 0, 1], Harmonic(1.0, 300.0), follower=True),),
        ground_frames={"hook": Frame([0.6, 0.2, 0])},
        settings=Settings(step=H, t_end=STEPS * H),
    )


def datasets(path):
    """The variables, numbers and names."""
    with h5py.File(path, "r") as file:
        return {name: item[()] for name, item in file.items() if isinstance(item, h5py.Dataset)}


@pytest.fixture(scope="module")
def whole_file(model, tmp_path_factory):
    path = tmp_path_factory.mktemp("whole") / "whole.h5"
    simulate(model, output=path)
    return path


@pytest.fixture(scope="module")
def whole(whole_file):
    return datasets(whole_file)


@pytest.mark.parametrize(
    ("every", "numbers"), [(7, recorder.BUFFER_NUMBERS), (7, 1), (1, 1), (1000, 1)]
)
def test_what_is_recorded_is_what_a_whole_record_holds_there(
    every, numbers, model, whole, tmp_path, monkeypatch
):
    """To the last bit, energies, balances and angles over full turns included, however many rows
    wait to be written.
    """
    monkeypatch.setattr(recorder, "BUFFER_NUMBERS", numbers)
    path = tmp_path / "thinned.h5"
    simulate(model.with_settings(output=OutputRequest(every)), output=path)
    thinned = datasets(path)
    steps = sorted({*range(0, STEPS + 1, every), STEPS})
    assert whole["joint_position"][-1] > 4 * np.pi
    assert thinned.keys() == whole.keys()
    for name, array in whole.items():
        expected = array if array.dtype == object or name == "check_value" else array[steps]
        np.testing.assert_array_equal(thinned[name], expected, err_msg=name)
    assert Results.read(path).solver["every"] == every


LABELS = {"axis", "quaternion"}
"""of the components of what is recorded"""
ALWAYS = {"time", "newton_iterations", "newton_residual"}
ALWAYS |= {"flexible_body", "superelement_file", "superelement_sha256", "check", "check_value"}
ENERGIES = {f"{name}_energy" for name in ("kinetic", "elastic", "spring", "potential")}
ENERGIES |= {"external_work", "dissipated_energy", "numerical_dissipation", "energy_balance"}
READ = {
    "bodies": Results.body,
    "frames": Results.frame,
    "joints": Results.joint,
    "springs": Results.spring,
}


@pytest.mark.parametrize(
    ("quantities", "recorded", "variables"),
    [
        (("joints/pivot", "energy"), ("joints/pivot", "energy"), ENERGIES),
        (
            ("frames", "bodies/hub"),
            ("bodies/hub", "frames/beam.root", "frames/beam.tip", "frames/hub.rim"),
            set(),
        ),
        (
            ("springs", "momentum"),
            ("springs/tether", "momentum"),
            {"linear_momentum", "angular_momentum"},
        ),
        ((), (), set()),
    ],
)
def test_chosen_quantities_alone_are_recorded(
    quantities, recorded, variables, model, whole_file, whole, tmp_path
):
    path = tmp_path / "chosen.h5"
    simulate(model.with_settings(output=OutputRequest(quantities=quantities)), output=path)
    kinds = {{"bodies": "body"}.get(kind, kind[:-1]) for kind in map(group_of, recorded)}
    of_kinds = {name for name in whole if name.partition("_")[0] in kinds} - ENERGIES
    assert set(datasets(path)) - LABELS == ALWAYS | variables | of_kinds
    chosen, everything = Results.read(path), Results.read(whole_file)
    assert chosen.recorded == recorded
    np.testing.assert_array_equal(chosen.iterations, everything.iterations)
    for group, name in (quantity.split("/") for quantity in recorded if "/" in quantity):
        assert_equal(READ[group](chosen, name), READ[group](everything, name))
    for group in {"energy", "momentum"} & {*recorded}:
        assert_equal(getattr(chosen, group), getattr(everything, group))


def group_of(quantity):
    return quantity.partition("/")[0]


def assert_equal(one, other):
    """To the last bit."""
    for name, expected in vars(other).items():
        np.testing.assert_array_equal(vars(one)[name], expected, err_msg=name)


def test_what_was_not_recorded_is_told(model):
    results = simulate(
        model.with_settings(output=OutputRequest(quantities=("joints", "bodies/hub")))
    )
    assert results.recorded == ("bodies/hub", "joints/clamp", "joints/pivot")
    with pytest.raises(KeyError, match="no bodies/beam; there are: hub"):
        results.body("beam")
    with pytest.raises(
        KeyError, match="no energy; there are: bodies/hub, joints/clamp, joints/pivot"
    ):
        _ = results.energy
    with pytest.raises(
        KeyError, match=r"no frames/beam.tip; there are: bodies/hub, joints/clamp, joints/pivot"
    ):
        results.frame("beam.tip")


def test_a_quantity_that_there_is_not_is_refused_before_the_file_is_touched(model, tmp_path):
    path = tmp_path / "kept.h5"
    path.write_text("kept")
    wrong = replace(
        model.with_settings(output=OutputRequest(quantities=("bodies/hubb",))), path="rotor.toml"
    )
    message = (
        r"rotor.toml: output: quantities: no 'bodies/hubb'; there are: .*; "
        r"did you mean 'bodies/hub'\?"
    )
    with pytest.raises(ModelError, match=message):
        simulate(wrong, output=path)
    assert path.read_text() == "kept"
    with pytest.raises(ModelError, match="output: every: expected 1 to 1e9, got 0"):
        OutputRequest(0)


def test_fields_need_every_step_and_the_loads_of_all_interfaces(model, coarse):
    X = [interface.X for interface in coarse.interfaces]
    phi = coarse.modes.phi.reshape(len(X), -1, len(coarse.modes.omega))
    beam = FlexibleBody(
        replace(coarse, recovery=Recovery(X, [[0, 1]], phi[:, :3])), model.bodies["beam"].start
    )
    recoverable = replace(model, bodies={**model.bodies, "beam": beam})
    results = simulate(recoverable.with_settings(output=OutputRequest(10)))
    with pytest.raises(
        RecoveryError, match="body 'beam': fields need every step, and the run recorded one in 10"
    ):
        results.displacement("beam", 0.01)
    results = simulate(
        recoverable.with_settings(output=OutputRequest(quantities=("bodies", "frames/beam.tip")))
    )
    with pytest.raises(
        RecoveryError,
        match=r"body 'beam': fields need frames/beam.root, which the run did not record",
    ):
        results.displacement("beam", 0.01)


FILE = """
[simulation]
t_end = 0.01
step = 1e-3
corrections = 2

[output]
every = 4
quantities = ["bodies"]

[bodies.stone]
mass = 1.0
inertia = [1, 1, 1]
velocity = [1, 0, 0]
"""


def test_a_model_file_says_it_too(tmp_path):
    path = tmp_path / "stone.toml"
    path.write_text(FILE)
    model = read_model(path)
    assert model.settings.output == OutputRequest(4, ("bodies",))
    assert model.settings.fixed_iterations == 2
    np.testing.assert_allclose(simulate(model).time, [0.0, 4e-3, 8e-3, 10e-3], rtol=1e-14)
