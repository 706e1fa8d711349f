"""Derivatives of runs: against closed forms, with errors that cover what they miss."""

import json

import numpy as np
import pytest
from duhamel import study, superelement
from duhamel.cli import app
from duhamel.solver import (
    Constant,
    Contact,
    FlexibleBody,
    Force,
    Frame,
    Impact,
    Model,
    Revolute,
    RigidBody,
    Settings,
    Start,
    Torque,
    write_model,
)
from duhamel.study import StudyError, sensitivities
from duhamel.study.parametrized import numeric
from typer.testing import CliRunner

from ..solver.frameworks import bar

G, HEIGHT, STIFFNESS = 9.81, 0.01, 1e5


def bouncing(step):
    """A ball of 1 kg that bounces without losses on a linear spring, ten times a second."""
    ball = RigidBody(1.0, [0.1] * 3, start=Start(position=[0.0, 0.0, HEIGHT]))
    floor = Contact(
        "floor",
        ["ground.floor", "ball"],
        "plane",
        ball=0.0,
        axis=[0, 0, 1],
        impact=Impact(stiffness=STIFFNESS, restitution=1.0),
    )
    return Model(
        {"ball": ball},
        contacts=[floor],
        ground_frames={"floor": Frame([0, 0, 0])},
        gravity=(0, 0, -G),
        settings=Settings(t_end=1.0, step=step),
    )


def height_by_stiffness():
    """dz/dk of its height after 1 s, in the tenth flight: by how much contacts become longer."""
    fall = np.sqrt(2.0 * HEIGHT / G)
    v, omega = G * fall, np.sqrt(STIFFNESS)

    def duration(omega):
        return 2.0 * (np.pi - np.arctan2(v * omega, G)) / omega

    n, rest = divmod(1.0 - fall, duration(omega) + 2.0 * v / G)
    tau = rest - duration(omega)
    assert 0.0 < tau < 2.0 * v / G
    by_omega = (duration(omega + 1e-3) - duration(omega - 1e-3)) / 2e-3
    return -(n + 1) * 0.5 / omega * by_omega * (v - G * tau)


def pushed(element=None, root="root"):
    """A lever on a pivot that a constant torque turns, of a body in memory or rigid."""
    if element is None:
        body = RigidBody(2.0, [0.2, 0.2, 0.3], frames={"root": Frame([0, 0, 0])})
    else:
        body = FlexibleBody(element)
    return Model(
        {"lever": body},
        joints=[Revolute("ground", f"lever.{root}", [0, 0, 1], name="pivot")],
        loads=[Torque("lever" if element is None else f"lever.{root}", [0, 0, 1], Constant(3.0))],
        settings=Settings(t_end=1.0, step=1e-2),
    )


def test_the_turn_of_a_lever_by_its_torque_and_inertia():
    found = sensitivities(
        pushed(),
        {"M": "loads.0.signal", "J": "bodies.lever.inertia.2"},
        {"turn": "final angle:lever:z", "rate": "final angular_velocity:lever:z"},
    )
    np.testing.assert_allclose(found.value, [5.0, 10.0], rtol=1e-3)
    np.testing.assert_allclose(found.derivative[:, 0], found.value / 3.0, rtol=1e-8)
    np.testing.assert_allclose(found.elasticity, [[1.0, -1.0], [1.0, -1.0]], rtol=1e-7)
    assert (found.error < 1e-6 * np.abs(found.derivative)).all()
    assert found.notes == ()
    assert found.units == {"turn": "rad", "rate": "rad/s"}


def test_over_time_a_derivative_is_a_series():
    found = sensitivities(pushed(), {"M": "loads.0.signal"}, ["angular_velocity:lever:z"])
    series = found.series["angular_velocity:lever:z"]
    assert series.derivative.shape == (101, 1)
    np.testing.assert_allclose(series.derivative[:, 0], series.value / 3.0, atol=1e-9)
    assert found.value.shape == (0,)


@pytest.mark.parametrize("step", [1e-4, 8e-5, 4e-5])
def test_errors_cover_the_kinks_of_bounces(step):
    """The slope of the discrete run is wrong by tens of per cent there, and consistent."""
    key = "contacts.floor.stiffness"
    found = sensitivities(bouncing(step), [key], {"z": "final position:ball:z"})
    miss = abs(found.derivative[0, 0] - height_by_stiffness())
    assert miss < found.error[0, 0] < 0.5 * abs(height_by_stiffness())
    assert miss < 0.1 * abs(height_by_stiffness())
    assert found.notes == (f"z by {key}: {study.sensitivity.SWITCH_NOTE}",)


def test_superelements_in_memory_are_taken_as_they_are(tmp_path, monkeypatch):
    model = pushed(bar(tmp_path, 0.3), root="left").with_settings(t_end=1e-2, step=1e-4)
    monkeypatch.setattr(superelement, "read", None)
    found = sensitivities(model, {"M": "loads.0.signal"}, ["final angle:lever:z"])
    np.testing.assert_allclose(found.elasticity, [[1.0]], rtol=1e-3)


def test_a_function_makes_the_models():
    def lever(torque, inertia):
        body = RigidBody(2.0, [inertia, inertia, 0.3], start=Start(angular_velocity=[0, 0, 1]))
        push = Force("lever", [1.0, 0.0, 0.0], Constant(torque))
        return Model({"lever": body}, loads=[push], settings=Settings(t_end=1.0, step=0.1))

    found = sensitivities(lever, {"torque": 4.0, "inertia": 0.3}, ["final position:lever:x"])
    np.testing.assert_allclose(found.derivative, [[0.25, 0.0]], atol=1e-9)


@pytest.mark.parametrize("kind", [int, np.int64, np.float32])
def test_integers_and_numbers_of_numpy_are_numbers(kind):
    assert numeric("n", kind(3)) == 3.0
    with pytest.raises(StudyError, match="n: expected a number"):
        numeric("n", np.bool_(True))


@pytest.mark.parametrize(
    ("parameters", "outputs", "options", "told"),
    [
        (["bodies.lever.size"], ["final angle:lever:z"], {}, "bodies.lever.size: no 'size' in"),
        (
            ["bodies.lever.inertia"],
            ["final angle:lever:z"],
            {},
            "found a list: name one of .*a.0",
        ),
        (["joints.pivot.type"], ["final angle:lever:z"], {}, "expected a number, found 'revolute'"),
        (["joints.pivot.axis.0"], ["final angle:lever:z"], {}, "a scale above 0 for its steps"),
        (["loads.0.signal"], ["final angle:hinge:z"], {}, "hinge"),
        ([], ["final angle:lever:z"], {}, "parameters: expected at least one, found none"),
        ({}, ["final angle:lever:z"], {}, "parameters: expected at least one, found none"),
        (["loads.0.signal"], [], {}, "outputs: expected at least one, found none"),
        (["loads.0.signal"], ["final angle:lever:z"], {"scales": {"x": 1.0}}, "scales.x: no para"),
        (
            ["loads.0.signal"],
            ["final angle:lever:z"],
            {"method": "adjoint"},
            "method: expected diff",
        ),
        # The largest moment of inertia is at most the sum of the others.
        (["bodies.lever.inertia.0"], ["final angle:lever:z"], {"scales": None}, None),
    ],
)
def test_what_cannot_be_differentiated_is_named(parameters, outputs, options, told):
    if told is None:
        flat = RigidBody(2.0, [0.1, 0.2, 0.3])
        model = Model({"lever": flat}, settings=Settings(t_end=0.1, step=0.1))
        outputs, told = ["final position:lever:x"], "does not run on both sides of 0.1: .*inertia"
    else:
        model = pushed()
    with pytest.raises((StudyError, ValueError), match=told):
        sensitivities(model, parameters, outputs, **options)


STUDY = """
model = "lever.toml"
[parameters]
torque.normal = [3.0, 0.1]
bodies.lever.inertia.2 = [0.29, 0.31]
[derived]
loads.0.signal = "torque"
[outputs]
turn = "final angle:lever:z"
"""


def test_the_command_prints_and_draws_them(tmp_path):
    write_model(pushed(), tmp_path / "lever.toml")
    (tmp_path / "lever-study.toml").write_text(STUDY)
    command = ["sensitivity", str(tmp_path / "lever-study.toml")]
    (tmp_path / "lever-study.toml").write_text(STUDY + 'z = "angle:lever:z"')
    refused = CliRunner().invoke(app, command)
    assert "outputs.z: 'angle:lever:z' is over time" in refused.output + refused.stderr
    (tmp_path / "lever-study.toml").write_text(STUDY)
    shown = CliRunner().invoke(app, command)
    assert shown.exit_code == 0, shown.output
    assert "elasticity" in shown.output
    assert (tmp_path / "lever-study-sensitivity.png").stat().st_size
    (tmp_path / "lever-study-sensitivity.png").unlink()
    found = json.loads(CliRunner().invoke(app, [*command, "--json"]).stdout)
    first, second = found["sensitivities"]
    assert (first["parameter"], second["parameter"]) == ("torque", "bodies.lever.inertia.2")
    assert (first["elasticity"], second["elasticity"]) == pytest.approx((1.0, -1.0), rel=1e-6)
    table = tmp_path / "table.csv"
    CliRunner().invoke(app, [*command, "-o", str(table)])
    assert table.read_text().splitlines()[0] == "output,value,parameter,derivative,error,elasticity"
    assert {path.name for path in tmp_path.iterdir()} == {
        *("lever.toml", "lever-study.toml", "table.csv")
    }


def test_outputs_without_a_derivative_are_told():
    key = "contacts.floor.stiffness"
    outputs = {"when": "argmin position:ball:z", "hits": "count event:floor"}
    found = sensitivities(bouncing(1e-3).with_settings(t_end=0.1), [key], outputs)
    assert (found.error == np.inf).all()
    assert [note.partition(" is ")[0] for note in found.notes[-2:]] == ["when", "hits"]
    none = sensitivities(
        bouncing(1e-3).with_settings(t_end=0.01), [key], {"peak": "max event:floor:peak"}
    )
    assert none.notes == ("peak has no number in this run",)


def test_what_moves_over_the_widest_step_alone_moves_by_jumps():
    found = study.differences.slopes_of(np.array([[0.997, 0.0, 0.0, 0.0, 0.0]]).T)
    assert (found.value[0], found.error[0], found.switches[0]) == (0.997, 0.997, True)
