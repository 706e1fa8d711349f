"""Rounding is not taken for an error: large prestress, small masses, forces that cancel."""

from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    Force,
    Frame,
    Model,
    ModelError,
    Revolute,
    RigidBody,
    Settings,
    Spring,
    Start,
    simulate,
)

Z = [0, 0, 1]


def string(tension, frames=("bob", "bob"), mass=1.0, **settings):
    """A bead on a taut string of two springs of 1 m, which starts 1 mm off."""
    ends = {"left": Frame([-0.05, 0, 0]), "right": Frame([0.05, 0, 0])}
    bead = RigidBody(mass, [0.01 * mass] * 3, ends, Start([0, 1e-3, 0]))
    stiffness = 10.0 * tension
    halves = [
        Spring(side, "point", (f"ground.{side}", frame), stiffness=stiffness, rest=[0.9])
        for side, frame in zip(("left", "right"), frames, strict=True)
    ]
    posts = {"left": Frame([-1.0, 0, 0]), "right": Frame([1.0, 0, 0])}
    return Model({"bob": bead}, springs=halves, ground_frames=posts, settings=Settings(**settings))


@pytest.mark.parametrize("tension", [1e2, 1e9, 5e11, 1e14])
@pytest.mark.parametrize("mass", [1e-12, 1.0, 1e6])
def test_a_taut_string_swings_at_its_frequency(tension, mass):
    """omega^2 = 2 T / (m L), whatever the digits of the tension that cancel."""
    period = 2.0 * np.pi / np.sqrt(2.0 * tension / mass)
    results = simulate(string(tension, mass=mass, t_end=period, step=period / 400))
    expected = 1e-3 * np.cos(2.0 * np.pi * results.time / period)
    np.testing.assert_allclose(results.body("bob").x[:, 1], expected, rtol=0, atol=2e-6)


@pytest.mark.parametrize("frames", [("bob", "bob"), ("bob.left", "bob.right")])
def test_a_prestress_that_cancels_is_no_residual(frames):
    """5e11 N on both sides of a body, in steps of 20 periods: at one frame, and at two."""
    results = simulate(string(5e11, frames, t_end=0.2, step=1e-4))
    assert np.abs(results.body("bob").x).max() < 1.5e-3


def test_a_load_on_the_frame_of_the_spring_that_holds_it_is_in_equilibrium():
    """Their sum vanishes, and is no measure of the residual."""
    tilted = Frame(rotation=[0.3, -0.2, 0.5])
    bush = Spring("bush", "bushing", ("ground.wall", "bob"), stiffness=[1e6, 1e6, 1e6, 1, 1, 1])
    model = Model(
        {"bob": RigidBody(1.0, [0.1, 0.1, 0.1])},
        springs=[bush],
        loads=[Force("bob", [1.0, 2.0, 3.0], Constant(1.0))],
        ground_frames={"wall": tilted},
        settings=Settings(t_end=1e-3, step=1e-3, start="equilibrium"),
    )
    x = simulate(model).body("bob").x
    np.testing.assert_allclose(x, np.tile([1e-6, 2e-6, 3e-6], (2, 1)), rtol=1e-9)


def chain(masses, **settings):
    """Links of 0.2 m that hang on one another, the first on the ground."""
    bodies = {}
    for i, mass in enumerate(masses):
        frames = {"near": Frame([-0.1, 0, 0]), "far": Frame([0.1, 0, 0])}
        inertia = mass / 300.0 * np.array([1.0, 2.0, 3.0])
        bodies[f"b{i}"] = RigidBody(mass, inertia, frames, Start([0.1 + 0.2 * i, 0, 0]))
    parents = ["ground", *(f"b{i}.far" for i in range(len(masses) - 1))]
    joints = [Revolute(parent, f"b{i}.near", Z, name=f"j{i}") for i, parent in enumerate(parents)]
    options = {"t_end": 0.2, "step": 1e-3} | settings
    return Model(bodies, joints, gravity=[0, -9.81, 0], settings=Settings(**options))


def test_a_link_without_weight_between_heavy_ones_has_a_limit():
    """Motion and forces change with its mass, and then no more."""

    def end(mass):
        results = simulate(chain([1.0, mass, 1.0]))
        return np.hstack([results.body("b2").x, results.joint("j1").force])

    limit = end(1e-8)
    assert np.abs(end(1e-4) - limit).max() > 1e-5
    for mass in (1e-10, 1e-12, 1e-15):
        np.testing.assert_allclose(end(mass), limit, rtol=0, atol=1e-6)


def test_bodies_too_unlike_are_refused_by_name():
    message = (
        r"joint 'j1': expected masses in a ratio of at most 1e\+15, .* "
        r"got 1e-12 kg \(b1\) and 1e\+06 kg \(b0\)$"
    )
    with pytest.raises(ModelError, match=message):
        simulate(chain([1e6, 1e-12, 1e6]))


def test_no_order_of_the_bodies_changes_their_accelerations():
    """A chain that two springs close, in all orders of its bodies and of the springs."""
    ties = [
        Spring("tie", "point", ("b2.far", "ground.post"), stiffness=1e4),
        Spring("strut", "point", ("b0.far", "b2.far"), stiffness=1e5, damping=10.0),
    ]
    model = replace(
        chain([1.0, 2.0, 0.5]), springs=ties, ground_frames={"post": Frame([0.5, 0.4, 0.1])}
    )
    reference = simulate(model)
    for order in permutations(model.bodies):
        bodies = {name: model.bodies[name] for name in order}
        results = simulate(replace(model, bodies=bodies, springs=ties[::-1]))
        for name in bodies:
            change = np.diff(results.body(name).v - reference.body(name).v, axis=0)
            # of accelerations of 1e2: the rounding of positions over h^2 comes back thirtyfold
            assert np.abs(change).max() / 1e-3 < 30 * 2.2e-16 * 4 / 1e-3**2
