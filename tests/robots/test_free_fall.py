"""Robots fall as MuJoCo says; errors are a quarter at half the step."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import simulate

from .references import DATA, model_of, rates, rates_by_mujoco

STATES = {
    "two_links.urdf": {"shoulder": 0.3, "elbow": -0.4},
    "six_axes.urdf": {f"a{k}": 0.1 * k for k in range(1, 7)},
    "scara.urdf": {"shoulder": 0.2, "elbow": 0.5, "lift": -0.05},
}
T_END = 0.3


def freely(model):
    """A model without what MuJoCo leaves out here: stops."""
    return replace(model, stops=())


def largest_error(robot, folder, step, exact):
    model = freely(model_of(robot, folder, state=STATES[robot], t_end=T_END, step=step))
    found = rates(model)
    assert found.keys() == exact.keys()
    return max(abs(found[name] - exact[name]) for name in exact)


@pytest.mark.parametrize("robot", STATES)
def test_a_robot_falls_as_in_mujoco_with_errors_of_second_order(robot, tmp_path):
    exact = rates_by_mujoco(DATA / robot, STATES[robot], T_END)
    errors = [largest_error(robot, tmp_path, step, exact) for step in (1e-3, 5e-4)]
    assert max(map(abs, exact.values())) > 1.0
    assert errors[0] < 2e-3 * max(map(abs, exact.values()))
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.02)


def test_the_start_is_that_of_the_state(tmp_path):
    model = model_of("six_axes.urdf", tmp_path, state={"a2": 0.7, "a3": -0.4}, t_end=1e-3)
    results = simulate(freely(model))
    angles = {joint.name: results.joint(joint.name).angle[0] for joint in model.joints}
    expected = dict.fromkeys(("a1", "a4", "a5", "a6"), 0.0) | {"a2": 0.7, "a3": -0.4}
    assert angles == pytest.approx(expected, abs=1e-14)


def test_a_free_base_falls_with_all_that_hangs_on_it(tmp_path):
    """Without a ground the center of mass of a robot of any joints falls by g t^2 / 2."""
    robot = model_of("two_links.urdf", tmp_path, base="free", state={"elbow": 1.0}, t_end=0.2)
    model = freely(robot)
    results = simulate(model)
    masses = {name: body.mass for name, body in model.bodies.items()}
    assert sum(masses.values()) == pytest.approx(5.0 + 2.0 + 1.2 + 0.5)
    moments = sum(mass * results.body(name).x[:, 2] for name, mass in masses.items())
    fall = (moments[-1] - moments[0]) / sum(masses.values())
    assert fall == pytest.approx(-0.5 * 9.81 * 0.2**2, rel=1e-6)
    np.testing.assert_allclose(results.momentum.linear[-1, :2], 0.0, atol=1e-9)
