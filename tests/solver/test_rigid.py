"""Rigid bodies against closed forms and independent integrators."""

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    Frame,
    Harmonic,
    Model,
    Polynomial,
    Prismatic,
    Revolute,
    RigidBody,
    Settings,
    Spherical,
    Start,
    Torque,
    simulate,
)
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from scipy.special import ellipk

G = 9.81
SETTLING = 300
"""steps after which multipliers have forgotten the error, of the order of h, that a_0 = v_dot_0
gives their start
"""


def rotations(quaternions):
    return Rotation.from_quat(quaternions, scalar_first=True)


def crossings(t, y):
    """Times at which y rises through zero, from a cubic through the four points around."""
    times = []
    for k in np.flatnonzero((y[1:-2] < 0) & (y[2:-1] >= 0)) + 1:
        cubic = np.polynomial.Polynomial.fit(y[k - 1 : k + 3], t[k - 1 : k + 3], 3)
        times.append(cubic(0.0))
    return np.array(times)


def bar(arm, angle):
    """The paper's beam as a rigid bar: its root `arm` from the pivot at the origin, turned about z
    from -y.
    """
    center = arm + 0.25
    inertia = 0.0858 * 0.5**3 / 12
    return RigidBody(
        0.0429,
        [1e-6, inertia, inertia],
        {"pivot": Frame([-center, 0, 0])},
        Start(
            position=center * np.array([np.sin(angle), -np.cos(angle), 0.0]),
            rotation=[0, 0, angle - 0.5 * np.pi],
        ),
    )


@pytest.mark.parametrize(("arm", "small"), [(0.05, 5.153), (0.0, 5.425)])
def test_the_period_of_a_pendulum(arm, small):
    """T = 4 K(sin^2(angle/2)) / omega with omega of docs/theory.md, Energy, at an amplitude of 60
    degrees.
    """
    amplitude, h = np.pi / 3, 5e-4
    omega = np.sqrt(0.0429 * G * (arm + 0.25) / (0.0858 * 0.5**3 / 12 + 0.0429 * (arm + 0.25) ** 2))
    assert omega == pytest.approx(small, abs=5e-4)
    model = Model(
        bodies={"bar": bar(arm, amplitude)},
        joints=(Revolute("ground", "bar.pivot", [0, 0, 1], name="pivot"),),
        gravity=[0, -G, 0],
        settings=Settings(t_end=6.0, step=h, rho_inf=0.9),
    )
    results = simulate(model)
    period = np.diff(crossings(results.time, results.body("bar").x[:, 0])).mean()
    expected = 4.0 * ellipk(np.sin(0.5 * amplitude) ** 2) / omega
    # the scheme lengthens the period by about (omega h)^2 / 12
    assert period == pytest.approx(expected, rel=(omega * h) ** 2)


def test_a_symmetric_top_without_torque_precesses():
    """Its axis cones about the angular momentum at |J omega| / J_1; the momentum stays
    where it is.
    """
    J1, J3, h = 1.0, 2.0, 1e-3
    omega = np.array([0.5, 0.0, 3.0])
    body = RigidBody(1.0, [J1, J1, J3], {}, Start(angular_velocity=omega))
    results = simulate(Model({"top": body}, settings=Settings(t_end=4.0, step=h, rho_inf=0.9)))
    momentum = np.array([J1, J1, J3]) * omega
    rate = np.linalg.norm(momentum) / J1
    axis = rotations(results.body("top").R).apply([0, 0, 1])
    about = Rotation.from_rotvec(np.outer(results.time * rate, momentum / np.linalg.norm(momentum)))
    assert np.abs(axis - about.apply([0, 0, 1])).max() < (rate * h) ** 2 * rate * 4.0 / 6.0
    body_rate = (J3 - J1) / J1 * omega[2]
    spun = results.body("top").v[:, 3:5] @ [1, 1j]
    assert (
        np.abs(spun - 0.5 * np.exp(1j * body_rate * results.time)).max()
        < (body_rate * h) ** 2 * body_rate * 4.0
    )


def conserved(h, rho_inf=0.9):
    """Drift of energy and of angular momentum of a tumbling body, relative, after 2 s."""
    J, omega = np.array([1.0, 2.0, 2.5]), np.array([1.0, 2.0, -1.5])
    body = RigidBody(1.0, J, {}, Start(rotation=[0.3, 0.1, -0.5], angular_velocity=omega))
    results = simulate(Model({"body": body}, settings=Settings(t_end=2.0, step=h, rho_inf=rho_inf)))
    v = results.body("body").v
    momentum = rotations(results.body("body").R).apply(J * v[:, 3:])
    energy = results.energy.kinetic
    return (
        np.abs(energy / energy[0] - 1).max(),
        np.linalg.norm(momentum - momentum[0], axis=1).max() / np.linalg.norm(momentum[0]),
    )


def test_energy_and_momentum_of_a_tumbling_body_drift_by_order_two():
    drifts = np.array([conserved(h) for h in (8e-3, 4e-3, 2e-3)])
    orders = np.log2(drifts[:-1] / drifts[1:])
    assert (orders > 1.9).all()


def heavy_top(h, gyration=(0.234375, 0.46875, 0.234375), t_end=1.0):
    """The benchmark of Bruls, Cardona and Arnold: 15 kg, one meter from a spherical joint, spinning
    about its axis.

    `gyration`: about the center of mass; the velocity of this is omega x X.
    """
    X, omega = np.array([0.0, 1.0, 0.0]), np.array([0.0, 150.0, -4.61538])
    body = RigidBody(
        15.0,
        gyration,
        {"foot": Frame(-X)},
        Start(position=X, velocity=np.cross(omega, X), angular_velocity=omega),
    )
    model = Model(
        {"top": body},
        (Spherical("ground", "top.foot", name="foot"),),
        gravity=[0, 0, -G],
        settings=Settings(t_end=t_end, step=h, rho_inf=0.9),
    )
    return simulate(model)


def heavy_top_by_euler(t):
    """Positions of the center from Euler's equations about the fixed point, with quaternions, to
    1e-12.
    """
    X = np.array([0.0, 1.0, 0.0])
    J = np.diag([0.234375, 0.46875, 0.234375]) + 15.0 * (X @ X * np.eye(3) - np.outer(X, X))

    def rate(_, y):
        q, omega = Rotation.from_quat(y[:4]), y[4:]
        torque = 15.0 * np.cross(X, q.apply([0, 0, -G], inverse=True))
        x, y_, z, w = y[:4]
        turn = 0.5 * np.array([[w, -z, y_], [z, w, -x], [-y_, x, w], [-x, -y_, -z]]) @ omega
        return np.concatenate([turn, np.linalg.solve(J, torque - np.cross(omega, J @ omega))])

    start = [0, 0, 0, 1, 0, 150.0, -4.61538]
    solution = solve_ivp(
        rate, (0.0, t[-1]), start, method="DOP853", t_eval=t, rtol=1e-12, atol=1e-12
    )
    return Rotation.from_quat(solution.y[:4].T).apply(X)


def test_the_heavy_top():
    """Order two towards an independent integration of Euler's equations."""
    errors = []
    steps = np.array([1e-3, 5e-4, 2.5e-4, 1.25e-4])
    t = np.arange(0.0, 1.0 + 5e-4, 1e-3)
    exact = heavy_top_by_euler(t)
    for h in steps:
        x = heavy_top(h).body("top").x[:: round(1e-3 / h)]
        errors.append(np.linalg.norm(x - exact, axis=1).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (np.abs(orders[1:] - 2.0) < 0.1).all(), orders
    assert errors[-1] < 2e-3


def test_the_heavy_top_keeps_its_energy_to_order_two():
    drifts = []
    for h in (1e-3, 5e-4, 2.5e-4):
        balance = heavy_top(h).energy.balance
        drifts.append(np.abs(balance).max())
    assert (np.log2(np.array(drifts[:-1]) / drifts[1:]) > 1.9).all()


def test_the_angle_of_a_revolute_joint_is_driven():
    """Angle, initial acceleration and torque J s'' of a body that a drive swings about its
    center.
    """
    drive, h = Harmonic(0.7, 2.0, 0.4, 0.3), 1e-3
    body = RigidBody(2.0, [1.0, 1.5, 0.8], {}, Start(rotation=[0, 0, 0.9]))
    joint = Revolute("ground", "body", [0, 0, 1], name="motor", angle=drive)
    results = simulate(
        Model({"body": body}, (joint,), settings=Settings(t_end=1.0, step=h, rho_inf=0.9))
    )
    angle = rotations(results.body("body").R).as_rotvec()[:, 2]
    expected = 0.9 + np.array([drive(t) - drive(0.0) for t in results.time])
    assert np.abs(angle - expected).max() < 1e-12
    first, second = drive.derivatives(0.0)
    assert results.body("body").v[0, 5] == pytest.approx(first, rel=1e-12)
    assert results.body("body").v_dot[0, 5] == pytest.approx(second, rel=1e-12)
    moment, settled = results.joint("motor").moment[:, 2], results.time > SETTLING * h
    theory = 0.8 * np.array([drive.derivatives(t)[1] for t in results.time])
    assert moment[0] == pytest.approx(theory[0], rel=1e-12)
    assert np.abs(moment - theory)[settled].max() < (4 * np.pi * h) ** 2 * np.abs(theory).max()


def test_the_distance_of_a_prismatic_joint_is_driven():
    """x = s(t) along an oblique axis under gravity; the force is m (s'' - g . axis)."""
    axis, drive, h = np.array([1.0, 2.0, 2.0]) / 3.0, Polynomial((0.0, 0.5, -1.5, 0.7)), 1e-3
    body = RigidBody(2.0, [1.0, 1.5, 0.8], {"grip": Frame([0.2, 0.1, -0.3])})
    joint = Prismatic("ground", "body.grip", axis, name="slide", distance=drive)
    results = simulate(
        Model(
            {"body": body},
            (joint,),
            gravity=[0, 0, -G],
            settings=Settings(t_end=1.0, step=h, rho_inf=0.9),
        )
    )
    expected = np.array([drive(t) for t in results.time])
    assert np.abs(results.body("body").x - np.outer(expected, axis)).max() < 1e-12
    assert results.body("body").v[0, :3] == pytest.approx(0.5 * axis, rel=1e-12)
    assert results.body("body").v_dot[0, :3] == pytest.approx(-3.0 * axis, rel=1e-12)
    force, settled = results.joint("slide").force @ axis, results.time > SETTLING * h
    theory = 2.0 * (np.array([drive.derivatives(t)[1] for t in results.time]) + G * axis[2])
    assert force[0] == pytest.approx(theory[0], rel=1e-12)
    assert np.abs(force - theory)[settled].max() < 2.0 * 4.2 * h**2


def test_a_body_falls_freely():
    """x = x_0 + v t + g t^2 / 2 exactly: the scheme integrates constant accelerations without
    error.
    """
    start = Start(position=[1, 2, 3], velocity=[0.5, -0.2, 2.0], angular_velocity=[0, 0, 3.0])
    model = Model(
        {"stone": RigidBody(2.0, [1, 1, 2], {}, start)},
        gravity=[0, 1.0, -G],
        settings=Settings(t_end=0.5, step=1e-3, rho_inf=0.8),
    )
    results = simulate(model)
    t = results.time[:, None]
    expected = start.position + start.velocity * t + 0.5 * np.array([0, 1.0, -G]) * t**2
    assert np.abs(results.body("stone").x - expected).max() < 1e-13
    assert rotations(results.body("stone").R).as_rotvec()[:, 2] == pytest.approx(
        3.0 * results.time, abs=1e-12
    )
    assert np.abs(results.energy.balance).max() < 1e-12


def test_a_follower_torque_spins_a_body_and_its_work_is_counted():
    """omega = torque t / J about the axis that turns with the body, and the energy is the work."""
    body = RigidBody(
        1.0,
        [3.0, 2.0, 4.0],
        {"knob": Frame([0.3, 0, 0], [0, 0.5 * np.pi, 0])},
        Start(rotation=[0.4, -0.2, 0.9]),
    )
    load = Torque("body.knob", [1, 0, 0], Constant(2.0), follower=True)
    results = simulate(
        Model({"body": body}, loads=(load,), settings=Settings(t_end=1.0, step=1e-3, rho_inf=0.9))
    )
    assert results.body("body").v[:, 5] == pytest.approx(-0.5 * results.time, abs=1e-12)
    assert np.abs(results.energy.balance).max() < 1e-12
    assert results.energy.work[-1] == pytest.approx(0.5 * 4.0 * 0.25, rel=1e-10)


def test_the_work_of_a_drive_is_counted():
    """A pendulum swung by its pivot against gravity: the energy balance closes to order two."""
    drift = []
    for h in (2e-3, 1e-3, 5e-4):
        body = RigidBody(2.0, [1.0, 1.5, 0.8], {"pivot": Frame([0.3, 0, 0])})
        swing = Harmonic(0.7, 2.0, 0.5 * np.pi, 0.3)
        joint = Revolute("ground", "body.pivot", [0, 0, 1], name="motor", angle=swing)
        energy = simulate(
            Model(
                {"body": body},
                (joint,),
                gravity=[0, -G, 0],
                settings=Settings(t_end=1.0, step=h, rho_inf=0.9),
            )
        ).energy
        drift.append(np.abs(energy.balance).max() / energy.kinetic.max())
    assert (np.log2(np.array(drift[:-1]) / drift[1:]) > 1.95).all(), drift
