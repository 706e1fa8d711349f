"""The size of a model: positive for bodies at the origin, the same wherever the origin is."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    JOINTS,
    Constant,
    Frame,
    Model,
    RigidBody,
    Settings,
    Spherical,
    Start,
    Torque,
    simulate,
)
from duhamel.solver.lower.lower import lower
from duhamel.solver.start import matrices
from duhamel.solver.start.initial import initialize
from duhamel.solver.step.measure import relative
from scipy.spatial.transform import Rotation

from .linkages import four_bar

FAR = np.array([1000.0, -500.0, 300.0])


def test_a_body_at_the_origin_has_the_size_of_its_radius_of_gyration():
    body = RigidBody(2.0, [1.0, 2.0, 2.5])
    assert lower(
        Model({"a": body}, settings=Settings(t_end=1.0, step=1e-3))
    ).system.bodies.size == (pytest.approx(np.sqrt(2.5 / 2.0)))


@pytest.mark.parametrize("shift", [np.zeros(3), FAR], ids=["origin", "far"])
@pytest.mark.parametrize("turn", [[0.0, 0.0, 0.0], [0.3, -1.0, 2.0]], ids=["along", "askew"])
def test_the_size_is_the_extent_wherever_the_origin_is_and_however_axes_are(shift, turn):
    Q = Rotation.from_rotvec(turn)
    bodies = {
        f"b{i}": RigidBody(
            1.0,
            [1e-4, 1e-4, 1e-4],
            {"end": Frame([0.15, 0, 0])},
            Start(shift + Q.apply([0.3 * i, 0, 0]), turn),
        )
        for i in range(3)
    }
    joints = [Spherical(f"b{i}.end", f"b{i + 1}.end", name=f"j{i}") for i in range(2)]
    settings = Settings(t_end=1.0, step=1e-3, assemble=True)
    size = lower(Model(bodies, joints, settings=settings)).system.bodies.size
    assert size == pytest.approx(0.75, rel=1e-12)  # 0.15 .. 0.75: three centers, two ends


def test_an_open_joint_is_refused_wherever_the_origin_is():
    """Of 1 mm in a model of 0.3 m, at the origin and a kilometer away."""
    for shift in (np.zeros(3), FAR):
        bodies = {
            "a": RigidBody(1.0, [1e-3] * 3, {"end": Frame([0.15, 0, 0])}, Start(shift)),
            "b": RigidBody(
                1.0,
                [1e-3] * 3,
                {"end": Frame([-0.15, 0, 0])},
                Start(shift + np.array([0.301, 0, 0])),
            ),
        }
        model = Model(
            bodies,
            [Spherical("a.end", "b.end", name="hinge")],
            settings=Settings(t_end=1.0, step=1e-3),
        )
        with pytest.raises(ValueError, match=r"joint 'hinge': open by 0\.001 m at the start"):
            simulate(model)


def errors_of_a_tumbling_body(position):
    """The largest error of the angular velocity over the exact one, for two steps.

    A body that spins about its intermediate axis turns over, again and again.
    """
    errors = []
    reference = None
    for h in (2.5e-4, 1e-3, 2e-3):
        body = RigidBody(
            1.0, [1.0, 2.0, 2.5], start=Start(position, angular_velocity=[1e-3, 5.0, 0.0])
        )
        settings = Settings(t_end=8.0, step=h, rho_inf=0.9)
        results = simulate(Model({"a": body}, settings=settings))
        every = round(2e-3 / h)
        omega = results.body("a").v[::every, 3:]
        if reference is None:
            reference = omega
        else:
            errors.append(np.abs(omega - reference).max())
    return errors


@pytest.mark.parametrize("position", [np.zeros(3), FAR], ids=["origin", "far"])
def test_a_body_tumbles_with_order_two_at_the_origin_too(position):
    fine, coarse = errors_of_a_tumbling_body(position)
    assert coarse < 0.05
    assert 3.3 < coarse / fine < 5.5  # 4.2 for a reference of a quarter of the finer step


@pytest.mark.parametrize("joint", ["revolute", "spherical", "universal"])
def test_a_wheel_whose_frames_are_all_at_the_origin_turns_under_a_torque(joint):
    axes = {"revolute": ([0, 0, 1],), "spherical": (), "universal": ([0, 0, 1], [1, 0, 0])}[joint]
    model = Model(
        {"wheel": RigidBody(3.0, [0.1, 0.1, 0.2])},
        [JOINTS[joint]("ground", "wheel", *axes, name="hub")],
        [Torque("wheel", [0, 0, 1], Constant(0.4))],
        gravity=[0, 0, -9.81],
        settings=Settings(t_end=1.0, step=1e-3),
    )
    results = simulate(model)
    np.testing.assert_allclose(results.body("wheel").v[-1, 5], 2.0, rtol=1e-6)
    np.testing.assert_allclose(results.joint("hub").force[-1], [0, 0, 3.0 * 9.81], atol=1e-6)


@pytest.mark.parametrize("unit", [1e-12, 1e-6, 1e3, 1e6])
def test_a_gyroscope_of_any_size_precesses_alike(unit):
    """A model in other units of length, at the origin, off it and on a spherical joint."""

    def motion(unit):
        tilt = np.array([0.0, 0.5, 0.0])
        frames = {"tip": Frame([0, 0, -0.1 * unit])}
        center = 0.1 * unit * np.array([np.sin(0.5), 0, np.cos(0.5)])
        start = Start(center, tilt, angular_velocity=[0, 0, 150.0])
        inertia = np.array([0.01, 0.01, 0.02]) * unit**2
        top = RigidBody(1.0, inertia, frames, start)
        joint = Spherical("ground", "top.tip", name="tip")
        settings = Settings(t_end=0.5, step=5e-4)
        model = Model({"top": top}, [joint], gravity=[0, 0, -9.81 * unit], settings=settings)
        return simulate(model).body("top").x / unit

    expected = motion(1.0)
    assert np.ptp(expected[:, 1]) > 1e-3
    np.testing.assert_allclose(motion(unit), expected, rtol=0, atol=1e-9)


def test_small_and_large_models_start_alike(monkeypatch, tmp_path):
    """By numpy's dense matrices and by scipy's sparse ones."""
    model = replace(four_bar(tmp_path), gravity=[0, -9.81, 0])
    dense = initialize(model)
    monkeypatch.setattr(matrices, "MAX_DENSE_UNKNOWNS", 0)
    sparse = initialize(model)
    assert dense.degrees_of_freedom == sparse.degrees_of_freedom
    for a, b in zip(dense.state.arrays(), sparse.state.arrays(), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("force", [0.0, 5e-319, 1e-305])
def test_a_residual_of_numbers_without_digits_is_none(force):
    """Forces that have died away leave such numbers."""
    assert relative(force, force, 0.0, 1e-10) <= 1e-10


def test_a_residual_that_is_no_number_is_infinite():
    assert relative(np.nan, 1.0, 0.0, 1e-10) == np.inf
    assert relative(1e-3, 1.0, 0.0, 1e-10) == pytest.approx(1e-3)
