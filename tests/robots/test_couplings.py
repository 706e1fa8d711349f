"""Servos, stops, damping, friction and mimics of imported robots beside closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import SmoothStep, simulate

from .references import BASE, joint, link, model_of, urdf_of

J = 0.1
WHEEL = BASE + link("wheel", 1.0, (J, J, J))


def wheel(folder, inner="", kind="continuous", **options):
    """A wheel about a vertical axis, with what its joint has."""
    path = urdf_of(folder, WHEEL + joint("axle", "base", "wheel", inner, kind))
    return model_of(path, folder, **options)


def set_in_motion(model, **start):
    (axle,) = model.joints
    return replace(model, joints=(replace(axle, start=start),))


def test_damping_slows_a_wheel_exponentially(tmp_path):
    """J w' = -d w, from rest at an angle by a push of its servo's spring."""
    model = set_in_motion(wheel(tmp_path, '<dynamics damping="0.5"/>', t_end=0.4), angle_rate=2.0)
    results = simulate(model)
    rate = results.joint("axle").angle_rate
    # Friction acts from the first step on: that step is late by half of itself.
    np.testing.assert_allclose(rate, 2.0 * np.exp(-0.5 / J * results.time), rtol=2e-3)


def test_coulomb_friction_slows_a_wheel_evenly_until_it_rests(tmp_path):
    model = set_in_motion(wheel(tmp_path, '<dynamics friction="0.2"/>', t_end=1.5), angle_rate=2.0)
    results = simulate(model)
    rate, t = results.joint("axle").angle_rate, results.time
    np.testing.assert_allclose(rate, np.maximum(2.0 - 0.2 / J * t, 0.0), atol=4e-3)
    assert abs(rate[-1]) < 1e-9


def test_coulomb_friction_is_that_of_mujoco(tmp_path):
    """A pendulum with friction: MuJoCo's constraint is soft, so both agree to a thousandth."""
    mujoco = pytest.importorskip("mujoco")
    text = BASE + link("bob", 2.0, (0.01, 0.01, 0.01), '<origin xyz="0.5 0 0"/>')
    path = urdf_of(
        tmp_path, text + joint("pin", "base", "bob", '<dynamics friction="1.5"/>', axis="0 1 0")
    )
    results = simulate(model_of(path, tmp_path, t_end=0.6))
    compiled = mujoco.MjModel.from_xml_path(str(path))
    compiled.opt.timestep = 1e-4
    compiled.dof_solref[:] = [2e-4, 1.0]
    compiled.dof_solimp[:] = [0.9999, 0.9999, 0.001, 0.5, 2.0]
    data = mujoco.MjData(compiled)
    for _ in range(6000):
        mujoco.mj_step(compiled, data)
    assert results.joint("pin").angle[-1] == pytest.approx(float(data.qpos[0]), rel=2e-3)
    assert abs(data.qpos[0]) > 1.0


def test_a_servo_is_an_oscillator_about_its_reference(tmp_path):
    """J q'' = -kp q - kd q', from 0.5 rad."""
    kp, kd, q0 = 40.0, 1.2, 0.5
    model = wheel(tmp_path, servo=(kp, kd), t_end=0.5)
    (motor,) = model.motors
    assert motor.reference.name == "axle"
    results = simulate(set_in_motion(model, angle=q0))
    w, d = np.sqrt(kp / J), kd / (2.0 * J)
    wd, t = np.sqrt(w**2 - d**2), results.time
    exact = q0 * np.exp(-d * t) * (np.cos(wd * t) + d / wd * np.sin(wd * t))
    np.testing.assert_allclose(results.joint("axle").angle, exact, atol=1e-4)


def test_a_servo_holds_the_start(tmp_path):
    model = model_of(
        "six_axes.urdf", tmp_path, servo=(5e3, 100.0), state={"a2": 0.4, "a3": -0.3}, t_end=0.5
    )
    model = replace(model, gravity=[0.0, 0.0, 0.0])
    results = simulate(model)
    for name, start in (("a2", 0.4), ("a3", -0.3), ("a5", 0.0)):
        np.testing.assert_allclose(results.joint(name).angle, start, atol=1e-9)


def test_effort_and_velocity_bound_a_servo(tmp_path):
    """The driving torque falls from the effort at rest to zero at the velocity."""
    limit = '<limit lower="-50" upper="50" effort="3" velocity="10"/>'
    model = wheel(tmp_path, limit, "revolute", servo=(1e4, 10.0), t_end=0.3)
    (motor,) = model.motors
    assert (motor.limit, motor.speed) == ((-3.0, 3.0), 10.0)
    turn = replace(motor, reference=SmoothStep((0.0, 40.0), over=(0.0, 1e-3)))
    results = simulate(replace(model, motors=(turn,)))
    # J w' = T (1 - w / w_0)
    exact = 10.0 * (1.0 - np.exp(-3.0 / (J * 10.0) * results.time))
    np.testing.assert_allclose(results.joint("axle").angle_rate, exact, atol=0.02)


def test_a_limit_stops_a_wheel_within_a_quarter_period_of_its_stop(tmp_path):
    """x = v / omega sin(omega t) of an undamped stop of the default frequency or less."""
    limit = '<limit lower="-1" upper="0.5" effort="0" velocity="0"/>'
    model = wheel(tmp_path, limit, "revolute", t_end=0.6, step=2e-4)
    (stop,) = model.stops
    assert stop.range == (-1.0, 0.5)
    assert stop.impact.stiffness == pytest.approx(100.0**2 * J, rel=1e-2)
    elastic = replace(stop, impact=replace(stop.impact, restitution=1.0))
    results = simulate(set_in_motion(replace(model, stops=(elastic,)), angle_rate=1.0))
    angle, rate = results.joint("axle").angle, results.joint("axle").angle_rate
    omega = np.sqrt(stop.impact.stiffness / J)
    assert angle.max() == pytest.approx(0.5 + 1.0 / omega, rel=1e-4)
    assert rate[-1] == pytest.approx(-1.0, rel=1e-3)


def test_the_stiffness_of_stops_is_that_of_the_user(tmp_path):
    model = model_of("scara.urdf", tmp_path, stop_stiffness=1234.5)
    assert {stop.impact.stiffness for stop in model.stops} == {1234.5}


def test_fingers_that_mimic_each_other_are_one_mass(tmp_path):
    """q_r = 2 q_l + 0.01, q_t = -3 q_r + 0.2: the equation of motion of q_l alone.

    (m_l + 4 m_r + 36 J_t) q'' = -g (m_l - 2 m_r) + 6 m_t g x(q), with x the lever of the thumb.
    """
    model = replace(model_of("gripper.urdf", tmp_path, t_end=0.2, step=1e-4), stops=())
    results = simulate(model)
    left, right = results.joint("left_slide").distance, results.joint("right_slide").distance
    thumb = results.joint("thumb_turn").angle
    np.testing.assert_allclose(right, 2.0 * left + 0.01, atol=1e-12)
    np.testing.assert_allclose(thumb, -3.0 * right + 0.2, atol=1e-12)
    assert left[0] == pytest.approx(0.0, abs=1e-14)

    from scipy.integrate import solve_ivp

    g, lever, m_t = 9.81, 0.05, 0.4
    mass = 0.2 + 4.0 * 0.3 + 36.0 * (0.0004 + m_t * lever**2)

    def motion(t, y):
        q_t = -6.0 * y[0] - 0.03 + 0.2
        # About +y the thumb along x goes down: its height is -lever sin(q_t).
        by_thumb = m_t * g * lever * np.cos(q_t) * -6.0
        return [y[1], (-0.2 * g + 2.0 * 0.3 * g + by_thumb) / mass]

    exact = solve_ivp(motion, (0.0, 0.2), [0.0, 0.0], rtol=1e-10, atol=1e-12)
    assert left[-1] == pytest.approx(exact.y[0, -1], rel=1e-5)
    assert abs(exact.y[0, -1]) > 1e-2


def test_a_joint_may_have_gains_of_its_own(tmp_path):
    gains = {"servo": (500.0, 20.0), "servos": {"lift": (2e4, 300.0)}}
    model = model_of("scara.urdf", tmp_path, **gains)
    found = {motor.joint: (motor.stiffness, motor.damping) for motor in model.motors}
    same = (500.0, 20.0)
    assert found == {"shoulder": same, "elbow": same, "lift": (2e4, 300.0)}


def test_servos_move_leaders_alone(tmp_path):
    model = model_of("gripper.urdf", tmp_path, servo=(500.0, 20.0))
    assert [motor.joint for motor in model.motors] == ["left_slide"]


def test_a_joint_starts_in_the_middle_of_limits_that_leave_out_zero(tmp_path):
    limit = '<limit lower="0.5" upper="1.5" effort="0" velocity="0"/>'
    model = wheel(tmp_path, limit, "revolute", t_end=0.01)
    assert simulate(model).joint("axle").angle[0] == pytest.approx(1.0, abs=1e-14)
