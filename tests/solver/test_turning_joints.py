"""How far a body on joints may turn in a step before forces of its joints alternate and grow."""

import warnings

import numpy as np
import pytest
from duhamel.solver import (
    ConvergenceError,
    Frame,
    Model,
    RigidBody,
    Settings,
    Spherical,
    Start,
    simulate,
)

H = 1e-3


def rods(turn, rho_inf, steps=3000):
    """Two rods in a row that turn about the ground by so much in a step."""
    spin, joints, bodies = turn / H, [], {}
    ends = {"near": Frame([-0.1, 0, 0]), "far": Frame([0.1, 0, 0])}
    for i, parent in enumerate(("ground", "b0.far")):
        x = 0.1 + 0.2 * i
        start = Start([x, 0, 0], velocity=[0, spin * x, 0], angular_velocity=[0, 0, spin])
        bodies[f"b{i}"] = RigidBody(1.0, [1e-4, 1 / 300, 1 / 300], ends, start)
        joints.append(Spherical(parent, f"b{i}.near", name=f"j{i}"))
    return Model(bodies, joints, settings=Settings(t_end=steps * H, step=H, rho_inf=rho_inf))


def run(model):
    """Results, and the warnings about rotation in a step."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        results = simulate(model)
    return results, [str(w.message) for w in caught if "rotation per step" in str(w.message)]


@pytest.mark.parametrize("rho_inf", [0.8, 0.9, 0.95, 0.99])
def test_below_the_limit_the_force_is_that_of_the_circle(rho_inf):
    turn = 0.5 * (1.0 - rho_inf)
    results, told = run(rods(turn, rho_inf))
    force = np.linalg.norm(results.joint("j0").force, axis=1)
    np.testing.assert_allclose(force, (0.1 + 0.3) * (turn / H) ** 2, rtol=0.05)
    assert not told
    assert max(results.validity.values("joint_turn").values()) < 1.0


@pytest.mark.parametrize("rho_inf", [0.9, 0.95, 0.99])
def test_beyond_the_limit_the_run_says_so(rho_inf):
    """In words at its end, while forces grow, or in the error that they end in."""
    _, told = run(rods(0.75 * (1.0 - rho_inf), rho_inf, steps=10))
    assert told
    assert all(line.startswith("jointed body 'b") for line in told)
    cause = r"likely cause: jointed body 'b.': rotation per step"
    with pytest.raises(ConvergenceError, match=cause):
        run(rods(2.0 * (1.0 - rho_inf), rho_inf, steps=10000))


def test_a_top_turns_as_fast_as_it_likes():
    """Its joint is on the axis that it spins about."""
    start = Start([0, 0, 0.1], angular_velocity=[0, 0, 300.0])
    top = RigidBody(1.0, [0.01, 0.01, 0.02], {"tip": Frame([0, 0, -0.1])}, start)
    joint = Spherical("ground", "top.tip", name="tip")
    results, told = run(
        Model({"top": top}, [joint], gravity=[0, 0, -9.81], settings=Settings(t_end=1.0, step=H))
    )
    np.testing.assert_allclose(results.joint("tip").force[:, 2], 9.81, rtol=1e-6)
    assert not told
