"""Loads that depend on the velocity of their frame."""

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    Drag,
    Force,
    Model,
    ModelError,
    RigidBody,
    Settings,
    Spring,
    Start,
    linearize,
    read_model,
    simulate,
    write_model,
)

MASS, G, QUADRATIC = 2.0, 9.81, 0.3
TERMINAL = np.sqrt(MASS * G / QUADRATIC)


def falling(step, start=(0.0, 0.0, 0.0), **settings):
    body = RigidBody(MASS, [0.1, 0.1, 0.1], start=Start(start, velocity=[0.0, 0.0, 0.0]))
    return Model(
        {"stone": body},
        loads=[Drag("stone", quadratic=QUADRATIC)],
        gravity=[0, 0, -G],
        settings=Settings(t_end=2.0, step=step, **settings),
    )


@pytest.mark.parametrize("start", [(0.0, 0.0, 0.0), (1000.0, -500.0, 300.0)])
def test_a_stone_falls_to_its_terminal_velocity(start):
    """v = v_t tanh(g t / v_t), of second order."""
    errors = []
    for step in (2e-2, 1e-2):
        run = simulate(falling(step, start))
        expected = -TERMINAL * np.tanh(G * run.time / TERMINAL)
        errors.append(np.abs(run.body("stone").v[:, 2] - expected).max())
    assert errors[1] < 2e-4 * TERMINAL
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


def test_newtons_method_knows_how_drag_depends_on_velocity():
    """Drag that takes a third of the speed in a step, in four corrections and not a dozen."""
    body = RigidBody(MASS, [0.1, 0.1, 0.1], start=Start(velocity=[30.0, 10.0, 0.0]))
    settings = Settings(t_end=0.5, step=1e-3, max_iterations=4)
    run = simulate(Model({"b": body}, loads=[Drag("b", quadratic=20.0)], settings=settings))
    speed = np.linalg.norm(run.body("b").v[:, :3], axis=1)
    # m v' = -c v^2: 1 / v grows by c t / m
    assert 1.0 / speed[-1] - 1.0 / speed[0] == pytest.approx(20.0 * 0.5 / MASS, rel=2e-3)


def test_drag_takes_energy():
    """Kinetic and potential energy fall by its work."""
    run = simulate(falling(1e-3))
    kinetic = 0.5 * MASS * np.sum(run.body("stone").v[-1, :3] ** 2)
    fallen = -MASS * G * run.body("stone").x[-1, 2]
    assert run.energy.work[-1] == pytest.approx(kinetic - fallen, rel=1e-4)


def test_linear_drag_damps_linear_modes():
    """zeta = c / (2 sqrt(k m))."""
    stiffness, c = 800.0, 3.0
    model = Model(
        {"m": RigidBody(MASS, [0.1, 0.1, 0.1])},
        springs=[Spring("k", "bushing", ("ground", "m"), stiffness=[stiffness] * 3 + [10.0] * 3)],
        loads=[Drag("m", linear=c), Force("m", [1.0, 0.0, 0.0], Constant(1.0))],
        settings=Settings(t_end=1.0, step=1e-3),
    )
    modes = linearize(model).modes()
    ratio = c / (2.0 * np.sqrt(stiffness * MASS))
    assert sorted(modes.ratios)[-1] == pytest.approx(ratio, rel=1e-6)


def test_drag_is_a_table_of_a_model_file(tmp_path):
    path = tmp_path / "model.toml"
    write_model(path, falling(1e-2))
    assert 'type = "drag"' in path.read_text()
    (load,) = read_model(path).loads
    assert (load.quadratic, load.linear, load.on) == (QUADRATIC, 0.0, "stone")


def test_drag_of_nothing_is_refused():
    with pytest.raises(ModelError, match=r"load \(drag\) on 'stone': expected quadratic or linear"):
        Drag("stone")
