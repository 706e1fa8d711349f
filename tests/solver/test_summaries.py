"""Models, superelements and results as notebooks show them: short, and with no text as markup."""

from dataclasses import replace

import pytest
from duhamel.solver import (
    Constant,
    Model,
    OutputRequest,
    Revolute,
    RigidBody,
    Settings,
    Torque,
    simulate,
)

BAD = "<script>alert(1)</script>".replace("/", "|")


@pytest.fixture
def model():
    hub = RigidBody(mass=2.0, inertia=[0.1, 0.2, 0.25])
    pin = Revolute("ground", "hub", [0, 0, 1], name=BAD)
    push = Torque("hub", [0, 0, 1], Constant(1.0))
    return Model({"hub": hub}, [pin], [push], settings=Settings(t_end=0.01, step=1e-3))


def test_a_model_tells_its_bodies_joints_loads_and_settings(model):
    shown = model._repr_html_()
    for text in ("hub", "rigid, 2 kg", "(revolute)", "torque on hub", "0.01 s", "0.001 s", "m/s²"):
        assert text in shown
    assert "<script>" not in shown
    assert "&lt;script&gt;" in shown


def test_a_model_is_one_line(model):
    assert repr(model) == "<Model: bodies hub, 1 joint, 1 load>"


def test_results_tell_duration_steps_validity_and_what_was_recorded(model):
    results = simulate(model)
    shown = results._repr_html_()
    for text in ("0 to 0.01 s", "10, 11 rows recorded", "All validity limits respected", "energy"):
        assert text in shown
    assert "<script>" not in shown
    assert repr(results) == "<Results: 0 to 0.01 s, 11 rows, bodies hub>"


def test_results_of_little_are_shown_too(model):
    little = model.with_settings(output=OutputRequest(every=100, quantities=["energy"]))
    results = simulate(little)
    assert "10, 2 rows recorded" in results._repr_html_()
    assert repr(results) == "<Results: 0 to 0.01 s, 2 rows, bodies none>"


def test_validity_that_is_not_good_is_told(model):
    shown = simulate(replace(model, settings=Settings(t_end=40.0, step=0.5)))._repr_html_()
    assert "energy balance error / total energy: 0.999" in shown
