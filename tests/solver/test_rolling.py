"""Discs that roll on a plane: closed forms, Newton and Euler's equations, and the Newton matrix."""

import duhamel as du
import numpy as np
import pytest
from duhamel.solver import ModelError, RollingDisc, Settings
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from .test_contact_tangents import assert_newton_matrix, closed
from .test_tangents import AXIS, PAIRS, SECOND, make_body, make_pair  # noqa: F401 - fixtures

M, R, G = 2.0, 0.5, 9.81
INERTIA = M * R**2 * np.array([0.25, 0.5, 0.25])
UP = np.array([0.0, 0.0, 1.0])


def lever(axle, rate):
    """From the center to the point that touches, and its rate."""
    w, dw = UP - axle[2] * axle, -rate[2] * axle - axle[2] * rate
    q = np.linalg.norm(w)
    return -R * w / q, -R * (dw - (w @ dw) / q**2 * w) / q


def disc(lean, spin, yaw, t_end, step, **given):
    """A disc that leans about x, spins about its axle and turns about the vertical at the start."""
    turn = Rotation.from_rotvec([lean, 0.0, 0.0])
    axle = turn.apply([0.0, 1.0, 0.0])
    omega = spin * axle + yaw * UP
    velocity = np.cross(lever(axle, np.zeros(3))[0], omega)
    m = du.Mechanism(gravity=-G * UP)
    body = m.add(
        du.RigidBody(M, INERTIA),
        "disc",
        position=[0.0, 0.0, R * np.cos(lean)],
        rotation=turn.as_rotvec(),
        velocity=velocity,
        angular_velocity=turn.inv().apply(omega),
    )
    floor = m.ground.frame("floor")
    m.add(du.joints.RollingDisc(floor, body, UP, axle, radius=R, name="rim"))
    return m.simulate(t_end, step=step, **given)


def newton_and_euler(lean, spin, yaw, time):
    """Positions of the center (n, 3), by quaternions and the balance about the center.

    J w' + w x J w = l x m (a + g n), a = l x w' + l' x w of the center of a disc that rolls.
    """
    turn = Rotation.from_rotvec([lean, 0.0, 0.0])
    omega = spin * turn.apply([0.0, 1.0, 0.0]) + yaw * UP

    def rate(_, y):
        A, w = Rotation.from_quat(y[:4]).as_matrix(), y[4:7]
        arm, arm_rate = lever(A[:, 1], np.cross(w, A[:, 1]))
        J = A @ np.diag(INERTIA) @ A.T
        about_floor = J + M * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        moment = M * np.cross(arm, np.cross(arm_rate, w) + G * UP) - np.cross(w, J @ w)
        v, s = y[:3], y[3]
        quaternion = 0.5 * np.append(s * w + np.cross(w, v), -w @ v)
        return np.concatenate([quaternion, np.linalg.solve(about_floor, moment), np.cross(arm, w)])

    start = np.concatenate([turn.as_quat(), omega, [0.0, 0.0, R * np.cos(lean)]])
    limits = {"rtol": 1e-11, "atol": 1e-12}
    return solve_ivp(rate, (0.0, time[-1]), start, "DOP853", t_eval=time, **limits).y[7:].T


def test_a_wobbling_disc_follows_newton_and_euler():
    """Its position, its energy and the forces at its rim, with the square of the step."""
    errors, energies, forces = [], [], []
    for step in (4e-3, 2e-3, 1e-3):
        run = disc(0.3, 6.0, 0.5, 2.0, step)
        expected = newton_and_euler(0.3, 6.0, 0.5, run.time)
        errors.append(np.abs(run["disc"].x - expected).max())
        energies.append(np.ptp(run.energy.kinetic + run.energy.potential))
        forces.append(run["rim"].multipliers[-1])
    errors, energies = np.array(errors), np.array(energies)
    assert errors[-1] < 2e-5
    np.testing.assert_allclose(errors[:-1] / errors[1:], 4.0, atol=0.05)
    np.testing.assert_allclose(energies[:-1] / energies[1:], 4.0, atol=0.05)
    np.testing.assert_allclose((forces[0] - forces[1]) / (forces[1] - forces[2]), 4.0, atol=0.1)


def test_the_point_that_touches_is_at_rest():
    run = disc(0.3, 6.0, 0.5, 1.0, 2e-3)
    body = run["disc"]
    for at in (100, 300, 500):
        axle = Rotation.from_quat(body.R[at], scalar_first=True).apply([0.0, 1.0, 0.0])
        arm, _ = lever(axle, np.zeros(3))
        slip = body.velocity[at] + np.cross(body.angular_velocity[at], arm)
        np.testing.assert_allclose(slip[:2], 0.0, atol=1e-9)
        # the height is closed, and its rate to second order of the step
        assert slip[2] == pytest.approx(0.0, abs=2e-5)
        assert body.x[at, 2] + arm[2] == pytest.approx(0.0, abs=1e-12)


def test_eulers_disc_turns_on_the_spot():
    """Inclined by a, its point of contact goes round at the root of 4 g / (R sin a)."""
    incline = 0.25
    rate = np.sqrt(4.0 * G / (R * np.sin(incline)))
    # The center rests, so that the disc turns about the diameter through the point that touches.
    run = disc(np.pi / 2 - incline, -rate * np.sin(np.pi / 2 - incline), rate, 0.5, 1e-4)
    turn = Rotation.from_quat(run["disc"].R, scalar_first=True)
    axle = turn.apply([0.0, 1.0, 0.0])
    np.testing.assert_allclose(
        run["disc"].x, [[0.0, 0.0, R * np.sin(incline)]] * len(axle), atol=2e-5
    )
    heading = np.unwrap(np.arctan2(axle[:, 1], axle[:, 0]))
    assert heading[-1] - heading[0] == pytest.approx(0.5 * rate, rel=1e-4)


@pytest.mark.parametrize("spin", [3.0, 6.0])
def test_an_upright_disc_wobbles(spin):
    """At omega^2 = 12/5 spin^2 - 4/5 g / R, from spins of the root of g / (3 R) on."""
    omega = np.sqrt(2.4 * spin**2 - 0.8 * G / R)
    periods = 3.0
    run = disc(0.0, spin, 1e-4, periods * 2.0 * np.pi / omega, 1e-3)
    axle = Rotation.from_quat(run["disc"].R, scalar_first=True).apply([0.0, 1.0, 0.0])[:, 2]
    # about a circle as wide as the turn that it starts with asks for
    lean = axle - 0.5 * (axle.max() + axle.min())
    before = np.flatnonzero(lean[:-1] * lean[1:] < 0.0)
    crossings = before + lean[before] / (lean[before] - lean[before + 1])
    assert np.diff(crossings).mean() * 1e-3 == pytest.approx(np.pi / omega, rel=1e-3)


def test_a_disc_rolls_down_an_incline():
    """a = g sin(slope) / (1 + J / (m R^2)), held by a third of its weight along the slope."""
    slope = 0.2
    down, normal = (
        np.array([np.cos(slope), 0, -np.sin(slope)]),
        np.array([np.sin(slope), 0, np.cos(slope)]),
    )
    m = du.Mechanism(gravity=-G * UP)
    body = m.add(du.RigidBody(M, INERTIA), "disc", position=R * normal)
    rim = du.joints.RollingDisc(
        m.ground.frame("floor"), body, normal, [0, 1, 0], radius=R, name="rim"
    )
    m.add(rim)
    run = m.simulate(1.0, step=1e-2)
    a = G * np.sin(slope) / 1.5
    np.testing.assert_allclose(run["disc"].x[-1] - R * normal, 0.5 * a * down, atol=1e-9)
    push, along, across = run["rim"].multipliers[-1]
    assert push == pytest.approx(M * G * np.cos(slope))
    assert along == pytest.approx(-M * G * np.sin(slope) / 3.0)
    assert across == pytest.approx(0.0, abs=1e-9)
    assert run.results.solver["degrees_of_freedom"] == 3


def test_a_disc_drives_the_plank_on_which_it_rolls():
    """Nothing else moves the plank: momentum along it stays zero while a torque spins the disc."""
    m = du.Mechanism()
    plank = m.add(du.RigidBody(3.0, [1.0] * 3), "plank")
    body = m.add(du.RigidBody(M, INERTIA), "disc", position=[0.0, 0.0, R])
    m.add(du.joints.Prismatic(m.ground, plank, "x"))
    m.add(du.joints.RollingDisc(plank, body, "z", "y", radius=R))
    m.add(du.loads.Torque(body, "y", du.signals.Constant(0.6)))
    run = m.simulate(1.0, step=1e-2)
    v, u, w = run["disc"].v[-1, 0], run["plank"].v[-1, 0], run["disc"].v[-1, 4]
    assert v - u == pytest.approx(R * w)
    assert M * v + 3.0 * u == pytest.approx(0.0, abs=1e-9)
    # T = J w' + f R, f = m v' of the disc
    assert INERTIA[1] * w + M * v * R == pytest.approx(0.6)


def test_an_eccentric_wheel_swings_as_in_closed_form():
    """omega^2 = m g e / (J + m (R - e)^2), with the center of mass below the axle by e."""
    e = 0.1
    m = du.Mechanism(gravity=-G * UP)
    wheel = du.RigidBody(M, INERTIA, {"axle": [0.0, 0.0, e]})
    body = m.add(wheel, "wheel", position=[0.0, 0.0, R - e])
    m.add(du.joints.RollingDisc(m.ground.frame("floor"), body["axle"], "z", "y", radius=R))
    omega = np.sqrt(M * G * e / (INERTIA[1] + M * (R - e) ** 2))
    # It would fall over to the side besides: that pole is real.
    m.settings = Settings(t_end=1.0, step=1e-3)
    frequencies = m.modes().frequencies
    assert frequencies.max() == pytest.approx(omega / (2.0 * np.pi), rel=1e-6)


def test_an_eccentric_wheel_rolls_to_its_equilibrium():
    """By R times the angle; the finite steps of the search slip by 3e-4 of the way."""
    e, angle = 0.1, 0.3
    m = du.Mechanism(gravity=-G * UP)
    wheel = du.RigidBody(M, INERTIA, {"axle": [0.0, 0.0, e]})
    center = [-e * np.sin(angle), 0.0, R - e * np.cos(angle)]
    body = m.add(wheel, "wheel", position=center, rotation=[0.0, angle, 0.0])
    m.add(du.joints.RollingDisc(m.ground.frame("floor"), body["axle"], "z", "y", radius=R))
    run = m.simulate(0.1, step=1e-3, start="equilibrium")
    np.testing.assert_allclose(run["wheel.axle"].position[-1], [-R * angle, 0.0, R], atol=1e-4)
    np.testing.assert_allclose(run["wheel"].x[-1, 2], R - e, atol=1e-9)


@pytest.mark.parametrize("kinds", PAIRS, ids="-".join)
def test_the_newton_matrix_of_a_rolling_disc(make_pair, kinds):  # noqa: F811
    joint = RollingDisc("a.i0", "b.i0", AXIS, SECOND + 0.3 * AXIS, name="rim", radius=0.2)
    assert_newton_matrix(closed(make_pair(kinds, (joint,), assemble=True)))


def test_a_rim_off_the_plane_is_an_error():
    m = du.Mechanism()
    body = m.add(du.RigidBody(M, INERTIA), "disc", position=[0.0, 0.0, 0.6])
    floor = m.ground.frame("floor")
    m.add(du.joints.RollingDisc(floor, body, "z", "y", radius=R, name="rim"))
    with pytest.raises(ModelError, match=r"joint 'rim'.*its rim is 0\.1 m above the plane"):
        m.simulate(0.1, step=1e-3)


def test_a_disc_must_not_lie_flat():
    with pytest.raises(ModelError, match="second_axis: the axle must not be along the normal"):
        RollingDisc("ground.floor", "disc", [0, 0, 1], [0, 0, -1], name="rim", radius=R)


def test_a_velocity_that_slips_is_corrected():
    """Least in kinetic energy, as a blow at the rim would."""
    m = du.Mechanism(gravity=-G * UP)
    body = m.add(du.RigidBody(M, INERTIA), "disc", position=[0.0, 0.0, R], velocity=[3.0, 0.0, 0.0])
    m.add(du.joints.RollingDisc(m.ground.frame("floor"), body, "z", "y", radius=R))
    run = m.simulate(0.1, step=1e-3)
    np.testing.assert_allclose(run["disc"].v[0], [2.0, 0, 0, 0, 4.0, 0], atol=1e-12)
