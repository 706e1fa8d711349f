"""Where Newton's method fails the error says why, as far as that shows."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    Contact,
    ConvergenceError,
    Force,
    Frame,
    Function,
    Impact,
    Model,
    Polynomial,
    Revolute,
    RigidBody,
    Settings,
    SmoothFunction,
    Spherical,
    Spring,
    Start,
    TabulatedLaw,
    simulate,
)
from duhamel.solver.simulation import failure
from duhamel.solver.start.initial import initialize

Z = [0, 0, 1]
HALF = {"near": Frame([-0.5, 0, 0]), "far": Frame([0.5, 0, 0])}


def bar(mass=1.0, inertia=(0.1, 0.1, 0.1), **start):
    return RigidBody(mass, inertia, HALF, Start(**start))


def one(body, joints=(), loads=(), springs=(), **settings):
    options = {"t_end": 1.0, "step": 1e-3} | settings
    post = {"post": Frame([-1.0, 0, 0])}
    return Model(
        {"a": body}, joints, loads, springs, ground_frames=post, settings=Settings(**options)
    )


def pushed(signal, body=None, joints=()):
    return one(body or bar(), joints, [Force("a", [0, 1, 0], signal)])


def late(value):
    """A function of time that becomes this value after 0.5 s."""
    return lambda t: value if t > 0.5005 else 0.0


def driven(value):
    drive = SmoothFunction(late(value), lambda t: 0.0, lambda t: 0.0)
    return one(bar(), [Revolute("ground", "a", Z, name="pivot", angle=drive)])


def sledge():
    """On four legs, whose friction sticks by a spring beyond all digits of positions."""
    legs = {f"leg{k}": Frame([0.05 * (-1) ** k, 0.05 * (-1) ** (k // 2), -0.05]) for k in range(4)}
    law = {"impact": Impact(1e6, damping=1.0), "friction": 0.3, "tangential_stiffness": 1e12}
    contacts = [Contact(leg, ("ground.floor", f"a.{leg}"), "plane", 0.0, Z, **law) for leg in legs]
    start = Start([0, 0, 0.05 - 9.81 / 4e6], velocity=[1, 0, 0])
    return Model(
        {"a": RigidBody(1.0, [0.01] * 3, legs, start)},
        contacts=contacts,
        gravity=[0, 0, -9.81],
        ground_frames={"floor": Frame()},
        settings=Settings(t_end=0.6, step=1e-3),
    )


def rocker():
    """A crank that turns farther than the rod and the rocker reach."""
    A, B, D = np.zeros(3), np.array([np.cos(0.9), np.sin(0.9), 0.0]), np.array([1.2, 0.0, 0.0])
    half = 0.5 * (D - B)
    C = B + half + np.sqrt(0.49 - half @ half) * np.cross(Z, half) / np.linalg.norm(half)

    def link(p, q):
        ends = {"near": Frame(0.5 * (p - q)), "far": Frame(0.5 * (q - p))}
        return RigidBody(1.0, [0.05, 0.05, 0.08], ends, Start(0.5 * (p + q)))

    sides = {
        "A": ("ground", "crank.near"),
        "B": ("crank.far", "rod.near"),
        "C": ("rod.far", "rocker.far"),
        "D": ("ground", "rocker.near"),
    }
    joints = [Revolute(*between, Z, name=name) for name, between in sides.items()]
    joints[0] = replace(joints[0], angle=Polynomial((0.0, 1.0)))
    settings = Settings(t_end=3.0, step=1e-3, redundant="remove")
    bodies = {"crank": link(A, B), "rod": link(B, C), "rocker": link(D, C)}
    return Model(bodies, joints, settings=settings)


PIVOT = (Revolute("ground", "a.near", Z, name="pivot"),)
WALL = TabulatedLaw((-1.0, -0.5, -0.4999999, 1.0), (-1e9, -1e9, 0.0, 0.0))
CASES = {
    "a load that is no number": (
        lambda: pushed(Function(late(np.nan))),
        "in step 501 .* likely cause: load (force) on 'a': its signal is nan at this time",
    ),
    "a load without end": (
        lambda: pushed(Function(late(np.inf))),
        "in step 501 .* likely cause: load (force) on 'a': its signal is inf at this time",
    ),
    "a load that overflows": (
        lambda: pushed(Function(late(1e250))),
        "in step 501 .* likely cause: load (force) on 'a': its signal is 1e+250 at this time",
    ),
    "a drive that is no number": (
        lambda: driven(np.nan),
        "in step 501 .* likely cause: joint 'pivot': its drive is nan here",
    ),
    "a drive that jumps": (
        lambda: driven(2.0),
        "likely cause: body 'a' of 1 kg turns by 5.9",
    ),
    "a body that spins fast": (
        lambda: one(
            RigidBody(1.0, [0.1, 0.2, 0.25], HALF, Start(angular_velocity=[1e3, 3e3, 5e2])),
            [Spherical("ground", "a.near", name="ball")],
        ),
        "likely cause: jointed body 'a': rotation per step .* take a smaller step",
    ),
    "a body without mass under a force": (
        lambda: pushed(Constant(1.0), bar(1e-30, [1e-30] * 3), PIVOT),
        "likely cause: body 'a' of 1e-30 kg turns by .* it is too light for its loads",
    ),
    "a body without mass on a spring": (
        lambda: one(
            bar(1e-30, [1e-30] * 3),
            springs=[Spring("pull", "point", ("ground.post", "a"), stiffness=1e5, rest=[0.1])],
        ),
        "likely cause: body 'a' of 1e-30 kg moves by .* m in this step; it is too light",
    ),
    "a linkage beyond its reach": (
        rocker,
        "likely cause: a singular pose, with dependent constraints A (.*), B (.*), C (.*), "
        "D (.*); its drive requires a pose that the mechanism cannot reach",
    ),
    "a wall": (
        lambda: one(
            bar(velocity=[-10, 0, 0]),
            springs=[Spring("wall", "point", ("ground.post", "a"), law=WALL, rest=[1.0])],
        ),
        "likely cause: spring 'wall': its law is too steep there for the step",
    ),
    "a sledge on rigid bristles": (
        sledge,
        "sticks by a spring of 1e+12, which bends by .* before it slips",
    ),
    "few iterations": (
        lambda: replace(
            one(bar(position=[0.5, 0, 0]), PIVOT, max_iterations=1), gravity=[0, -9.81, 0]
        ),
        "likely cause: max_iterations = 1 are few",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_the_likely_cause_is_told(name):
    make, message = CASES[name]
    for mark in "().+":
        message = message.replace(mark, rf"\{mark}")
    message = message.replace(r"\.*", ".*")
    with pytest.raises(ConvergenceError, match=message) as caught:
        simulate(make())
    assert "try a smaller step" not in str(caught.value)
    assert "\n" not in str(caught.value)


def test_where_no_cause_shows_a_smaller_step_is_advised():
    beginning = initialize(one(bar()))
    error = failure(beginning.lowered, beginning.state, beginning.work, 7, 1e-3, "")
    assert str(error).endswith(
        "relative residual 1.000e-03, tolerance 1.0e-10; try a smaller step in [simulation]"
    )
    assert (error.step, error.time, error.residual) == (7, 7e-3, 1e-3)


def test_a_soft_spring_is_no_cause_and_a_stiff_one_is():
    for stiffness, cause in ((1e2, "try a smaller step"), (1e9, "spring 'pull': its period there")):
        spring = Spring("pull", "point", ("ground.post", "a"), stiffness=stiffness)
        beginning = initialize(one(bar(), springs=[spring]))
        error = failure(beginning.lowered, beginning.state, beginning.work, 7, 1e-3, "")
        assert cause in str(error)
