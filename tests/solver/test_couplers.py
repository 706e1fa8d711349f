"""Gears, racks, screws and linear couplers of joint coordinates against closed forms."""

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    Coupler,
    Cylindrical,
    Force,
    Frame,
    Harmonic,
    Model,
    ModelError,
    Polynomial,
    Prismatic,
    Revolute,
    RigidBody,
    Screw,
    Settings,
    Start,
    Torque,
    simulate,
)
from scipy.spatial.transform import Rotation

SORTS = ["spur", "bevel"]
J_1, J_2, TORQUE = 0.3, 0.8, 2.0
OFF, FAR = np.array([0.3, 0.1, 0.0]), np.array([1000.0, -2000.0, 500.0])


def wheel(J, mass=1.0, **start):
    return RigidBody(mass, [J, J, J], start=Start(**start))


def settings(**given):
    return Settings(**{"t_end": 1.0, "step": 1e-3} | given)


def gears(origin=(0.0, 0.0, 0.0), axes=((0, 0, 1), (0, 0, 1)), more=(), joints=(), **given):
    """Two wheels on the ground, a torque on the first."""
    origin = np.array(origin)
    coupler = {"teeth": [10, 25]} | given
    return Model(
        {"a": wheel(J_1, position=origin), "b": wheel(J_2, position=origin + OFF)},
        [
            Revolute("ground", "a", axes[0], name="p"),
            Revolute("ground", "b", axes[1], name="q"),
            *joints,
        ],
        couplers=[Coupler("gear", "gear", ["p", "q"], **coupler), *more],
        loads=[Torque("a", TORQUE * np.array(axes[0]), Constant(1.0))],
        settings=settings(),
    )


@pytest.mark.parametrize(
    "axes", [((0, 0, 1), (0, 0, 1)), ((0, 0, 1), (0, 1, 0))], ids=["", "bevel"]
)
@pytest.mark.parametrize("origin", [np.zeros(3), FAR], ids=["near", "far"])
def test_a_pair_of_gears_turns_with_the_reduced_inertia(origin, axes):
    """J_1 + J_2 / i^2, over many turns, also of bevel gears and kilometers away."""
    run = simulate(gears(origin, axes).with_settings(t_end=6.0))
    rate = TORQUE / (J_1 + J_2 / 2.5**2)
    p, q = run.joint("p"), run.joint("q")
    np.testing.assert_allclose(p.angle, 0.5 * rate * run.time**2, atol=1e-9)
    np.testing.assert_allclose(q.angle, -p.angle / 2.5, atol=1e-9)
    assert p.angle[-1] > 4 * np.pi
    np.testing.assert_allclose(run.coupler("gear").force, rate * J_1 - TORQUE, rtol=1e-5)
    assert run.solver["degrees_of_freedom"] == 1
    assert np.abs(run.energy.balance).max() < 1e-9 * run.energy.work[-1]


def test_a_ring_gear_turns_in_the_same_sense():
    run = simulate(gears(internal=True, teeth=None, radii=[0.1, 0.25]))
    np.testing.assert_allclose(run.joint("q").angle, run.joint("p").angle / 2.5, atol=1e-12)


def test_a_gear_puts_a_moment_on_each_wheel_by_its_teeth():
    run = simulate(gears())
    force = run.coupler("gear").force[-1]
    spin = [run.body(name).v_dot[-1, 5] for name in "ab"]
    assert J_1 * spin[0] - TORQUE == pytest.approx(force)
    assert J_2 * spin[1] == pytest.approx(2.5 * force)


def test_the_offset_of_a_coupler_moves_the_wheels_at_the_start():
    """Many turns away, and as a signal that turns the second wheel against the first."""
    still = gears(offset=Constant(1000.0)).with_settings(t_end=0.01)
    run = simulate(still)
    total = 10 * run.joint("p").angle + 25 * run.joint("q").angle
    np.testing.assert_allclose(total, 1000.0, atol=1e-9)
    run = simulate(gears(offset=Harmonic(5.0, 1.0, offset=3.0)))
    total = 10 * run.joint("p").angle + 25 * run.joint("q").angle
    np.testing.assert_allclose(total, 3.0 + 5.0 * np.sin(2 * np.pi * run.time), atol=1e-9)
    assert np.abs(run.energy.balance).max() < 1e-5


def test_a_joint_that_starts_elsewhere_takes_the_gear_along():
    joints = [Revolute("ground", "a", [0, 0, 1], name="p", start={"angle": 12.5})]
    model = gears()
    model = Model(
        model.bodies, [*joints, model.joints[1]], couplers=model.couplers, settings=settings()
    )
    run = simulate(model)
    assert run.joint("p").angle[0] == pytest.approx(12.5)
    assert run.joint("q").angle[0] == pytest.approx(-5.0)


def test_a_bevel_differential_shares_the_torque_and_adds_the_rates():
    """2 omega_c = omega_l + omega_r, with the inertia of the pinion about its own axis.

    On coordinates against the ground the pinion turns at (omega_l - omega_r) / 2 in its cage.
    """
    J_c, J_p, J_s = 0.5, 0.05, 0.2
    frames = {"pin": Frame([0, 0.1, 0]), "left": Frame([-0.1, 0, 0]), "right": Frame([0.1, 0, 0])}
    bodies = {
        "cage": RigidBody(1.0, [J_c, J_c, J_c], frames),
        "pinion": wheel(J_p, mass=0.1, position=[0.0, 0.1, 0.0]),
        "left": wheel(J_s, position=[-0.1, 0.0, 0.0]),
        "right": wheel(J_s, position=[0.1, 0.0, 0.0]),
    }
    joints = [
        Revolute("ground", "cage", [1, 0, 0], name="cage"),
        Revolute("cage.pin", "pinion", [0, 1, 0], name="pin"),
        Revolute("cage.left", "left", [-1, 0, 0], name="left"),
        Revolute("cage.right", "right", [1, 0, 0], name="right"),
    ]
    couplers = [
        Coupler("mesh", "gear", ["pin", "left"], teeth=[12, 12]),
        Coupler("other", "gear", ["pin", "right"], teeth=[12, 12]),
    ]
    cage, drag = 3.0, -1.0
    loads = [
        Torque("cage", [cage, 0, 0], Constant(1.0)),
        Torque("right", [drag, 0, 0], Constant(1.0)),
    ]
    model = Model(bodies, joints, loads, couplers=couplers, settings=settings())
    run = simulate(model)
    left, right = run.body("left").v[:, 3], run.body("right").v[:, 3]
    np.testing.assert_allclose(left + right, 2 * run.joint("cage").angle_rate, atol=1e-9)
    # Lagrange with omega_c = (l + r) / 2, pinion (l - r) / 2; its center goes round on a circle
    J_sum, J_diff = J_c + J_p + 0.1 * 0.1**2, J_p
    M = np.array([[J_s, 0.0], [0.0, J_s]]) + J_sum / 4 * np.ones((2, 2))
    M += J_diff / 4 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    rates = np.linalg.solve(M, [cage / 2, cage / 2 + drag])
    np.testing.assert_allclose(left, rates[0] * run.time, atol=1e-6)
    np.testing.assert_allclose(right, rates[1] * run.time, atol=1e-6)
    assert run.solver["degrees_of_freedom"] == 2


def test_a_rack_pushes_with_the_torque_over_the_radius():
    m, r = 4.0, 0.15
    model = Model(
        {"pinion": wheel(J_1), "bar": RigidBody(m, [1, 1, 1], start=Start([1.0, -r, 0.0]))},
        [
            Revolute("ground", "pinion", [0, 0, 1], name="p"),
            Prismatic("ground", "bar", [1, 0, 0], name="q"),
        ],
        couplers=[Coupler("rack", "rack", ["p", "q"], radius=r)],
        loads=[Torque("pinion", [0, 0, TORQUE], Constant(1.0))],
        settings=settings(),
    )
    run = simulate(model)
    acceleration = TORQUE / (J_1 + m * r**2)
    np.testing.assert_allclose(run.joint("p").angle, 0.5 * acceleration * run.time**2, atol=1e-9)
    np.testing.assert_allclose(run.joint("q").distance, r * run.joint("p").angle, atol=1e-12)
    np.testing.assert_allclose(-run.coupler("rack").force / r, m * r * acceleration, rtol=1e-6)


@pytest.mark.parametrize("lead", [0.02, -0.02])
@pytest.mark.parametrize("form", ["joint", "coupler"])
def test_a_screw_turns_torque_into_force(form, lead):
    """F = 2 pi T / lead on a nut that is held by a load: turned, and away from the origin."""
    turn = Rotation.from_rotvec([0.3, -0.5, 0.7])
    e, force = turn.apply([0.0, 0.0, 1.0]), 100.0
    start = {"position": [5.0, 3.0, 1.0], "rotation": turn.as_rotvec()}
    m, J = 2.0, 0.004
    balance = force * lead / (2 * np.pi)
    if form == "joint":
        bodies = {"nut": wheel(J, m, **start)}
        joints = [Screw("ground", "nut", e, name="q", lead=lead)]
        couplers = []
    else:
        bodies = {"spindle": wheel(J / 2, **start), "nut": wheel(J / 2, m, **start)}
        joints = [
            Revolute("ground", "spindle", e, name="p"),
            Cylindrical("ground", "nut", e, name="q"),
        ]
        couplers = [
            Coupler("screw", "screw", ["p", "q.distance"], lead=lead),
            Coupler("tie", "linear", ["p", "q.angle"], ratios=[1, -1]),
        ]
    torque = 1.5 * balance
    loads = [
        Force("nut", -force * e, Constant(1.0)),
        Torque(next(iter(bodies)), torque * e, Constant(1.0)),
    ]
    model = Model(bodies, joints, loads, couplers=couplers, settings=settings(t_end=0.1))
    run = simulate(model)
    acceleration = (torque - balance) / (J + m * (lead / (2 * np.pi)) ** 2)
    angle = run.joint("p").angle if couplers else run.joint("q").angle
    np.testing.assert_allclose(angle, 0.5 * acceleration * run.time**2, atol=1e-9)
    np.testing.assert_allclose(run.joint("q").distance, lead / (2 * np.pi) * angle, atol=1e-11)
    assert abs(angle[-1]) > 0.1
    assert np.abs(run.energy.balance).max() < 1e-9


def test_a_screw_carries_its_axial_force_as_a_moment():
    lead, force = 0.02, 100.0
    joints = [Screw("ground", "nut", [0, 0, 1], name="q", lead=lead, angle=Constant(0.0))]
    loads = [Force("nut", [0, 0, -force], Constant(1.0))]
    run = simulate(Model({"nut": wheel(0.1)}, joints, loads, settings=settings(t_end=0.01)))
    np.testing.assert_allclose(run.joint("q").force[:, 2], force, rtol=1e-9)
    np.testing.assert_allclose(run.joint("q").moment[:, 2], 0.0, atol=1e-9)
    assert run.joint("q").multipliers[-1, 4] == pytest.approx(force)


def test_a_planetary_gear_by_three_coordinates():
    """z_s (q_s - q_c) + z_p q_p = 0 and the ring held: omega_s / omega_c = 1 + z_r / z_s."""
    bodies = {
        "sun": wheel(0.1),
        "carrier": RigidBody(1.0, [0.4, 0.4, 0.4], {"pin": Frame([0.2, 0.0, 0.0])}),
        "planet": wheel(0.02, 0.5, position=[0.2, 0.0, 0.0]),
    }
    joints = [
        Revolute("ground", "sun", [0, 0, 1], name="s"),
        Revolute("ground", "carrier", [0, 0, 1], name="c"),
        Revolute("carrier.pin", "planet", [0, 0, 1], name="p"),
    ]
    z_s, z_p, z_r = 20.0, 15.0, 50.0
    couplers = [
        Coupler("inner", "linear", ["s", "c", "p"], ratios=[z_s, -z_s, z_p]),
        Coupler("outer", "linear", ["p", "c"], ratios=[z_p, z_r]),
    ]
    loads = [Torque("sun", [0, 0, 1], Constant(TORQUE))]
    run = simulate(Model(bodies, joints, loads, couplers=couplers, settings=settings()))
    i = 1 + z_r / z_s
    s, c = run.joint("s").angle, run.joint("c").angle
    np.testing.assert_allclose(s, i * c, atol=1e-10)
    planet = 1 - z_r / z_p
    inertia = 0.1 + (0.4 + 0.5 * 0.2**2 + 0.02 * planet**2) / i**2
    np.testing.assert_allclose(s, 0.5 * TORQUE / inertia * run.time**2, atol=1e-8)


def test_the_error_of_a_gear_pendulum_is_of_second_order():
    """A pendulum geared to a flywheel, against a run of a finer step."""

    def end(step):
        bob = RigidBody(1.0, [0.1, 0.1, 0.1], {"eye": Frame([0.5, 0.0, 0.0])}, Start([-0.5, 0, 0]))
        model = Model(
            {"bob": bob, "fly": wheel(0.02, position=[1.0, 0.0, 0.0])},
            [
                Revolute("ground", "bob.eye", [0, 0, 1], name="p"),
                Revolute("ground", "fly", [0, 0, 1], name="q"),
            ],
            couplers=[Coupler("gear", "gear", ["p", "q"], teeth=[3, 1])],
            gravity=[0, -9.81, 0],
            settings=settings(step=step),
        )
        return simulate(model).joint("q").angle[-1]

    fine = end(2.5e-4)
    errors = [abs(end(step) - fine) for step in (8e-3, 4e-3)]
    assert 1.8 < np.log2(errors[0] / errors[1]) < 2.3


def test_a_coupler_that_follows_from_others_is_refused():
    more = [Coupler("again", "linear", ["p", "q"], ratios=[2.0, 5.0])]
    for redundant in ("error", "remove"):
        model = gears(more=more).with_settings(redundant=redundant)
        with pytest.raises(ModelError, match="coupler 'again': depends on other constraints"):
            simulate(model)


def test_a_coupler_of_driven_joints_is_refused():
    joints = [Revolute("ground", "a", [0, 0, 1], name="p", angle=Polynomial((0.0, 1.0)))]
    joints.append(Revolute("ground", "b", [0, 0, 1], name="q", angle=Constant(0.0)))
    model = gears()
    model = Model(model.bodies, joints, couplers=model.couplers, settings=settings())
    with pytest.raises(ModelError, match="is driven against other constraints"):
        simulate(model)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"teeth": None}, "a gear coupler takes teeth or radii, found none"),
        ({"radii": [1, 2]}, "takes teeth or radii, found teeth and radii"),
        ({"teeth": [1, 2, 3]}, "teeth: expected 2, as many as joints"),
        ({"teeth": [0, 2]}, "teeth: expected one or more numbers other than 0"),
    ],
)
def test_a_gear_needs_two_sizes(given, message):
    with pytest.raises(ModelError, match=message):
        gears(**given)


@pytest.mark.parametrize(
    ("joints", "message"),
    [
        (["p", "x"], "no joint 'x'; there are: p, q"),
        (["p", "q.distance"], "joint 'q' has angle, got 'q.distance'"),
        (["p", "p.angle"], "expected different ones"),
        (["p"], "a gear coupler takes two"),
    ],
)
def test_a_coupler_names_joints_with_coordinates(joints, message):
    model = gears()
    coupler = Coupler("odd", "linear", joints, ratios=[1.0] * len(joints))
    if len(joints) == 1:
        with pytest.raises(ModelError, match=message):
            Coupler("odd", "gear", joints, teeth=[1, 2])
        return
    with pytest.raises(ModelError, match=message):
        Model(model.bodies, model.joints, couplers=[coupler])


def test_a_rack_needs_an_angle_and_a_distance():
    model = gears()
    rack = Coupler("rack", "rack", ["p", "q"], radius=0.1)
    with pytest.raises(ModelError, match="'rack': joints: expected an angle and a distance"):
        Model(model.bodies, model.joints, couplers=[rack])
