"""Bodies with three and more interfaces: what the order of interfaces, and those that carry
nothing, do not change.
"""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    FlexibleBody,
    Force,
    Frame,
    Harmonic,
    Model,
    Place,
    Revolute,
    RigidBody,
    Settings,
    Spring,
    Start,
    Torque,
    Universal,
    simulate,
)

from .frameworks import framework

HUB = (0.0, 0.0, 0.0)
JACK = {"a": (-0.2, 0, 0), "b": (0.2, 0, 0), "c": (0, 0.25, 0), "d": (0, 0, 0.15)}
"""four bars from a hub: a T with a fourth arm out of its plane"""
SIDE, DEPTH = 0.3, 0.2
CORNERS = {"a": (0, 0, 0), "b": (SIDE, 0, 0), "d": (0, DEPTH, 0), "c": (SIDE, DEPTH, 0)}
GRID = CORNERS | {"e": (2 * SIDE, 0, 0), "f": (2 * SIDE, DEPTH, 0)}
"""two rectangles side by side: seven bars and two closed loops"""
BARS = {
    "jack": [(HUB, end) for end in JACK.values()],
    "grid": [(GRID[i], GRID[j]) for i, j in ("ab", "be", "dc", "cf", "ad", "bc", "ef")],
}
POINTS = {"jack": JACK | {"hub": HUB}, "grid": GRID}
SHAPES = pytest.mark.parametrize("shape", ["jack", "grid"])


def rig(shape, folder, names):
    """A framework with the interfaces `names`: held at a, spring at b, a mass at c, and pulled at
    d.
    """
    points = {name: POINTS[shape][name] for name in names}
    element = framework(folder, BARS[shape], points, stiffness=0.3, step=1e-3)
    eye = Frame([0.0, 0.0, 0.05])
    hook = Frame(element.interface("b").X + np.array([0.1, 0.2, 0.05]))
    return Model(
        bodies={
            "body": FlexibleBody(element),
            "mass": RigidBody(
                0.05, [1e-4, 2e-4, 2e-4], {"eye": eye}, Start(place=Place("eye", "body.c"))
            ),
        },
        joints=(
            Revolute("ground", "body.a", [0.2, 1.0, 0.3], name="pivot"),
            Universal("body.c", "mass.eye", [1, 0, 0], [0, 1, 0], name="ball"),
        ),
        springs=(Spring("coil", "point", ("ground.hook", "body.b"), stiffness=30.0, damping=0.02),),
        loads=(
            Force("body.d", [0.3, 1.0, 0.5], Harmonic(0.2, 11.0)),
            Torque("body.d", [0.0, 1.0, 1.0], Harmonic(0.01, 17.0), follower=True),
        ),
        ground_frames={"hook": hook},
        gravity=[0.0, 0.0, -9.81],
        settings=Settings(t_end=0.2),
    )


def motion(results):
    """Positions and displacements of the interfaces a to d, and of the mass."""
    frames = [results.frame(f"body.{name}") for name in "abcd"]
    return (
        np.hstack([results.body("mass").x, *(frame.position for frame in frames)]),
        np.hstack([frame.u for frame in frames]),
    )


def assert_equal(found, expected):
    for here, there in zip(motion(found), motion(expected), strict=True):
        assert np.abs(here - there).max() < 1e-10 * np.abs(there).max()


@SHAPES
def test_the_order_of_interfaces_does_not_matter(shape, tmp_path):
    names, rng = list(POINTS[shape]), np.random.default_rng(0)
    expected = simulate(rig(shape, tmp_path, names))
    assert np.abs(motion(expected)[1]).max() > 1e-3
    for _ in range(5):
        assert_equal(simulate(rig(shape, tmp_path, rng.permutation(names))), expected)


@SHAPES
def test_interfaces_that_carry_nothing_do_not_matter(shape, tmp_path):
    expected = simulate(rig(shape, tmp_path, "abcd"))
    found = simulate(rig(shape, tmp_path, list(POINTS[shape])))
    assert_equal(found, expected)


@SHAPES
def test_an_idle_interface_moves_as_one_that_is_loaded_by_zero(shape, tmp_path):
    idle = {"jack": "hub", "grid": "f"}[shape]
    model = rig(shape, tmp_path, list(POINTS[shape]))
    free = simulate(model).frame(f"body.{idle}")
    nothing = Force(f"body.{idle}", [1.0, 0.0, 0.0], Harmonic(0.0, 1.0))
    touched = simulate(replace(model, loads=(*model.loads, nothing))).frame(f"body.{idle}")
    assert np.abs(free.u).max() > 1e-4
    np.testing.assert_allclose(touched.position, free.position, rtol=0, atol=1e-11)
    np.testing.assert_allclose(touched.velocity, free.velocity, rtol=0, atol=1e-9)
