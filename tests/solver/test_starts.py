"""Starts: equilibrium that stays still, joint coordinates asked for, what is off as given,
redundant constraints.
"""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    JOINTS,
    Constant,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Model,
    ModelError,
    Place,
    Polynomial,
    Revolute,
    RigidBody,
    Settings,
    Simulator,
    Spherical,
    Start,
    Universal,
    ValidityWarning,
    simulate,
    start,
)

from .models import model_of

L, EI, MASS, G = 0.5, 5.5, 0.0429, 9.81
HISTORIES = pytest.mark.parametrize("history", ["recursive", "direct"])


@HISTORIES
@pytest.mark.parametrize("rule", ["consistent", "paper"])
def test_a_loaded_cantilever_rests_where_beam_theory_says(beam, history, rule):
    model = Model(
        bodies={"beam": FlexibleBody(beam.element, Start(position=[L / 2, 0, 0]))},
        joints=[Fixed("ground", "beam.root", name="clamp")],
        loads=[Force("beam.tip", [0, 0, -1], Constant(1.0))],
        gravity=[0, 0, -G],
        settings=Settings(t_end=0.03, start="equilibrium", history=history, rule=rule),
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
            Revolute("ground", "upper.root", [0, 1, 0], name="pin"),
            Revolute("upper.tip", "lower.root", [0, 1, 0], name="knee"),
        ],
        gravity=[0, 0, -G],
        settings=Settings(t_end=0.03, start="equilibrium", history=history),
    )
    results = simulate(model)
    tip = results.frame("lower.tip").position
    np.testing.assert_allclose(tip[0], [0, 0, -2 * L], atol=1e-7)
    assert np.abs(tip - tip[0]).max() < 1e-13
    assert np.abs(results.body("lower").v).max() < 1e-9
    assert results.solver["degrees_of_freedom"] == 2


def four_bar(**settings):
    def bar(mass, **start):
        return RigidBody(
            mass,
            [0.01, 0.1, 0.1],
            {"l": Frame([-mass / 2, 0, 0]), "r": Frame([mass / 2, 0, 0])},
            Start(**start),
        )

    between = {
        "A": ("ground", "a.l"),
        "B": ("a.r", "b.l"),
        "C": ("b.r", "c.l"),
        "D": ("c.r", "ground"),
    }
    return Model(
        bodies={
            "a": bar(1, position=[0, 0, 0.5], rotation=[0, -np.pi / 2, 0]),
            "b": bar(2, position=[1, 0, 1]),
            "c": bar(1, position=[2, 0, 0.5], rotation=[0, np.pi / 2, 0]),
        },
        joints=[Revolute(*frames, [0, 1, 0], name=name) for name, frames in between.items()],
        gravity=[0, 0, -G],
        settings=Settings(t_end=0.2, step=1e-3, **settings),
    )


def test_redundant_constraints_are_named():
    with pytest.raises(ModelError) as error:
        simulate(four_bar())
    for text in (
        "20 constraints of which 3 are redundant",
        "A (translation 3, rotation 1, rotation 2)",
        "remove",
    ):
        assert text in str(error.value)


def test_without_redundant_constraints_the_motion_is_that_of_freed_joints():
    removed = simulate(four_bar(redundant="remove"))
    assert removed.solver["degrees_of_freedom"] == 1
    assert removed.solver["removed"]
    model = four_bar()
    freed = {"B": Spherical("a.r", "b.l", name="B")}
    freed["C"] = Universal("b.r", "c.l", [0, 1, 0], [0, 0, 1], name="C")
    by_hand = simulate(
        replace(model, joints=[freed.get(joint.name, joint) for joint in model.joints])
    )
    for body in ("a", "b", "c"):
        np.testing.assert_allclose(removed.body(body).x, by_hand.body(body).x, atol=1e-9)


def test_a_closed_loop_starts_from_a_joint_angle_and_its_rate():
    model = four_bar(redundant="remove")
    first = model.joints[0]
    asked = JOINTS[first.type](
        *first.between, first.axis, name=first.name, start={"angle": 0.5, "angle_rate": 2.0}
    )
    results = simulate(replace(model, joints=(asked, *model.joints[1:])))
    coordinates = results.joint("A").coordinates
    assert coordinates["angle"][0] == pytest.approx(0.5, abs=1e-12)
    assert coordinates["angle_rate"][0] == pytest.approx(2.0, abs=1e-9)
    assert results.solver["moved"] == pytest.approx(0.5, abs=1e-9)


def pendulum(place=(0.5, 0, 0), joint=None, **settings):
    """A bob half a meter from the pin, about z."""
    start = Start(position=place, velocity=settings.pop("velocity", [0, 0, 0]))
    bob = RigidBody(1.0, [0.1, 0.1, 0.1], {"pin": Frame([-0.5, 0, 0])}, start)
    pin = Revolute("ground.pin", "bob.pin", [0, 0, 1], name="pin")
    common = {"t_end": 0.01, "step": 1e-3, "ground_frames": {"pin": Frame()}}
    joints = [replace(pin, **(joint or {}))]
    return model_of({"bob": bob}, joints, **(common | settings))


JOINED = {
    "fixed": {},
    "spherical": {},
    "revolute": {"axis": [0, 0, 1]},
    "universal": {"axis": [0, 0, 1], "second_axis": [1, 0, 0]},
    "cylindrical": {"axis": [0, 0, 1]},
    "prismatic": {"axis": [0, 0, 1]},
    "planar": {"axis": [0, 0, 1]},
}


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("kind", JOINED)
def test_two_bodies_thrown_anywhere_are_joined(beam, kind, seed):
    """Slender ones too, which turn about their axes at next to no cost."""
    rng = np.random.default_rng(seed)
    bodies = {
        name: FlexibleBody(beam.element, Start(0.5 * rng.normal(size=3), rng.normal(size=3)))
        for name in "ab"
    }
    joint = JOINTS[kind]("a.tip", "b.root", name="joint", **JOINED[kind])
    start(Model(bodies, [joint], settings=Settings(t_end=1e-3, assemble=True)))


def test_a_joint_that_is_open_by_little_is_closed_and_told():
    results = simulate(pendulum([0.50001, 0, 0]))
    assert results.solver["assembly_error"] == pytest.approx(1e-5, rel=1e-9)
    assert results.solver["assembly_error_at"] == "joint 'pin'"
    assert results.solver["moved"] == pytest.approx(1e-5, rel=1e-3)
    np.testing.assert_allclose(results.frame("bob.pin").position[0], 0.0, atol=1e-14)
    with pytest.raises(ModelError, match=r"open by 0\.1 m"):
        simulate(pendulum([0.6, 0, 0]))
    assembled = simulate(pendulum([0.6, 0, 0], assemble=True)).solver
    assert (assembled["assembly_error"], assembled["moved"]) == (
        pytest.approx(0.1),
        pytest.approx(0.1, rel=1e-6),
    )


def test_velocities_that_open_a_joint_are_told_as_given():
    """By how much they do, not by how much they are changed: a bob thrown along its arm, and one
    thrown across it.
    """
    along = simulate(pendulum(velocity=[0.3, 0, 0])).solver
    assert (along["velocity_error"], along["velocity_error_at"]) == (
        pytest.approx(0.3, rel=1e-12),
        "joint 'pin'",
    )
    assert along["velocity_correction"] == pytest.approx(0.3, rel=1e-12)
    across = simulate(pendulum(velocity=[0, 0.3, 0])).solver
    assert across["velocity_error"] == pytest.approx(0.3, rel=1e-12)
    assert across["assembly_error"] == across["moved"] == 0.0


def test_what_is_asked_of_joints_is_no_misfit():
    """Nor are the rates of drives, which bodies at rest do not have."""
    asked = simulate(pendulum(joint={"start": {"angle": 0.4, "angle_rate": 3.0}})).solver
    assert asked["moved"] == pytest.approx(0.4, abs=1e-12)
    assert asked["velocity_correction"] == pytest.approx(3.0, rel=1e-9)
    driven = simulate(pendulum(joint={"angle": Polynomial((0.0, 2.0))})).solver
    assert driven["velocity_correction"] == pytest.approx(2.0, rel=1e-9)
    for told in (asked, driven):
        assert (told["assembly_error"], told["velocity_error"]) == (0.0, 0.0)
        assert told["assembly_error_at"] == told["velocity_error_at"] == ""


def test_equilibrium_is_sought_from_the_places_given():
    """The change of place counts from there; the angle asked for is where the search begins."""
    results = simulate(
        pendulum(joint={"start": {"angle": 0.3}}, gravity=[0, -G, 0], start="equilibrium")
    )
    np.testing.assert_allclose(
        results.body("bob").x, np.tile([0, -0.5, 0], (11, 1)), rtol=0, atol=1e-12
    )
    assert results.solver["moved"] == pytest.approx(np.pi / 2, abs=1e-11)
    assert (results.solver["assembly_error"], results.solver["velocity_correction"]) == (0.0, 0.0)


def contradictory(**rates):
    """A four-bar whose crank is asked for one rate, and its rocker for another or the like."""
    model = four_bar(redundant="remove")
    return replace(
        model,
        joints=[replace(j, start=rates[j.name]) if j.name in rates else j for j in model.joints],
    )


def falling(**settings):
    """A bob on a pin, and a stone that nothing holds."""
    model = pendulum(gravity=[0, -G, 0], start="equilibrium")
    return replace(
        model, bodies={**model.bodies, "stone": RigidBody(1.0, [1, 1, 1], {}, Start([0, 0, 1]))}
    )


IMPOSSIBLE = {
    "rates at odds": (
        lambda: contradictory(A={"angle_rate": 2.0}, D={"angle_rate": 1.0}),
        r"joint '[AD]': no rigid-body velocities satisfy it at the start",
    ),
    "angles at odds": (
        lambda: contradictory(A={"angle": 0.3}, D={"angle": 0.1}),
        r"joint '[A-D]': stays open by [\d.e-]+ however the bodies are placed",
    ),
    "a body that falls": (
        falling,
        r"start = 'equilibrium': none found, relative residual \S+ after 400 steps; the "
        r"largest residual is that of body 'stone'\. In the last state: "
        r"no joint, spring or contact holds body 'stone', .* 9\.81\d* N .*: it falls freely$",
    ),
    "a velocity": (
        lambda: pendulum(velocity=[0, 1, 0], start="equilibrium"),
        r"body 'bob': velocity: start = 'equilibrium' takes no velocity but steady_rotation, got "
        r"\[0.0, 1.0, 0.0\]",
    ),
    "a rate": (
        lambda: pendulum(joint={"start": {"angle_rate": 1.0}}, start="equilibrium"),
        r"joint 'pin': start: angle_rate: start = 'equilibrium' allows no rates but "
        r"steady_rotation, got 1.0",
    ),
}


@pytest.mark.parametrize("name", IMPOSSIBLE)
def test_a_start_that_cannot_be_is_refused(name):
    make, message = IMPOSSIBLE[name]
    with pytest.raises(ModelError, match=message):
        simulate(make())


def test_velocities_that_joints_take_away_are_told(beam):
    """Elastic bodies start without rates, so that a mass on the tip of a clamped beam rests."""

    def mass(speed: float) -> Model:
        return Model(
            bodies={
                "beam": FlexibleBody(beam.element, Start(position=[L / 2, 0, 0])),
                "mass": RigidBody(9.0, [1.0] * 3, start=Start([L, 0, 0], velocity=[0, speed, 0])),
            },
            joints=[Fixed("ground", "beam.root"), Spherical("beam.tip", "mass")],
            settings=Settings(t_end=1e-3),
        )

    words = r"body 'mass': starts with velocity = \[.*not with \[0, 0.01, 0\]"
    with pytest.warns(ValidityWarning, match=words):
        start(mass(0.01))
    with pytest.warns(ValidityWarning, match=words):
        Simulator(mass(0.01), [])
    with warnings.catch_warnings():
        warnings.simplefilter("error", ValidityWarning)
        start(mass(0.0))
        free = RigidBody(
            9.0, [1.0] * 3, start=Start(velocity=[1, 0, 0], angular_velocity=[0, 0, 1])
        )
        start(Model({"mass": free}, settings=Settings(t_end=1e-3, step=1e-4)))
