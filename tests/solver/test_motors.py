"""Motors on joint coordinates against closed forms and an integrator of their equations."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from duhamel.results import Results
from duhamel.solver import (
    JOINTS,
    Constant,
    ConvergenceError,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Function,
    Harmonic,
    Impact,
    Input,
    Model,
    ModelError,
    Motor,
    Place,
    Polynomial,
    Prismatic,
    Revolute,
    RigidBody,
    Settings,
    Simulator,
    SmoothFunction,
    Spline,
    Spring,
    Start,
    StateError,
    SteadyRotation,
    Steps,
    Stop,
    Table,
    ValidityWarning,
    check,
    read_model,
    simulate,
    start,
    write_model,
)
from duhamel.solver.linear.linearize import linearize
from scipy.integrate import solve_ivp

from .test_restart import assert_same
from .test_tangents import AXIS, SECOND, Point, assert_newton_matrix, make_body, make_pair  # noqa: F401

J = 0.5
TURN = np.array([2.0, 1.0, -2.0]) / 3.0


def wheel(motor, h=1e-2, t_end=2.0, at=(0.0, 0.0, 0.0), start=(), **settings):
    """A wheel on an axle, which a motor turns."""
    body = RigidBody(1.0, [J, J, J], start=Start(position=at))
    return Model(
        {"wheel": body},
        joints=[Revolute("ground", "wheel", TURN, name="axle", start=dict(start))],
        motors=[motor],
        settings=Settings(t_end=t_end, step=h, **settings),
    )


def servo(**keys):
    return Motor("servo", "axle", "angle", **keys)


def integrated(motor, t, torque=lambda t: 0.0, r=lambda t: (1.0, 0.0), y_0=(0.0, 0.0, 0.0)):
    """Angle, rate and integral by an integrator with a tolerance of 1e-11.

    The kinks at limits are met by short steps.
    """
    k, d, k_i, T = motor.stiffness, motor.damping, motor.integral, motor.tracking
    lower, upper = motor.limit or (-np.inf, np.inf)

    def slope(t, y):
        reference, rate = r(t)
        error = reference - y[0]
        v = torque(t) + k * error + d * (rate - y[1]) + y[2]
        lo, up = lower, upper
        if motor.speed:
            lo *= np.clip(1.0 + y[1] / motor.speed, 0.0, 1.0)
            up *= np.clip(1.0 - y[1] / motor.speed, 0.0, 1.0)
        tau = np.clip(v, lo, up)
        return [y[1], tau / J, k_i * error + (tau - v) * T]

    options = {"rtol": 1e-11, "atol": 1e-12, "max_step": 2e-3}
    return solve_ivp(slope, (0.0, t[-1]), y_0, t_eval=t, **options).y


def angle_errors(motor, steps, **reference):
    """The largest errors of the angle with each of the steps."""
    errors = []
    for h in steps:
        run = simulate(wheel(motor, h))
        exact = integrated(motor, run.time, **reference)
        errors.append(np.abs(run.joint("axle").angle - exact[0]).max())
    return np.array(errors)


def orders(errors):
    return np.log2(errors[:-1] / errors[1:])


# Closed forms


@pytest.mark.parametrize("zeta", [0.1, 0.7])
def test_a_servo_on_an_inertia_is_a_damped_oscillator(zeta):
    omega = 6.0
    motor = servo(stiffness=J * omega**2, damping=2 * J * zeta * omega, reference=Constant(1.0))
    errors = []
    for h in (2e-2, 1e-2, 5e-3):
        run = simulate(wheel(motor, h))
        damped, t = omega * np.sqrt(1.0 - zeta**2), run.time
        decay = np.exp(-zeta * omega * t)
        ringing = np.cos(damped * t) + zeta * omega / damped * np.sin(damped * t)
        errors.append(np.abs(run.joint("axle").angle - (1.0 - decay * ringing)).max())
    assert (np.abs(orders(np.array(errors)) - 2.0) < 0.05).all(), errors
    assert errors[-1] < 7e-4


def test_a_torque_turns_a_wheel_as_a_load_does():
    """And both bodies of the joint feel it: nothing turns as a whole."""
    bodies = {"one": RigidBody(1.0, [J, J, J]), "two": RigidBody(2.0, [2 * J, 2 * J, 2 * J])}
    model = Model(
        bodies,
        joints=[Revolute("one", "two", TURN, name="axle")],
        motors=[servo(torque=Harmonic(3.0, 0.5))],
        settings=Settings(t_end=2.0, step=1e-2),
    )
    run = simulate(model)
    w = 3.0 / np.pi * (1.0 - np.cos(np.pi * run.time))
    np.testing.assert_allclose(run.body("one").v[:, 3:], np.outer(-w / J, TURN), atol=2e-3)
    np.testing.assert_allclose(run.body("two").v[:, 3:], np.outer(w / (2 * J), TURN), atol=2e-3)
    np.testing.assert_allclose(run.momentum.angular, 0.0, atol=1e-12)
    np.testing.assert_allclose(run.motor("servo").torque, 3.0 * np.sin(np.pi * run.time))
    assert not run.motor("servo").error.any()


def test_a_force_drives_a_slide():
    model = Model(
        {"slide": RigidBody(2.0, [J, J, J])},
        joints=[Prismatic("ground", "slide", TURN, name="rail")],
        motors=[Motor("push", "rail", "distance", force=Constant(3.0))],
        settings=Settings(t_end=0.1, step=1e-3),
    )
    run = simulate(model)
    t = run.time
    np.testing.assert_allclose(run.joint("rail").distance, 0.75 * t**2, atol=1e-14)
    np.testing.assert_allclose(run.motor("push").power, 4.5 * t, atol=1e-12)
    np.testing.assert_allclose(run.motor("push").work, 2.25 * t**2, atol=1e-14)
    assert run.unit("motors", "push", "torque") == "N"
    assert run.unit("motors", "push", "error") == "m"


def test_a_smooth_reference_is_followed_with_its_rate():
    """With the torque that its acceleration takes, without an error but that of the step."""
    path = Spline((0.0, 0.5, 1.0, 1.5, 2.0), (0.0, 0.1, 0.6, 0.9, 1.0))

    def torque(t):
        return J * path.derivatives(t)[1]

    start = {"angle_rate": path.derivatives(0.0)[0]}.items()
    gains = {"stiffness": 50.0, "damping": 2.0, "reference": path}
    errors = []
    for h in (1e-2, 5e-3):
        run = simulate(wheel(servo(torque=Function(torque), **gains), h, start=start))
        errors.append(np.abs(run.motor("servo").error).max())
    assert errors[0] < 2e-4
    assert orders(np.array(errors)) > 1.9


@pytest.mark.parametrize("reference", [Table((0.0, 2.0), (0.0, 2.0)), Polynomial((0.0, 1.0))])
def test_the_rate_of_a_reference_is_its_derivative_where_it_is_smooth_or_what_is_given(reference):
    """Otherwise the damping holds the wheel back by damping rate / stiffness."""
    gains = {"stiffness": 40.0, "damping": 6.0, "reference": reference}
    behind = simulate(wheel(servo(**gains), t_end=8.0)).motor("servo").error[-1]
    expected = 0.0 if isinstance(reference, Polynomial) else 6.0 / 40.0
    if isinstance(reference, Table):
        reference = Table((0.0, 9.0), (0.0, 9.0))
        gains["reference"] = reference
        behind = simulate(wheel(servo(**gains), t_end=8.0)).motor("servo").error[-1]
        given = servo(**gains, reference_rate=Constant(1.0))
        assert abs(simulate(wheel(given, t_end=8.0)).motor("servo").error[-1]) < 1e-9
    assert behind == pytest.approx(expected, abs=1e-9)


def test_a_servo_of_the_rate_alone_runs_up():
    """w = 5 (1 - exp(-damping t / J))"""
    run = simulate(wheel(servo(damping=1.0, reference_rate=Constant(5.0)), 5e-3))
    exact = 5.0 * (1.0 - np.exp(-1.0 * run.time / J))
    np.testing.assert_allclose(run.joint("axle").angle_rate, exact, atol=1e-4)
    assert not run.motor("servo").error.any()


# An integrator as the reference


def test_a_servo_with_an_integral_is_of_second_order():
    motor = servo(stiffness=20.0, damping=4.0, integral=30.0, reference=Constant(1.0))
    errors = angle_errors(motor, (2e-2, 1e-2, 5e-3))
    assert (np.abs(orders(errors) - 2.0) < 0.05).all(), errors
    assert errors[-1] < 1e-4


LIMITS = {
    "both": {"limit": 3.0},
    "sides": {"limit": (-1.0, 4.0)},
    "one side": {"limit": (-np.inf, 3.0)},
    "time": {"limit": 3.0, "tracking_time": 0.02},
    "speed": {"limit": 6.0, "speed": 2.0},
}


@pytest.mark.parametrize("limit", LIMITS)
def test_a_servo_at_its_limits_does_not_wind_up(limit):
    gains = {"stiffness": 40.0, "damping": 4.0, "integral": 60.0, "reference": Constant(1.0)}
    motor = servo(**gains, **LIMITS[limit])
    errors = angle_errors(motor, (2e-2, 1e-2, 5e-3))
    assert (orders(errors) > 1.5).all(), errors
    assert errors[-1] < 5e-4
    run = simulate(wheel(motor))
    lower, upper = motor.limit
    assert set(run.motor("servo").state) >= {0, 1}
    assert lower - 1e-12 <= run.motor("servo").torque.min()
    assert run.motor("servo").torque.max() <= upper + 1e-12
    wound = replace(motor, tracking_time=1e9)
    if limit == "both":
        overshoot = [simulate(wheel(m)).joint("axle").angle.max() for m in (motor, wound)]
        assert overshoot[0] < overshoot[1] - 0.1


def test_a_motor_brakes_with_its_whole_limit_at_any_speed():
    """A wheel that turns at 10 rad/s, twice the speed without load, is stopped by the limit."""
    motor = servo(damping=1e4, limit=2.0, speed=5.0)
    run = simulate(wheel(motor, t_end=2.0, start={"angle_rate": 10.0}.items()))
    np.testing.assert_allclose(run.joint("axle").angle_rate, 10.0 - 4.0 * run.time, atol=1e-9)


def test_a_servo_asks_for_its_reference_many_steps_at_once():
    """1000 steps in a few calls, with the motion, to the bit, that steps one by one have."""
    asked = []

    def path(t):
        asked.append(t)
        return np.sin(t) ** 2

    functions = path, lambda t: np.sin(2 * t), lambda t: 2 * np.cos(2 * t)
    runs = []
    for vectorized in (True, False):
        reference = SmoothFunction(*functions, vectorized=vectorized)
        motor = servo(stiffness=40.0, damping=4.0, integral=60.0, reference=reference)
        runs.append(simulate(wheel(motor, h=1e-3, t_end=1.0)).joint("axle").angle)
    calls = [np.size(t) for t in asked]
    assert calls.count(1) >= 1000  # one by one
    assert len([n for n in calls if n > 1]) <= 20
    np.testing.assert_array_equal(*runs)


# Implicit


@pytest.mark.parametrize("limit", [None, 3.0])
@pytest.mark.parametrize("factor", [1e3, 1e6])
def test_gains_that_no_explicit_servo_bears(factor, limit):
    """They are 1e3 and 1e6 times those at which an explicit servo grows without bound."""
    h = 1e-2
    k = factor * 4.0 * J / h**2
    path = SmoothFunction(
        lambda t: np.sin(t) ** 2, lambda t: np.sin(2 * t), lambda t: 2 * np.cos(2 * t)
    )
    motor = servo(stiffness=k, damping=np.sqrt(k * J), integral=10 * k, reference=path, limit=limit)
    with pytest.warns(ValidityWarning, match=r"motor 'servo': time steps per period"):
        run = simulate(wheel(motor, h))
    error = np.abs(run.motor("servo").error).max()
    assert error < 10.0 / factor
    assert run.iterations.max() <= 4


@pytest.mark.parametrize("factor", [1e3, 1e9])
def test_a_stiff_servo_between_two_limits_finds_its_side(factor):
    """A step of the reference: full torque one way, then the other, as by the shortest time."""
    h = 1e-3
    k = factor * 4.0 * J / h**2
    motor = servo(stiffness=k, damping=0.2 * k, reference=Steps((0.5,), (1.0,)), limit=3.0)
    with pytest.warns(ValidityWarning, match="motor 'servo'"):
        run = simulate(wheel(motor, h, t_end=3.0))
    assert abs(run.motor("servo").error[-1]) < 1e-3
    assert run.iterations.max() <= 6
    assert set(run.motor("servo").state) == {-1, 0, 1}


@pytest.mark.parametrize("coordinate", ["angle", "second_angle", "distance"])
@pytest.mark.parametrize("limit", [None, 0.5], ids=["free", "limited"])
def test_the_newton_matrix_of_a_motor(make_pair, coordinate, limit):  # noqa: F811
    """Entry by entry, at a limit that falls with the speed too."""
    kinds = {
        "angle": ("cylindrical", AXIS),
        "distance": ("cylindrical", AXIS),
        "second_angle": ("universal", AXIS, SECOND),
    }
    kind, *axes = kinds[coordinate]
    key = "force" if coordinate == "distance" else "torque"
    motor = Motor(
        "motor",
        "joint",
        coordinate,
        **{key: Constant(0.4)},
        stiffness=3.0,
        damping=0.7,
        integral=20.0,
        reference=Harmonic(0.5, 1.0),
        limit=limit,
        speed=None if limit is None else 20.0,
    )
    joint = JOINTS[kind]("a.i0", "b.i0", *axes, name="joint")
    point = Point.of(make_pair(("rigid", "flexible"), (joint,), motors=(motor,)), seed=5)
    rng = np.random.default_rng(2)
    point.work.couplings.elapsed[0] = point.system.scheme.h
    point.work.motors.value[:] = rng.uniform(-1.0, 1.0, 3)
    point.state.motors.integral[:], point.state.motors.slope[:] = 0.3, -2.0
    if limit is not None:
        row = point.system.couplings.laws.motors.row[0]
        rate = point.work.couplings.rate[row]
        point.state.couplings.lam[row] = 2.0 * limit * np.sign(rate)
    point.work.interfaces.u_predicted[:] = point.state.interfaces.u
    point.evaluated()
    assert abs(point.work.motors.status[0]) == (limit is not None)
    assert_newton_matrix(point)


# Energy


def test_the_work_of_motors_is_in_the_balance():
    """Of a wheel that a servo with limits and an integral turns to and fro: of second order."""
    motor = servo(
        stiffness=40.0, damping=3.0, integral=30.0, reference=Harmonic(1.0, 0.7), limit=4.0
    )
    balances = []
    for h in (1e-2, 5e-3):
        run = simulate(wheel(motor, h))
        np.testing.assert_array_equal(run.energy.work, run.motor("servo").work)
        balances.append(np.abs(run.energy.balance).max())
        power = run.motor("servo").power
        np.testing.assert_allclose(
            power, run.motor("servo").torque * run.joint("axle").angle_rate, atol=1e-12
        )
    assert orders(np.array(balances)) > 1.8
    assert balances[-1] < 1e-4 * np.abs(run.energy.work).max()
    assert not run.energy.springs.any()
    assert not run.energy.dissipated.any()


# The start


def arm(h=1e-3, at=(1.0, 0.0, 2.0), angle=0.0, **keys):
    """A horizontal arm on a pin, which a servo holds against gravity."""
    limit = keys.pop("limit", None)
    body = RigidBody(
        2.0, [J, J, J], {"pin": Frame([-0.5, 0, 0])}, Start(place=Place("pin", "ground.post"))
    )
    return Model(
        {"arm": body},
        joints=[Revolute("ground.post", "arm.pin", [0, -1, 0], name="pin", start={"angle": angle})],
        motors=[Motor("servo", "pin", "angle", limit=limit, **keys)],
        ground_frames={"post": Frame(at)},
        gravity=[0, 0, -9.81],
        settings=Settings(t_end=0.2, step=h, start="equilibrium"),
    )


def test_a_servo_holds_its_load_with_a_droop():
    run = simulate(arm(stiffness=100.0, damping=1.0))
    angle = run.joint("pin").angle
    assert 100.0 * -angle[0] == pytest.approx(9.81 * np.cos(angle[0]), rel=1e-12)
    np.testing.assert_allclose(angle, angle[0], atol=1e-11)


@pytest.mark.parametrize("reference", [0.3, -2.5])
def test_an_integral_takes_the_load_and_stands_still(reference):
    model = arm(stiffness=100.0, damping=1.0, integral=40.0, reference=Constant(reference))
    run = simulate(model)
    np.testing.assert_allclose(run.joint("pin").angle, reference, atol=1e-11)
    np.testing.assert_allclose(run.motor("servo").torque, 9.81 * np.cos(reference), rtol=1e-10)


def test_a_servo_that_is_too_weak_to_hold_its_reference():
    with pytest.raises(ModelError, match=r"motor 'servo': start = 'equilibrium': it takes 9.81 to"):
        start(arm(integral=40.0, stiffness=100.0, limit=5.0))


def test_a_reference_that_moves_is_no_equilibrium():
    moving = arm(stiffness=100.0, reference=Polynomial([0.0, 0.2]))
    with pytest.raises(ModelError, match=r"motor 'servo': start = 'equilibrium': rest"):
        start(moving)


def test_a_reference_at_rest_but_for_rounding_is_an_equilibrium():
    """A sine from its trough: the cosine of a float near pi / 2 is 6e-17, not 0."""
    trough = Harmonic(0.3, 2.0, phase=-np.pi / 2, offset=0.3)
    model = wheel(servo(stiffness=40.0, damping=3.0, reference=trough), t_end=0.1)
    run = simulate(model.with_settings(start="equilibrium"))
    assert run.joint("axle").angle[0] == pytest.approx(0.0, abs=1e-12)
    assert run.joint("axle").angle_rate[0] == 0.0


def test_angles_count_over_full_turns():
    """A reference of two turns from the start, and a start after three, with a stop there."""
    path = SmoothFunction(
        lambda t: 4 * np.pi * np.sin(t) ** 2,
        lambda t: 4 * np.pi * np.sin(2 * t),
        lambda t: 8 * np.pi * np.cos(2 * t),
    )
    run = simulate(wheel(servo(stiffness=1e4, damping=1e2, reference=path), 2e-3, t_end=1.57))
    assert run.joint("axle").angle[-1] == pytest.approx(4 * np.pi, abs=5e-3)
    three = 6 * np.pi + 0.1
    held = wheel(servo(stiffness=10.0, reference=Constant(three)), start={"angle": three}.items())
    stop = Stop("end", "axle", "angle", (three - 0.1, three + 0.1), Impact(stiffness=1e3))
    run = simulate(replace(held, stops=[stop]))
    np.testing.assert_allclose(run.motor("servo").torque, 0.0, atol=1e-11)
    np.testing.assert_allclose(run.stop("end").gap, 0.1, atol=1e-11)


def test_a_servo_of_the_rate_starts_in_steady_rotation():
    """At its reference; and not at another rate."""
    spin = SteadyRotation(3.0 * TURN)
    steady = {"start": "equilibrium", "steady_rotation": spin}
    run = simulate(wheel(servo(damping=2.0, reference_rate=Constant(3.0))).with_settings(**steady))
    np.testing.assert_allclose(run.joint("axle").angle_rate, 3.0, rtol=1e-12)
    np.testing.assert_allclose(run.motor("servo").torque, 0.0, atol=1e-11)
    with pytest.raises(ModelError, match=r"motor 'servo': .* misses its drive by 1 rad/s"):
        start(wheel(servo(damping=2.0, reference_rate=Constant(2.0))).with_settings(**steady))


# Step by step, and in parts


GAINS = {"stiffness": 40.0, "damping": 3.0, "integral": 60.0, "limit": 4.0}


def test_a_simulator_takes_the_same_steps():
    path = Harmonic(1.0, 0.7)
    model = wheel(servo(**GAINS, reference=path, torque=Steps((0.3,), (1.0,))), t_end=0.5)
    run = simulate(model)
    given = servo(
        **GAINS,
        reference=Input("angle"),
        reference_rate=Input("rate", path.derivatives(0.0)[0]),
        torque=Steps((0.3,), (1.0,)),
    )
    names = ["motors/servo/torque", "joints/axle/angle", "motors/servo/error"]
    simulator = Simulator(replace(model, motors=[given]), names)
    assert simulator.inputs == ("angle", "rate")
    rows = [simulator.outputs]
    for t in run.time[1:].tolist():
        if len(rows) == 20:
            moment = simulator.save()
        rows.append(simulator.step([path(t), path.derivatives(t)[0]]))
    expected = [run.motor("servo").torque, run.joint("axle").angle, run.motor("servo").error]
    np.testing.assert_array_equal(rows, np.transpose(expected))
    simulator.restore(moment)
    t = float(run.time[20])
    np.testing.assert_array_equal(simulator.step([path(t), path.derivatives(t)[0]]), rows[20])


def test_an_explicit_controller_through_a_torque():
    """A torque that a program computes from the last step lags by one, and no more."""
    simulator = Simulator(
        wheel(servo(torque=Input("torque")), 1e-4, t_end=0.5),
        ["joints/axle/angle", "joints/axle/angle_rate"],
    )
    while simulator.time < 0.5 - 1e-9:
        angle, rate = simulator.outputs
        simulator.step([20.0 * (1.0 - angle) - 3.0 * rate])
    motor = servo(stiffness=20.0, damping=3.0, reference=Constant(1.0))
    exact = integrated(motor, np.array([0.0, 0.5]))[0, -1]
    assert simulator.outputs[0] == pytest.approx(exact, abs=1e-3)


def test_a_run_goes_on_to_the_bit(tmp_path):
    motor = servo(**GAINS, reference=Harmonic(1.0, 0.7))
    model = wheel(motor, t_end=0.5)
    simulate(model, output=tmp_path / "whole.h5")
    kept = {"checkpoint": {"every": 7}}
    simulate(model.with_settings(t_end=0.2, **kept), output=tmp_path / "parts.h5")
    simulate(model.with_settings(**kept), output=tmp_path / "parts.h5", resume=True)
    assert_same(tmp_path / "parts.h5", tmp_path / "whole.h5")
    other = replace(model, motors=[replace(motor, damping=3.1)])
    with pytest.raises(StateError, match=r"motors.servo.damping: was 3.0, is 3.1"):
        simulate(other.with_settings(**kept, t_end=0.6), output=tmp_path / "parts.h5", resume=True)


def test_another_model_goes_on_with_the_integral_of_a_motor(tmp_path):
    """After many turns, with a limit that is new."""
    motor = servo(**GAINS, reference=Polynomial((0.0, 30.0)))
    model = wheel(replace(motor, limit=None), t_end=1.0)
    whole = simulate(model)
    first = model.with_settings(t_end=0.6, checkpoint={"every": 10})
    simulate(first, output=tmp_path / "first.h5")
    then = replace(model, motors=[replace(motor, limit=1e6)])
    run = simulate(then.with_settings(start={"from": str(tmp_path / "first.h5")}))
    same = whole.time >= run.time[0] - 1e-12
    np.testing.assert_allclose(run.joint("axle").angle, whole.joint("axle").angle[same], rtol=1e-12)
    np.testing.assert_allclose(
        run.motor("servo").torque, whole.motor("servo").torque[same], atol=1e-9
    )


def test_two_sizes_of_steps_carry_the_integral():
    """Long steps of a servo that no contact disturbs, and short ones about a stop."""
    motor = servo(**GAINS, reference=Constant(1.0))
    stop = Stop("end", "axle", "angle", (-np.inf, 0.9), Impact(stiffness=1e3, restitution=0.5))
    model = replace(wheel(motor, 2e-3, t_end=1.0), stops=[stop])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ValidityWarning)
        short = simulate(model.with_settings(step=1e-3 / 8))
        mixed = simulate(model.with_settings(step=1e-3, contact_step=1e-3 / 8))
    times = np.searchsorted(short.time, mixed.time - 1e-9)
    np.testing.assert_allclose(
        mixed.joint("axle").angle, short.joint("axle").angle[times], atol=2e-4
    )
    assert mixed.solver["steps"] < 0.8 * (len(short.time) - 1)


# Invariance


def test_a_servo_far_away_and_turned():
    motor = servo(**GAINS, reference=Harmonic(1.0, 0.7))
    near, far = (simulate(wheel(motor, t_end=0.5, at=at)) for at in ((0, 0, 0), (1e3, -5e2, 2e3)))
    np.testing.assert_allclose(
        far.joint("axle").angle, near.joint("axle").angle, rtol=0, atol=1e-11
    )


@pytest.mark.parametrize("history", ["recursive", "fft", "direct"])
def test_a_servo_that_holds_is_a_spring_with_a_damper(coarse, history):
    """On a hub with a flexible beam, that a force on its tip bends."""
    hub = RigidBody(0.01, [0.006, 0.007, 0.01], {"rim": Frame([0.05, 0, 0])})
    gains = {"stiffness": 300.0, "damping": 0.2}
    model = Model(
        bodies={"hub": hub, "beam": FlexibleBody(coarse, Start(place=Place("root", "hub.rim")))},
        joints=(
            Revolute("ground", "hub", [0, 0, 1], name="pivot"),
            Fixed("hub.rim", "beam.root", name="clamp"),
        ),
        loads=[Force("beam.tip", [0, 1.0, 0], Steps((0.0,), (3.0,)))],
        settings=Settings(step=5e-4, t_end=0.03, history=history),
    )
    spring = Spring("coil", "torsion", ("ground", "hub"), [0, 0, 1], **gains)
    held = replace(model, motors=[Motor("servo", "pivot", "angle", **gains)])
    by_spring, by_motor = simulate(replace(model, springs=[spring])), simulate(held)
    tips = [run.frame("beam.tip").position for run in (by_spring, by_motor)]
    np.testing.assert_allclose(tips[1], tips[0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(
        by_motor.motor("servo").torque, by_spring.spring("coil").multipliers[:, 0], atol=1e-9
    )
    taken = by_spring.energy.dissipated + by_spring.energy.springs
    np.testing.assert_allclose(-by_motor.motor("servo").work, taken, atol=1e-11)


# Files, checks and errors


def test_a_motor_in_a_file(tmp_path):
    motors = [
        servo(**GAINS, reference=Harmonic(1.0, 0.7), reference_rate=Constant(1.0)),
        Motor("push", "axle", "angle", torque=Constant(1.0), limit=(-1.0, np.inf)),
        Motor("fan", "axle", "angle", damping=1.0, limit=2.0, speed=3.0),
    ]
    model = replace(wheel(motors[0]), motors=motors)
    write_model(tmp_path / "model.toml", model)
    assert list(map(vars, read_model(tmp_path / "model.toml").motors)) == list(map(vars, motors))
    assert "limit = 4.0" in (tmp_path / "model.toml").read_text()
    simulate(model.with_settings(t_end=0.05), output=tmp_path / "run.h5")
    results = Results.read(tmp_path / "run.h5")
    assert results.motors == ("servo", "push", "fan")
    assert "motors/push" in results.recorded
    assert (results.motor("push").torque == 1.0).all()


def test_a_check_tells_the_frequency_of_a_servo():
    omega = 2 * np.pi * 10.0
    checked = check(wheel(servo(stiffness=J * omega**2, damping=1.0, torque=Constant(2.0)), 1e-2))
    assert "motor 'servo': angle of joint 'axle'; 2 N m at the start; servo of 10 Hz" in str(
        checked
    )
    assert any("motor 'servo': its servo has 10 steps in a period" in w for w in checked.warnings)
    np.testing.assert_allclose(checked.frequencies, [10.0])


def test_linear_equations_have_the_servo():
    """Poles of J s^3 + damping s^2 + stiffness s + integral."""
    gains = {"stiffness": J * 400.0, "damping": J * 4.0, "integral": J * 500.0}
    values = linearize(wheel(servo(**gains))).modes().values
    (s,) = values[values.imag > 0.0]
    poles = np.roots([1.0, 4.0, 400.0, 500.0])
    (expected,) = poles[poles.imag > 0.0]
    np.testing.assert_allclose([s.real, s.imag], [expected.real, expected.imag], rtol=1e-9)


def test_a_reference_that_is_no_number_is_named():
    def path(t):
        return np.nan if t > 0.1 else 0.0

    with pytest.raises(ConvergenceError, match="motor 'servo': its reference is no number"):
        simulate(wheel(servo(stiffness=1.0, reference=Function(path))))


def test_the_inertia_of_a_servo_is_that_of_all_that_it_moves():
    """Of a wheel that is fixed to the one that is driven."""
    bodies = {"wheel": RigidBody(1e-3, [1e-4] * 3), "disk": RigidBody(1.0, [J, J, J])}
    model = Model(
        bodies,
        joints=[
            Revolute("ground", "wheel", TURN, name="axle"),
            Fixed("wheel", "disk", name="weld"),
        ],
        motors=[servo(stiffness=(J + 1e-4) * 100.0, damping=0.1)],
        settings=Settings(t_end=0.01, step=1e-3),
    )
    steps = simulate(model).validity.values("motor_steps")["servo"]
    assert steps == pytest.approx(2 * np.pi / (10.0 * 1e-3), rel=1e-9)


WRONG = {
    "no joint": ({"joint": "hinge"}, r"motor 'm': joint: no joint 'hinge'; there are: axle"),
    "no coordinate": ({"coordinate": "distance"}, r"coordinate: joint 'axle' has angle, got"),
    "a force on an angle": (
        {"torque": None, "force": Constant(1.0)},
        r"motor 'm': force: 'angle' is an angle and takes a torque",
    ),
    "nothing": ({"torque": None}, r"expected torque, force, stiffness, damping or integral"),
    "both": ({"force": Constant(1.0)}, r"expected torque of an angle or force of a distance"),
    "a reference alone": ({"reference": Constant(1.0)}, r"reference: needs stiffness, damping or"),
    "a rate alone": (
        {"reference_rate": Constant(1.0), "stiffness": 1.0},
        r"reference_rate: needs damping",
    ),
    "a rate of no reference": (
        {"reference_rate": Constant(1.0), "stiffness": 1.0, "damping": 1.0},
        r"reference_rate: needs reference",
    ),
    "a negative gain": ({"stiffness": -1.0}, r"stiffness: expected a number of at least 0"),
    "no limit": ({"limit": 0.0}, r"limit: expected a positive number, or a lower and a higher"),
    "a limit of three": ({"limit": (1.0, 2.0, 3.0)}, r"limit: expected a positive number, or"),
    "a speed alone": ({"speed": 1.0}, r"speed: needs limit"),
    "a speed to one side": ({"speed": 1.0, "limit": (1.0, 2.0)}, r"speed: needs a limit on both"),
    "a tracking time alone": ({"tracking_time": 1.0}, r"tracking_time: needs integral and limit"),
    "an integral alone": ({"integral": 1.0, "limit": 1.0}, r"tracking_time: required with"),
    "a number": ({"torque": 3.0}, r"motor 'm': torque: expected a signal"),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_motor_that_cannot_be(case):
    changes, message = WRONG[case]
    keys = {"name": "m", "joint": "axle", "coordinate": "angle", "torque": Constant(1.0)}
    with pytest.raises(ModelError, match=message):
        wheel(Motor(**keys | changes))


def test_a_motor_on_a_driven_coordinate():
    model = wheel(servo(torque=Constant(1.0)))
    driven = replace(model.joints[0], angle=Constant(0.0))
    with pytest.raises(ModelError, match="motor 'servo': coordinate: angle of 'axle' is driven"):
        replace(model, joints=[driven])


def test_names_of_motors_are_those_of_nothing_else():
    with pytest.raises(ModelError, match="bearings, fmus: expected different names, got 'axle'"):
        wheel(Motor("axle", "axle", "angle", torque=Constant(1.0)))
