"""Starts: equilibrium that stays still, steady rotation, joint coordinates asked for, redundant constraints."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    FlexibleBody,
    Frame,
    Joint,
    Load,
    Model,
    ModelError,
    Place,
    RigidBody,
    Start,
    SteadyRotation,
    simulate,
)

L, EI, MASS, G = 0.5, 5.5, 0.0429, 9.81
HISTORIES = pytest.mark.parametrize("history", ["recursive", "direct"])


@HISTORIES
@pytest.mark.parametrize("rule", ["consistent", "paper"])
def test_a_loaded_cantilever_rests_where_beam_theory_says(beam, history, rule):
    model = Model(
        bodies={"beam": FlexibleBody(beam.element, Start(position=[L / 2, 0, 0]))},
        joints=[Joint("clamp", "fixed", ("ground", "beam.root"))],
        loads=[Load("force", "beam.tip", [0, 0, -1], Constant(1.0))],
        gravity=[0, 0, -G],
        t_end=0.03,
        start="equilibrium",
        history=history,
        rule=rule,
    )
    tip = simulate(model).frame("beam.tip").position
    # the rigid frame follows the clamp by its angle, so that a chord enters to third order
    assert tip[0, 2] == pytest.approx(-(L**3) / (3 * EI) - MASS * G * L**3 / (8 * EI), rel=5e-4)
    assert np.abs(tip - tip[0]).max() < 1e-13


@HISTORIES
def test_hanging_beams_find_their_place_and_stay_there(beam, history):
    model = Model(
        bodies={
            "upper": FlexibleBody(beam.element, Start(position=[L / 2, 0, 0])),
            "lower": FlexibleBody(beam.element, Start(place=Place("root", "upper.tip"))),
        },
        joints=[
            Joint("pin", "revolute", ("ground", "upper.root"), axis=[0, 1, 0]),
            Joint("knee", "revolute", ("upper.tip", "lower.root"), axis=[0, 1, 0]),
        ],
        gravity=[0, 0, -G],
        t_end=0.03,
        start="equilibrium",
        history=history,
    )
    results = simulate(model)
    tip = results.frame("lower.tip").position
    np.testing.assert_allclose(tip[0], [0, 0, -2 * L], atol=1e-7)
    assert np.abs(tip - tip[0]).max() < 1e-13
    assert np.abs(results.body("lower").v).max() < 1e-9
    assert results.solver["degrees_of_freedom"] == 2


def test_a_steady_rotation_goes_on(beam):
    spin = 50.0
    model = Model(
        bodies={
            "hub": RigidBody(0.01, [1e-6, 1e-6, 0.019], {"rim": Frame([0.05, 0, 0])}),
            "beam": FlexibleBody(beam.element, Start(place=Place("root", "hub.rim"))),
        },
        joints=[
            Joint("pivot", "revolute", ("ground", "hub"), axis=[0, 0, 1]),
            Joint("clamp", "fixed", ("hub.rim", "beam.root")),
        ],
        t_end=0.06,
        start="equilibrium",
        steady_rotation=SteadyRotation([0, 0, spin]),
    )
    results = simulate(model)
    pull = MASS * (0.05 + L / 2) * spin**2  # and a millionth more, as the beam stretches
    assert results.joint("clamp").force[0, 0] == pytest.approx(-pull, rel=2e-6)
    # what the step of the scheme, (spin h)^2, leaves
    assert np.abs(results.body("hub").v[:, 5] / spin - 1.0).max() < 1e-6
    assert np.abs(np.linalg.norm(results.joint("clamp").force, axis=1) / pull - 1.0).max() < 1e-5


def four_bar(**settings):
    def bar(mass, **start):
        return RigidBody(
            mass, [0.01, 0.1, 0.1], {"l": Frame([-mass / 2, 0, 0]), "r": Frame([mass / 2, 0, 0])}, Start(**start)
        )

    between = {"A": ("ground", "a.l"), "B": ("a.r", "b.l"), "C": ("b.r", "c.l"), "D": ("c.r", "ground")}
    return Model(
        bodies={
            "a": bar(1, position=[0, 0, 0.5], rotation=[0, -np.pi / 2, 0]),
            "b": bar(2, position=[1, 0, 1]),
            "c": bar(1, position=[2, 0, 0.5], rotation=[0, np.pi / 2, 0]),
        },
        joints=[Joint(name, "revolute", frames, axis=[0, 1, 0]) for name, frames in between.items()],
        gravity=[0, 0, -G],
        t_end=0.2,
        step=1e-3,
        **settings,
    )


def test_redundant_constraints_are_named():
    with pytest.raises(ModelError) as error:
        simulate(four_bar())
    for text in ("20 constraints of which 3 are redundant", "A (translation 3, rotation 1, rotation 2)", "remove"):
        assert text in str(error.value)


def test_without_redundant_constraints_the_motion_is_that_of_freed_joints():
    removed = simulate(four_bar(redundant="remove"))
    assert removed.solver["degrees_of_freedom"] == 1
    assert removed.solver["removed"]
    model = four_bar()
    freed = {"B": Joint("B", "spherical", ("a.r", "b.l"))}
    freed["C"] = Joint("C", "universal", ("b.r", "c.l"), axis=[0, 1, 0], second_axis=[0, 0, 1])
    by_hand = simulate(replace(model, joints=[freed.get(joint.name, joint) for joint in model.joints]))
    for body in ("a", "b", "c"):
        np.testing.assert_allclose(removed.body(body).x, by_hand.body(body).x, atol=1e-9)


def test_a_closed_loop_starts_from_a_joint_angle_and_its_rate():
    model = four_bar(redundant="remove")
    first = model.joints[0]
    asked = Joint(first.name, first.type, first.between, first.axis, start={"angle": 0.5, "angle_rate": 2.0})
    results = simulate(replace(model, joints=(asked, *model.joints[1:])))
    coordinates = results.joint("A").coordinates
    assert coordinates["angle"][0] == pytest.approx(0.5, abs=1e-12)
    assert coordinates["angle_rate"][0] == pytest.approx(2.0, abs=1e-9)
    assert results.solver["moved"] == pytest.approx(0.5, abs=1e-9)


def test_a_joint_that_is_open_by_little_is_closed_and_told():
    def pendulum(gap, **settings):
        bob = RigidBody(1.0, [0.1, 0.1, 0.1], {"pin": Frame([-0.5, 0, 0])}, Start(position=[0.5 + gap, 0, 0]))
        return Model(
            bodies={"bob": bob},
            joints=[Joint("pin", "revolute", ("ground.pin", "bob.pin"), axis=[0, 0, 1])],
            ground_frames={"pin": Frame()},
            t_end=0.01,
            step=1e-3,
            **settings,
        )

    results = simulate(pendulum(1e-5))
    assert results.solver["moved"] == pytest.approx(1e-5, rel=1e-3)
    np.testing.assert_allclose(results.frame("bob.pin").position[0], 0.0, atol=1e-14)
    with pytest.raises(ModelError, match=r"open by 0\.1 m"):
        simulate(pendulum(0.1))
    assert simulate(pendulum(0.1, assemble=True)).solver["moved"] == pytest.approx(0.1, rel=1e-6)
