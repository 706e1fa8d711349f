"""Closed loops with flexible members: they stay closed, keep their energy, and tend to their rigid selves."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    FlexibleBody,
    Frame,
    Function,
    Joint,
    Load,
    Model,
    ModelError,
    Polynomial,
    RigidBody,
    Start,
    simulate,
)

from .frameworks import bar

CRANK, COUPLER, ROCKER, BASE = 0.1, 0.3, 0.25, 0.3
ANGLE = 1.0
"""of the crank at the start"""
X, Z = np.eye(3)[[0, 2]]
STEPS = np.array([4e-4, 2e-4, 1e-4])
TOLERANCE = 1e-10
"""of Newton's method: of constraints relative to the motion in a step"""


def pins(angle):
    """B and C of the rigid four-bar A B C D, A at the origin, D at (BASE, 0): two circles meet in C."""
    B, D = CRANK * np.array([np.cos(angle), np.sin(angle), 0.0]), BASE * X
    distance = np.linalg.norm(D - B)
    along = (D - B) / distance
    foot = (COUPLER**2 - ROCKER**2 + distance**2) / (2 * distance)
    return B, B + foot * along + np.sqrt(COUPLER**2 - foot**2) * np.cross(Z, along)


def between(p, q):
    """Position and rotation of a bar along its own x axis, from p to q."""
    axis = np.cross(X, (q - p) / np.linalg.norm(q - p))
    turn = np.arctan2(np.linalg.norm(axis), X @ (q - p) / np.linalg.norm(q - p))
    return {"position": 0.5 * (p + q), "rotation": turn * axis / np.linalg.norm(axis)}


def crank(angle=0.0):
    frames = {"pin": Frame([-CRANK / 2, 0, 0]), "end": Frame([CRANK / 2, 0, 0])}
    start = Start(0.5 * CRANK * np.array([np.cos(angle), np.sin(angle), 0.0]), [0, 0, angle])
    return RigidBody(0.02, [1e-5, 2e-5, 2e-5], frames, start)


def four_bar(folder, stiffness=0.05, drive=None, **settings):
    """A rigid crank; a coupler and a rocker that bend by some per cent of their length."""
    B, C = pins(ANGLE)
    return Model(
        bodies={
            "crank": crank(ANGLE),
            "rod": FlexibleBody(bar(folder, COUPLER, stiffness=stiffness), Start(**between(B, C))),
            "rocker": FlexibleBody(bar(folder, ROCKER, stiffness=stiffness), Start(**between(C, BASE * X))),
        },
        joints=(
            Joint("A", "revolute", ("ground.A", "crank.pin"), Z, angle=drive),
            Joint("B", "revolute", ("crank.end", "rod.left"), Z),
            Joint("C", "revolute", ("rod.right", "rocker.left"), Z),
            Joint("D", "revolute", ("rocker.right", "ground.D"), Z),
        ),
        ground_frames={"A": Frame(), "D": Frame(BASE * X)},
        **settings,
    )


def slider_crank(folder, **settings):
    B = crank(ANGLE).start.position * 2
    P = (B[0] + np.sqrt(COUPLER**2 - B[1] ** 2)) * X
    return Model(
        bodies={
            "crank": crank(ANGLE),
            "rod": FlexibleBody(bar(folder, COUPLER, stiffness=0.05), Start(**between(B, P))),
            "piston": RigidBody(0.03, [1e-5, 1e-5, 1e-5], {"eye": Frame()}, Start(P)),
        },
        joints=(
            Joint("A", "revolute", ("ground", "crank.pin"), Z),
            Joint("B", "revolute", ("crank.end", "rod.left"), Z),
            Joint("C", "revolute", ("rod.right", "piston.eye"), Z),
            Joint("D", "prismatic", ("ground", "piston"), X),
        ),
        **settings,
    )


def spatial_four_bar(folder, **settings):
    """Crank and rocker about skew axes, a flexible rod on a spherical and a universal joint, bent and twisted."""
    B, C, D = CRANK * X, np.array([0.25, 0.2, 0.15]), np.array([0.25, 0.2, -0.1])
    rod = FlexibleBody(bar(folder, float(np.linalg.norm(C - B)), stiffness=0.05), Start(**between(B, C)))
    frames = {"pin": Frame([0, 0, -0.125]), "end": Frame([0, 0, 0.125])}
    return Model(
        bodies={
            "crank": crank(),
            "rod": rod,
            "rocker": RigidBody(0.05, [2e-4, 2e-4, 1e-5], frames, Start(0.5 * (C + D))),
        },
        joints=(
            Joint("A", "revolute", ("ground", "crank.pin"), Z),
            Joint("B", "spherical", ("crank.end", "rod.left")),
            Joint("C", "universal", ("rod.right", "rocker.end"), np.cross(C - B, X), C - B),
            Joint("D", "revolute", ("rocker.pin", "ground"), X),
        ),
        **settings,
    )


def pushed(make, folder, h):
    """A smooth torque turns the crank for 0.1 s."""
    torque = Load("torque", "crank", Z, Function(lambda t: 0.05 * np.sin(np.pi * t / 0.1) ** 2))
    return simulate(make(folder, loads=(torque,), t_end=0.1, step=h))


def speed(results):
    """The largest velocity of translation, and of rotation at the far end of the mechanism."""
    motions = [results.body(name).v for name in ("crank", "rod")]
    return max(np.abs(v[:, :3]).max() for v in motions) + BASE * max(np.abs(v[:, 3:]).max() for v in motions)


@pytest.mark.parametrize("make", [four_bar, slider_crank, spatial_four_bar])
def test_a_flexible_loop_stays_closed_and_converges_with_order_two(make, tmp_path):
    """Ends of the rod and energy balance err with the square of the step; joints open by Newton's tolerance at most."""
    finest = pushed(make, tmp_path, 2.5e-5)
    bent = np.abs(finest.frame("rod.right").u).max()
    assert bent > 3e-4
    errors, balances = [], []
    for h in STEPS:
        results = pushed(make, tmp_path, h)
        assert results.solver["degrees_of_freedom"] == 1
        for joint in make(tmp_path).joints[1:3]:
            A, B = (results.frame(name).position for name in joint.between)
            np.testing.assert_allclose(A, B, rtol=0, atol=TOLERANCE * h * speed(results))
        exact = [finest.frame(f"rod.{end}").position[:: round(STEPS[0] / 2.5e-5)] for end in ("left", "right")]
        found = [results.frame(f"rod.{end}").position[:: round(STEPS[0] / h)] for end in ("left", "right")]
        errors.append(np.abs(np.array(found) - exact).max())
        balances.append(np.abs(results.energy.balance).max() / results.energy.kinetic.max())
    for values in (errors, balances):
        np.testing.assert_allclose(np.log2(np.array(values[:-1]) / values[1:]), 2.0, atol=0.1, err_msg=str(values))


def test_a_stiff_four_bar_moves_like_a_rigid_one(tmp_path):
    """The joint between coupler and rocker off its closed form: by a tenth when the bars are ten times as stiff."""
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
        name: replace(body, start=Start(body.start.position + 0.02 * rng.normal(size=3), body.start.rotation + 0.1 * Z))
        for name, body in model.bodies.items()
    }
    with pytest.raises(ModelError, match="assemble = true would close it"):
        simulate(replace(model, bodies=thrown))
    results = simulate(replace(model, bodies=thrown, assemble=True))
    B, C = (results.frame(f"rod.{end}").position[0] for end in ("left", "right"))
    for found, expected in zip((B, C), pins(np.arctan2(B[1], B[0])), strict=True):
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)

    asked = replace(model.joints[0], start={"angle": 0.7, "angle_rate": 3.0})
    results = simulate(replace(model, joints=(asked, *model.joints[1:])))
    rod = results.frame("rod.right")
    np.testing.assert_allclose(rod.position[0], pins(ANGLE + 0.7)[1], rtol=0, atol=1e-12)
    slope = (pins(ANGLE + 0.7 + 1e-5)[1] - pins(ANGLE + 0.7 - 1e-5)[1]) / 2e-5
    np.testing.assert_allclose(rod.velocity[0, :3], 3.0 * slope, rtol=0, atol=1e-8)
