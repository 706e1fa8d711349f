"""Prescribed motions, driven joints, and the coordinates and rates of joints."""

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    FlexibleBody,
    Frame,
    Harmonic,
    Joint,
    Load,
    Model,
    ModelError,
    Polynomial,
    PrescribedMotion,
    RigidBody,
    Start,
    simulate,
)
from scipy.spatial.transform import Rotation

SETTLING = 300
"""steps after which multipliers have forgotten the error, of the order of h, that a_0 = v_dot_0 gives their start"""
AXIS, SECOND = np.array([1.0, 2.0, 2.0]) / 3.0, np.array([2.0, -2.0, 1.0]) / 3.0


def samples(signal, t):
    """Values, rates and accelerations (3, n)."""
    return np.array([(signal(time), *signal.derivatives(time)) for time in t.tolist()]).T


def rate_of(values, h):
    """Central differences of order four, without two steps at either end."""
    return (8 * (values[3:-1] - values[1:-3]) - (values[4:] - values[:-4])) / (12 * h)


def test_a_slide_is_shaken():
    """The position is the signal to rounding; velocity, acceleration and force m s'' to order two."""
    m, shake, errors = 3.0, Harmonic(0.1, 3.0), []
    for h in (1e-3, 5e-4):
        results = simulate(
            Model(
                {"block": RigidBody(m, [0.1, 0.2, 0.3])},
                (Joint("rail", "prismatic", ("ground", "block"), AXIS),),
                motions=(PrescribedMotion("shake", "block", AXIS, shake),),
                t_end=1.0,
                step=h,
                rho_inf=0.9,
            )
        )
        s, rate, acceleration = samples(shake, results.time)
        np.testing.assert_allclose(results.body("block").x, np.outer(s, AXIS), rtol=0, atol=1e-14)
        np.testing.assert_allclose(results.joint("rail").coordinates["distance"], s, rtol=0, atol=1e-14)
        settled = results.time > SETTLING * 1e-3
        errors.append(
            [
                np.abs(results.joint("rail").coordinates["distance_rate"] - rate)[settled].max(),
                np.abs(results.joint("shake").force @ AXIS - m * acceleration)[settled].max(),
                np.abs(results.energy.balance).max(),
            ]
        )
        assert results.joint("shake").force[0] @ AXIS == pytest.approx(m * acceleration[0], abs=1e-12)
    orders = np.log2(np.array(errors[0]) / errors[1])
    assert (orders > 1.9).all(), (orders, errors)
    assert results.solver["velocity_correction"] == pytest.approx(0.1 * 6 * np.pi * np.abs(AXIS).max(), rel=1e-12)


def test_a_frame_off_the_centre_follows_a_path(random_element):
    """Three motions carry an interface of a flexible body along a path in space, while the body swings about it."""
    element = random_element(5, (True, False))
    path = (Harmonic(0.02, 2.0), Harmonic(-0.03, 3.0), Polynomial((0.0, 0.1, -0.3)))
    model = Model(
        {"body": FlexibleBody(element, Start([0.1, -0.2, 0.3], [0.3, 0.5, -0.2]))},
        motions=tuple(PrescribedMotion(f"m{k}", "body.i1", np.eye(3)[k], path[k]) for k in range(3)),
        gravity=[0, 0, -9.81],
        t_end=0.4,
        step=5e-4,
        rho_inf=0.8,
    )
    results = simulate(model)
    frame = results.frame("body.i1")
    expected = np.array([samples(signal, results.time)[0] for signal in path]).T
    np.testing.assert_allclose(frame.position - frame.position[0], expected, rtol=0, atol=1e-14)
    reaction = sum(results.joint(f"m{k}").force for k in range(3))
    np.testing.assert_allclose(frame.force[:, :3], reaction, rtol=0, atol=1e-9)
    balance = results.body("body").v_dot[:, :3] * element.mass - reaction
    np.testing.assert_allclose(balance, np.tile([0, 0, -9.81 * element.mass], (len(balance), 1)), rtol=0, atol=1e-7)


def test_a_driven_angle_of_several_turns():
    """Coordinates, rates and torque over 6 turns, from a start that is turned as given."""
    J, drive, h = 0.3, Polynomial((0.5, 10.0, 5.0)), 1e-3
    results = simulate(
        Model(
            {"disk": RigidBody(1.0, [0.1, 0.2, J])},
            (Joint("motor", "revolute", ("ground", "disk"), [0, 0, 1], angle=drive),),
            t_end=2.0,
            step=h,
            rho_inf=0.5,
        )
    )
    motor, (s, rate, acceleration) = results.joint("motor"), samples(drive, results.time)
    assert s[-1] > 6 * 2 * np.pi
    np.testing.assert_allclose(motor.coordinates["angle"], s, rtol=0, atol=1e-12)
    np.testing.assert_allclose(motor.coordinates["angle_rate"], rate, rtol=0, atol=1e-9)
    # the last digits of 30 rad, 7e-15, over h^2, through differences that add up to a hundred times them
    np.testing.assert_allclose(motor.moment[:, 2], J * acceleration, rtol=0, atol=100 * J * 7e-15 / h**2)
    assert results.solver["velocity_correction"] == pytest.approx(10.0, rel=1e-12)
    assert np.abs(results.energy.balance).max() < 1e-9 * results.energy.kinetic[-1]


def test_a_coordinate_that_is_watched_goes_on_over_full_turns():
    """A free disk of 40 rad/s, forwards and backwards: seen from either side the angle is omega t."""
    for speed in (40.0, -40.0):
        for between, sign in ((("ground", "disk"), 1.0), (("disk", "ground"), -1.0)):
            results = simulate(
                Model(
                    {"disk": RigidBody(1.0, [1, 1, 2], start=Start(angular_velocity=[0, 0, speed]))},
                    (Joint("axle", "revolute", between, [0, 0, 1]),),
                    t_end=1.0,
                    step=1e-3,
                )
            )
            angle = results.joint("axle").coordinates
            np.testing.assert_allclose(angle["angle"], sign * speed * results.time, rtol=0, atol=1e-11)
            np.testing.assert_allclose(angle["angle_rate"], sign * speed, rtol=1e-11)


COORDINATES = {
    "revolute": ({"axis": AXIS}, ["angle"]),
    "universal": ({"axis": AXIS, "second_axis": SECOND}, ["angle", "second_angle"]),
    "cylindrical": ({"axis": AXIS}, ["angle", "distance"]),
    "prismatic": ({"axis": AXIS}, ["distance"]),
    "planar": ({"axis": AXIS}, ["angle", "distance", "second_distance"]),
}


def moving(name, element, h):
    """A flexible body and a rigid one on a joint, both free, under loads."""
    axes, _ = COORDINATES[name]
    a = FlexibleBody(element, Start(-element.interface("i0").X, angular_velocity=[0.5, 1.0, -0.5]))
    b = RigidBody(2.0, [2.0, 1.0, 1.5], {"g": Frame([-0.2, 0.4, 0.1], [0.3, 0.1, 0.2])}, Start([0.2, -0.4, -0.1]))
    loads = (
        Load("force", "b", [3.0, -2.0, 5.0], Harmonic(1.0, 2.0, 1.0)),
        Load("torque", "b", [6.0, 9.0, -5.0], Constant(1.0)),
        Load("force", "a.i1", [1.0, 0.5, 1.0], Harmonic(5.0, 3.0)),
    )
    return simulate(
        Model({"a": a, "b": b}, (Joint("joint", name, ("a.i0", "b.g"), **axes),), loads, t_end=0.4, step=h, rho_inf=0.7)
    )


@pytest.mark.parametrize("name", COORDINATES)
def test_joint_coordinates_and_their_rates(random_element, name):
    """Coordinates as the frames have them; rates their derivatives in time, to order two; 0 at the start."""
    axes, coordinates = COORDINATES[name]
    element, errors = random_element(5, (True, False), omega=(20.0, 100.0)), []
    for h in (1e-3, 5e-4):
        results = moving(name, element, h)
        found = results.joint("joint").coordinates
        assert set(found) == {key for name in coordinates for key in (name, f"{name}_rate")}
        errors.append([np.abs(rate_of(found[c], h) - found[f"{c}_rate"][2:-2]).max() for c in coordinates])
        for c in coordinates:
            assert found[c][0] == pytest.approx(0.0, abs=1e-15)
            assert np.abs(found[c]).max() > 1e-2
    orders = np.log2(np.array(errors[0]) / errors[1])
    assert (orders > 1.9).all(), (orders, errors)
    A, B = results.frame("a.i0"), results.frame("b.g")
    turns = [Rotation.from_quat(frame.rotation, scalar_first=True) for frame in (A, B)]
    basis = Joint("joint", name, ("a", "b"), **axes).basis()
    e_a, e_b = ((turn * turn[0].inv()).as_matrix() @ basis for turn in turns)
    gap = np.einsum("tik,ti->tk", e_a, B.position - A.position)
    relative = np.einsum("tik,tij->tkj", e_a, e_b)
    expected = {
        "revolute": {"angle": np.arctan2(relative[:, 1, 0], relative[:, 0, 0])},
        "cylindrical": {"angle": np.arctan2(relative[:, 1, 0], relative[:, 0, 0]), "distance": gap[:, 2]},
        "prismatic": {"distance": gap[:, 2]},
        "planar": {
            "angle": np.arctan2(relative[:, 1, 0], relative[:, 0, 0]),
            "distance": gap[:, 0],
            "second_distance": gap[:, 1],
        },
        # the cross turns about e_1 of A by the first angle, then B about e_2 of the cross by the second
        "universal": {
            "angle": np.arctan2(relative[:, 2, 1], relative[:, 1, 1]),
            "second_angle": np.arctan2(relative[:, 0, 2], relative[:, 0, 0]),
        },
    }[name]
    for key, values in expected.items():
        np.testing.assert_allclose(np.exp(1j * found[key]), np.exp(1j * values), rtol=0, atol=1e-12)


def test_a_driven_cylindrical_joint_screws():
    """Both drives at once: a helix."""
    turn, rise, h = Polynomial((0.2, 6.0, 3.0)), Harmonic(0.1, 1.0), 1e-3
    body = RigidBody(2.0, [1.0, 1.5, 0.8], {"grip": Frame([0.3, 0, 0])}, Start([-0.3, 0, 0]))
    joint = Joint("screw", "cylindrical", ("ground", "body.grip"), [0, 0, 1], angle=turn, distance=rise)
    results = simulate(Model({"body": body}, (joint,), t_end=1.0, step=h, rho_inf=0.9))
    screw = results.joint("screw").coordinates
    np.testing.assert_allclose(screw["angle"], samples(turn, results.time)[0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(screw["distance"], samples(rise, results.time)[0], rtol=0, atol=1e-13)
    phase = screw["angle"] - screw["angle"][0]
    expected = -0.3 * np.column_stack([np.cos(phase), np.sin(phase)])
    np.testing.assert_allclose(results.body("body").x[:, :2], expected, rtol=0, atol=1e-12)


def test_a_motion_that_starts_elsewhere_is_refused():
    with pytest.raises(ModelError, match=r"motion 'shake': displacement: expected 0 at t = 0, got 0.5"):
        PrescribedMotion("shake", "body", [1, 0, 0], Constant(0.5))
