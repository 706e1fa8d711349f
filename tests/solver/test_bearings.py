"""Bearings of shafts: forces in axes of the support, by coefficients over the spin."""

import numpy as np
import pytest
from duhamel.solver import (
    Bearing,
    Constant,
    ConvergenceError,
    Force,
    HalfSine,
    Model,
    ModelError,
    RigidBody,
    Settings,
    Start,
    SteadyRotation,
    Torque,
    linearize,
    read_model,
    simulate,
    write_model,
)

MASS = 10.0
K = [[1e5, 4e4], [-4e4, 2e5]]
C = [[60.0, 5.0], [-3.0, 90.0]]


def spinning(bearing, spin=50.0, loads=(), **settings):
    disk = RigidBody(MASS, [0.1, 0.1, 0.2], start=Start(angular_velocity=[0.0, 0.0, spin]))
    settings = {"t_end": 0.1, "step": 1e-4} | settings
    return Model({"disk": disk}, loads=loads, bearings=[bearing], settings=Settings(**settings))


def plane(stiffness=K, damping=C, **more):
    return Bearing("film", ["ground", "disk"], [0.0, 0.0, 1.0], stiffness, damping, **more)


def test_the_force_has_the_axes_of_the_support_whatever_the_angle_is():
    """m c'' + C c' + K c = 0 from a push, though the disk has turned on by many angles."""
    push = Force("disk", [1.0, 0.0, 0.0], HalfSine(500.0, 2e-3))
    run = simulate(spinning(plane(), loads=[push], step=2.5e-5))
    a = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.array(K) / MASS, -np.array(C) / MASS]])
    h = run.time[1] - run.time[0]
    moved, speed = run.body("disk").x[:, :2], run.body("disk").v[:, :2]
    free = np.flatnonzero(run.time > 2.5e-3)
    values, vectors = np.linalg.eig(a)
    start = np.linalg.solve(vectors, np.concatenate([moved[free[0]], speed[free[0]]]))
    expected = vectors @ (start[:, None] * np.exp(values[:, None] * h * np.arange(len(free))))
    np.testing.assert_allclose(moved[free], expected[:2].real.T, atol=1e-4 * np.abs(moved).max())
    # A quarter of a force along x goes along y, which symmetric stiffness could not.
    assert np.abs(moved[:, 1]).max() > 0.1 * np.abs(moved).max()


def test_a_table_acts_with_the_coefficients_of_the_present_spin():
    """Between two speeds as the mean of both, and as constant ones where both are the same."""
    push = [Force("disk", [1.0, 0.0, 0.0], HalfSine(500.0, 2e-3))]
    flat = np.reshape(K, 4)
    mean = simulate(spinning(plane(), loads=push)).body("disk").x
    table = plane([1.5 * flat, 0.5 * flat], [0.5 * np.reshape(C, 4), 1.5 * np.reshape(C, 4)],
                  speeds=[20.0, 80.0])  # fmt: skip
    run = simulate(spinning(table, loads=push))
    np.testing.assert_allclose(run.body("disk").x, mean, atol=1e-9 * np.abs(mean).max())


def test_cross_coupling_feeds_energy_which_the_balance_counts():
    """A disk that whirls under K_12 = -K_21 gains what the bearing is said to have fed."""
    push = Force("disk", [1.0, 0.0, 0.0], HalfSine(500.0, 2e-3))
    cross = [[1e5, 2e4], [-2e4, 1e5]]
    run = simulate(spinning(plane(cross, 0.0), loads=[push], t_end=0.2))
    energy, late = run.energy, run.time > 3e-3
    whirl = energy.kinetic + energy.springs - 0.5 * 0.2 * 50.0**2
    assert whirl[-1] > 3.0 * whirl[late][0]
    gain = -(energy.dissipated[-1] - energy.dissipated[late][0])
    assert gain == pytest.approx(whirl[-1] - whirl[late][0], rel=1e-3)
    assert not run.validity.warnings


def test_a_run_stops_where_the_spin_leaves_the_table():
    table = plane([[1e5, 0.0, 0.0, 1e5]] * 2, 0.0, speeds=[0.0, 60.0])
    turning = Torque("disk", [0.0, 0.0, 1.0], Constant(100.0))
    with pytest.raises(ConvergenceError, match=r"bearing 'film': its spin of 60.* from 0 to 60"):
        simulate(spinning(table, loads=[turning]))


@pytest.mark.parametrize("spin", [0.0, 950.0])
def test_a_spin_at_the_start_that_the_table_does_not_have_is_refused(spin):
    table = plane([[1e5, 0.0, 0.0, 1e5]] * 2, 0.0, speeds=[100.0, 900.0])
    message = f"bearing 'film': speeds: {spin:g} rad/s is beyond its table, from 100 to 900"
    with pytest.raises(ModelError, match=message):
        simulate(spinning(table, spin))
    rotation = SteadyRotation([0.0, 0.0, spin]) if spin else None
    with pytest.raises(ModelError, match=message):
        linearize(spinning(table), rotation)


def test_bearings_read_back_as_they_were_written(tmp_path):
    table = plane(
        [[1e5, 1.0, 2.0, 2e5], [1e5, 3.0, 4.0, 2e5]],
        [[1.0, 0.0, 0.0, 2.0]] * 2,
        speeds=[0, 9],
        second_axis=[0.0, 1.0, 0.0],
    )
    for bearing in (plane(), plane(1e5, 0.0), table):
        model = spinning(bearing)
        write_model(model, tmp_path / "model.toml")
        again = read_model(tmp_path / "model.toml").bearings
        assert repr(again) == repr(model.bearings)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"stiffness": [1.0, 2.0, 3.0]}, "stiffness: expected a number, 2 numbers or a 2x2 matrix"),
        ({"speeds": [0.0, 1.0]}, "stiffness: expected for each of 2 speeds a row of 4 numbers"),
        ({"speeds": [1.0, 1.0]}, "speeds: expected two or more increasing speeds"),
        ({"second_axis": [0.0, 0.0, 1.0]}, "second_axis: expected an axis perpendicular"),
        ({"between": ["disk", "ground"]}, "between: expected the support and then the shaft"),
    ],
)
def test_what_a_bearing_refuses(given, message):
    keys = {"between": ["ground", "disk"], "axis": [0, 0, 1], "stiffness": K} | given
    with pytest.raises(ModelError, match=message):
        Bearing("film", **keys)
