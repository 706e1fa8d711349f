"""Closed loops with flexible members: they stay closed, keep their energy, and tend to their rigid
selves.
"""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    FlexibleBody,
    Frame,
    Function,
    Model,
    ModelError,
    Polynomial,
    RigidBody,
    Settings,
    Spherical,
    Start,
    Torque,
    Universal,
    simulate,
)
from scipy.spatial.transform import Rotation

from .frameworks import bar, framework
from .linkages import ANGLE, BASE, Z, four_bar, pins, slider_crank, spatial_four_bar
from .transformed import turned

STEPS = np.array([4e-4, 2e-4, 1e-4])
TOLERANCE = 1e-10
"""of Newton's method: of constraints relative to the motion in a step"""


def speed(results):
    """The largest velocity of translation, and of rotation at the far end of the mechanism."""
    motions = [results.body(name).v for name in ("crank", "rod")]
    return max(np.abs(v[:, :3]).max() for v in motions) + BASE * max(
        np.abs(v[:, 3:]).max() for v in motions
    )


@pytest.mark.parametrize("make", [four_bar, slider_crank, spatial_four_bar])
def test_a_flexible_loop_stays_closed_and_converges_with_order_two(make, tmp_path):
    """Ends of the rod and energy balance err with the square of the step; joints open by Newton's
    tolerance at most.
    """
    torque = Torque("crank", Z, Function(lambda t: 0.05 * np.sin(np.pi * t / 0.1) ** 2))
    model = make(tmp_path, loads=(torque,), t_end=0.1)
    finest = simulate(model.with_settings(step=2.5e-5))
    assert np.abs(finest.frame("rod.right").u).max() > 3e-4
    errors, balances = [], []
    for h in STEPS:
        results = simulate(model.with_settings(step=h))
        for joint in model.joints[1:3]:
            A, B = (results.frame(name).position for name in joint.between)
            np.testing.assert_allclose(A, B, rtol=0, atol=TOLERANCE * h * speed(results))
        exact = [
            finest.frame(f"rod.{end}").position[:: round(STEPS[0] / 2.5e-5)]
            for end in ("left", "right")
        ]
        found = [
            results.frame(f"rod.{end}").position[:: round(STEPS[0] / h)]
            for end in ("left", "right")
        ]
        errors.append(np.abs(np.array(found) - exact).max())
        balances.append(np.abs(results.energy.balance).max() / results.energy.kinetic.max())
    for values in (errors, balances):
        np.testing.assert_allclose(
            np.log2(np.array(values[:-1]) / values[1:]), 2.0, atol=0.1, err_msg=str(values)
        )


def test_a_stiff_four_bar_moves_like_a_rigid_one(tmp_path):
    """The joint between coupler and rocker off its closed form: by a tenth when the bars are ten
    times as stiff.
    """
    drive = Polynomial((0.0, 0.0, 0.0, 2 * np.pi / 0.2**3))
    errors = []
    for stiffness in (10.0, 100.0, 1000.0):
        results = simulate(four_bar(tmp_path, stiffness, drive, t_end=0.2))
        exact = np.array([pins(ANGLE + drive(t))[1] for t in results.time])
        errors.append(np.abs(results.frame("rod.right").position - exact).max())
    np.testing.assert_allclose(np.array(errors[:-1]) / errors[1:], 10.0, rtol=0.02)
    assert errors[-1] < 2e-9


def test_a_flexible_four_bar_is_assembled_at_the_angle_asked_for(tmp_path):
    """Bodies thrown about, and the pins and their velocities where the closed form has them."""
    model, rng = four_bar(tmp_path, t_end=1e-3), np.random.default_rng(0)
    thrown = {
        name: replace(
            body,
            start=Start(
                body.start.position + 0.02 * rng.normal(size=3), body.start.rotation + 0.1 * Z
            ),
        )
        for name, body in model.bodies.items()
    }
    with pytest.raises(ModelError, match="assemble = true would close it"):
        simulate(replace(model, bodies=thrown))
    results = simulate(replace(model, bodies=thrown).with_settings(assemble=True))
    B, C = (results.frame(f"rod.{end}").position[0] for end in ("left", "right"))
    for found, expected in zip((B, C), pins(np.arctan2(B[1], B[0])), strict=True):
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)

    asked = replace(model.joints[0], start={"angle": 0.7, "angle_rate": 3.0})
    results = simulate(replace(model, joints=(asked, *model.joints[1:])))
    rod = results.frame("rod.right")
    np.testing.assert_allclose(rod.position[0], pins(ANGLE + 0.7)[1], rtol=0, atol=1e-12)
    slope = (pins(ANGLE + 0.7 + 1e-5)[1] - pins(ANGLE + 0.7 - 1e-5)[1]) / 2e-5
    np.testing.assert_allclose(rod.velocity[0, :3], 3.0 * slope, rtol=0, atol=1e-8)


@pytest.mark.parametrize("shift", [0.0, 1000.0])
def test_a_loop_that_elasticity_alone_opens_does_not_brake_a_spin(shift, tmp_path):
    """A link between two points of a flexible body: of rigid motion its joints say one thing twice,
    whatever rounding of coordinates makes of it. A thin bar on one of them spins on.
    """
    bar_ends, corner = {"left": (0, 0, 0), "right": (0.2, 0, 0)}, {"tip": (0.1, 0, 0.15)}
    arms = [((0.1, 0, 0), point) for point in (bar_ends | corner).values()]
    wing = framework(tmp_path, arms, bar_ends | corner, elements=2)
    thin = bar(tmp_path, 0.2, elements=3)
    X = {interface.name: interface.X for interface in wing.interfaces}
    bodies = {
        "wing": FlexibleBody(wing, start=Start(angular_velocity=[-3.2, -3.1, 1.4])),
        "bar": FlexibleBody(
            thin, start=Start(X["tip"] - thin.interfaces[0].X, angular_velocity=[3.0, 0, 0])
        ),
        "link": RigidBody(
            0.05,
            [1e-3] * 3,
            {
                "one": Frame(0.5 * (X["left"] - X["tip"])),
                "two": Frame(0.5 * (X["tip"] - X["left"])),
            },
            Start(0.5 * (X["left"] + X["tip"])),
        ),
    }
    joints = [
        Universal("ground", "wing.left", [1, 0, 0], [0, 1, 0], name="pivot"),
        Spherical("wing.tip", "bar.left", name="end"),
        Spherical("link.one", "wing.left", name="first"),
        Spherical("bar.left", "link.two", name="second"),
    ]
    model = Model(bodies, joints, settings=Settings(t_end=4e-4, step=2e-4))
    turn = Rotation.from_rotvec([1.1, -2.0, 0.7])
    found = simulate(turned(model, turn, shift * np.array([0.6, -0.8, 0.0])))
    assert found.body("bar").v[0, 3] == pytest.approx(3.0, rel=1e-6)
