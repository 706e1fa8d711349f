"""Prescribed motions, driven joints, and the coordinates and rates of joints."""

import numpy as np
import pytest
from duhamel.solver import (
    JOINTS,
    Constant,
    Cylindrical,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Harmonic,
    Model,
    ModelError,
    Polynomial,
    PrescribedDisplacement,
    PrescribedRotation,
    Prismatic,
    Revolute,
    RigidBody,
    Settings,
    Start,
    Torque,
    read_model,
    simulate,
)
from scipy.spatial.transform import Rotation

from .models import model_of

SETTLING = 300
"""steps after which multipliers have forgotten the error, of the order of h, that a_0 = v_dot_0
gives their start
"""
AXIS, SECOND = np.array([1.0, 2.0, 2.0]) / 3.0, np.array([2.0, -2.0, 1.0]) / 3.0


def samples(signal, t):
    """Values, rates and accelerations (3, n)."""
    return np.array([(signal(time), *signal.derivatives(time)) for time in t.tolist()]).T


def rate_of(values, h):
    """Central differences of order four, without two steps at either end."""
    return (8 * (values[3:-1] - values[1:-3]) - (values[4:] - values[:-4])) / (12 * h)


def test_a_slide_is_shaken():
    """The position is the signal to rounding; velocity, acceleration and force m s'' to
    order two.
    """
    m, shake, errors = 3.0, Harmonic(0.1, 3.0), []
    for h in (1e-3, 5e-4):
        results = simulate(
            Model(
                {"block": RigidBody(m, [0.1, 0.2, 0.3])},
                (Prismatic("ground", "block", AXIS, name="rail"),),
                motions=(PrescribedDisplacement("shake", "block", AXIS, shake),),
                settings=Settings(t_end=1.0, step=h, rho_inf=0.9),
            )
        )
        s, rate, acceleration = samples(shake, results.time)
        np.testing.assert_allclose(results.body("block").x, np.outer(s, AXIS), rtol=0, atol=1e-14)
        np.testing.assert_allclose(
            results.joint("rail").coordinates["distance"], s, rtol=0, atol=1e-14
        )
        settled = results.time > SETTLING * 1e-3
        errors.append(
            [
                np.abs(results.joint("rail").coordinates["distance_rate"] - rate)[settled].max(),
                np.abs(results.joint("shake").force @ AXIS - m * acceleration)[settled].max(),
                np.abs(results.energy.balance).max(),
            ]
        )
        assert results.joint("shake").force[0] @ AXIS == pytest.approx(
            m * acceleration[0], abs=1e-12
        )
    orders = np.log2(np.array(errors[0]) / errors[1])
    assert (orders > 1.9).all(), (orders, errors)
    assert results.solver["velocity_correction"] == pytest.approx(
        0.1 * 6 * np.pi * np.abs(AXIS).max(), rel=1e-12
    )


def test_a_frame_off_the_center_follows_a_path(random_element):
    """Three motions carry an interface of a flexible body along a path in space, while the body
    swings about it.
    """
    element = random_element(5, (True, False))
    path = (Harmonic(0.02, 2.0), Harmonic(-0.03, 3.0), Polynomial((0.0, 0.1, -0.3)))
    model = Model(
        {"body": FlexibleBody(element, Start([0.1, -0.2, 0.3], [0.3, 0.5, -0.2]))},
        motions=tuple(
            PrescribedDisplacement(f"m{k}", "body.i1", np.eye(3)[k], path[k]) for k in range(3)
        ),
        gravity=[0, 0, -9.81],
        settings=Settings(t_end=0.4, step=5e-4, rho_inf=0.8),
    )
    results = simulate(model)
    frame = results.frame("body.i1")
    expected = np.array([samples(signal, results.time)[0] for signal in path]).T
    np.testing.assert_allclose(frame.position - frame.position[0], expected, rtol=0, atol=1e-14)
    reaction = sum(results.joint(f"m{k}").force for k in range(3))
    np.testing.assert_allclose(frame.force[:, :3], reaction, rtol=0, atol=1e-9)
    balance = results.body("body").v_dot[:, :3] * element.mass - reaction
    np.testing.assert_allclose(
        balance, np.tile([0, 0, -9.81 * element.mass], (len(balance), 1)), rtol=0, atol=1e-7
    )


def test_a_driven_angle_of_several_turns():
    """Coordinates, rates and torque over 6 turns, from a start that is turned as given."""
    J, drive, h = 0.3, Polynomial((0.5, 10.0, 5.0)), 1e-3
    results = simulate(
        Model(
            {"disk": RigidBody(1.0, [0.1, 0.2, J])},
            (Revolute("ground", "disk", [0, 0, 1], name="motor", angle=drive),),
            settings=Settings(t_end=2.0, step=h, rho_inf=0.5),
        )
    )
    motor, (s, rate, acceleration) = results.joint("motor"), samples(drive, results.time)
    assert s[-1] > 6 * 2 * np.pi
    np.testing.assert_allclose(motor.coordinates["angle"], s, rtol=0, atol=1e-12)
    np.testing.assert_allclose(motor.coordinates["angle_rate"], rate, rtol=0, atol=1e-9)
    # the last digits of 30 rad, 7e-15, over h^2, through differences that add up to a hundred times
    # them
    np.testing.assert_allclose(
        motor.moment[:, 2], J * acceleration, rtol=0, atol=100 * J * 7e-15 / h**2
    )
    assert results.solver["velocity_correction"] == pytest.approx(10.0, rel=1e-12)
    assert np.abs(results.energy.balance).max() < 1e-9 * results.energy.kinetic[-1]


def test_a_coordinate_that_is_watched_goes_on_over_full_turns():
    """A free disk of 40 rad/s, forwards and backwards: seen from either side the angle is
    omega t.
    """
    for speed in (40.0, -40.0):
        for between, sign in ((("ground", "disk"), 1.0), (("disk", "ground"), -1.0)):
            results = simulate(
                Model(
                    {
                        "disk": RigidBody(
                            1.0, [1, 1, 2], start=Start(angular_velocity=[0, 0, speed])
                        )
                    },
                    (Revolute(*between, [0, 0, 1], name="axle"),),
                    settings=Settings(t_end=1.0, step=1e-3),
                )
            )
            angle = results.joint("axle").coordinates
            np.testing.assert_allclose(
                angle["angle"], sign * speed * results.time, rtol=0, atol=1e-11
            )
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
    b = RigidBody(
        2.0,
        [2.0, 1.0, 1.5],
        {"g": Frame([-0.2, 0.4, 0.1], [0.3, 0.1, 0.2])},
        Start([0.2, -0.4, -0.1]),
    )
    loads = (
        Force("b", [3.0, -2.0, 5.0], Harmonic(1.0, 2.0, 1.0)),
        Torque("b", [6.0, 9.0, -5.0], Constant(1.0)),
        Force("a.i1", [1.0, 0.5, 1.0], Harmonic(5.0, 3.0)),
    )
    return simulate(
        Model(
            {"a": a, "b": b},
            (JOINTS[name]("a.i0", "b.g", name="joint", **axes),),
            loads,
            settings=Settings(t_end=0.4, step=h, rho_inf=0.7),
        )
    )


@pytest.mark.parametrize("name", COORDINATES)
def test_joint_coordinates_and_their_rates(random_element, name):
    """Coordinates as the frames have them; rates their derivatives in time, to order two; 0 at the
    start.
    """
    axes, coordinates = COORDINATES[name]
    element, errors = random_element(5, (True, False), omega=(20.0, 100.0)), []
    for h in (1e-3, 5e-4):
        results = moving(name, element, h)
        found = results.joint("joint").coordinates
        assert set(found) == {key for name in coordinates for key in (name, f"{name}_rate")}
        errors.append(
            [np.abs(rate_of(found[c], h) - found[f"{c}_rate"][2:-2]).max() for c in coordinates]
        )
        for c in coordinates:
            assert found[c][0] == pytest.approx(0.0, abs=1e-15)
            assert np.abs(found[c]).max() > 1e-2
    orders = np.log2(np.array(errors[0]) / errors[1])
    assert (orders > 1.9).all(), (orders, errors)
    A, B = results.frame("a.i0"), results.frame("b.g")
    turns = [Rotation.from_quat(frame.rotation, scalar_first=True) for frame in (A, B)]
    basis = JOINTS[name]("a", "b", name="joint", **axes).basis(turns[0][0].as_matrix())
    e_a, e_b = ((turn * turn[0].inv()).as_matrix() @ basis for turn in turns)
    gap = np.einsum("tik,ti->tk", e_a, B.position - A.position)
    relative = np.einsum("tik,tij->tkj", e_a, e_b)
    expected = {
        "revolute": {"angle": np.arctan2(relative[:, 1, 0], relative[:, 0, 0])},
        "cylindrical": {
            "angle": np.arctan2(relative[:, 1, 0], relative[:, 0, 0]),
            "distance": gap[:, 2],
        },
        "prismatic": {"distance": gap[:, 2]},
        "planar": {
            "angle": np.arctan2(relative[:, 1, 0], relative[:, 0, 0]),
            "distance": gap[:, 0],
            "second_distance": gap[:, 1],
        },
        # the cross turns about e_1 of A by the first angle, then B about e_2 of the cross by the
        # second
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
    joint = Cylindrical("ground", "body.grip", [0, 0, 1], name="screw", angle=turn, distance=rise)
    results = simulate(
        Model({"body": body}, (joint,), settings=Settings(t_end=1.0, step=h, rho_inf=0.9))
    )
    screw = results.joint("screw").coordinates
    np.testing.assert_allclose(screw["angle"], samples(turn, results.time)[0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(
        screw["distance"], samples(rise, results.time)[0], rtol=0, atol=1e-13
    )
    phase = screw["angle"] - screw["angle"][0]
    expected = -0.3 * np.column_stack([np.cos(phase), np.sin(phase)])
    np.testing.assert_allclose(results.body("body").x[:, :2], expected, rtol=0, atol=1e-12)


def test_a_body_turned_about_a_fixed_axis():
    """The attitude is exp(angle n~) R_0 to rounding, beyond full turns; the moment is Euler's, to
    order two.
    """
    J, angle, errors = np.diag([0.2, 0.5, 0.4]), Harmonic(8.0, 0.6), []
    start = Start([0.3, 0.1, -0.2], [0.4, -0.3, 0.6], velocity=[1.0, 0.0, 0.0])
    for h in (2e-3, 1e-3):
        results = simulate(
            Model(
                {"body": RigidBody(2.0, J, start=start)},
                motions=(PrescribedRotation("spin", "body", AXIS, angle),),
                settings=Settings(t_end=1.5, step=h, rho_inf=0.5),
            )
        )
        body, (s, rate, acceleration) = results.body("body"), samples(angle, results.time)
        assert s.max() > 2 * np.pi
        R = (
            Rotation.from_rotvec(np.outer(s, AXIS)) * Rotation.from_rotvec(start.rotation)
        ).as_matrix()
        found = Rotation.from_quat(body.R, scalar_first=True).as_matrix()
        np.testing.assert_allclose(found, R, rtol=0, atol=1e-12)
        np.testing.assert_allclose(
            body.x, start.position + np.outer(results.time, [1.0, 0, 0]), rtol=0, atol=1e-12
        )
        n = R[0].T @ AXIS
        euler = np.outer(acceleration, J @ n) + np.outer(rate**2, np.cross(n, J @ n))
        moment = np.einsum("tji,tj->ti", R, results.joint("spin").moment)
        errors.append(np.abs(moment - euler)[results.time > 0.6].max() / np.abs(euler).max())
    assert np.log2(errors[0] / errors[1]) > 1.9, errors
    assert errors[1] < 1e-4


def test_a_frame_whose_whole_motion_is_given_moves_as_one_on_a_driven_table(random_element):
    """A flexible body held by a turning interface: prescribed, or fixed to a table on a driven
    pivot.
    """
    element, angle = random_element(5, (True, False), omega=(50.0, 400.0)), Harmonic(0.3, 10.0)
    beam = FlexibleBody(element, Start([0.1, -0.2, 0.3], [0.3, 0.5, -0.2]))
    common = {
        "t_end": 0.15,
        "step": 5e-4,
        "rho_inf": 0.9,
        "gravity": [0, 0, -9.81],
        "tolerance": 1e-12,
    }
    held = [
        PrescribedDisplacement(f"m{k}", "beam.i0", np.eye(3)[k], Constant(0.0)) for k in range(3)
    ]
    given = simulate(
        model_of(
            {"beam": beam},
            motions=(*held, PrescribedRotation("turn", "beam.i0", AXIS, angle)),
            **common,
        )
    )
    at = given.frame("beam.i0").position[0]
    table = RigidBody(5.0, [1.0, 2.0, 3.0], start=Start(at))
    joints = (
        Revolute("ground", "table", AXIS, name="pivot", angle=angle),
        Fixed("table", "beam.i0", name="weld"),
    )
    driven = simulate(model_of({"table": table, "beam": beam}, joints, **common))
    np.testing.assert_allclose(given.body("beam").x, driven.body("beam").x, rtol=0, atol=1e-11)
    np.testing.assert_allclose(
        given.frame("beam.i1").u, driven.frame("beam.i1").u, rtol=0, atol=1e-11
    )
    wrench = driven.frame("beam.i0").force
    np.testing.assert_allclose(
        given.frame("beam.i0").force, wrench, rtol=0, atol=1e-9 * np.abs(wrench).max()
    )
    assert np.abs(given.energy.balance).max() == pytest.approx(
        np.abs(driven.energy.balance).max(), rel=0.5
    )


def test_a_turning_interface_needs_rotations(random_element):
    element = random_element(5, (True, False))
    motion = PrescribedRotation("turn", "beam.i1", AXIS, Constant(0.0))
    with pytest.raises(
        ModelError, match=r"motion 'turn': interface 'beam.i1' has no rotations and carries forces"
    ):
        simulate(
            Model({"beam": FlexibleBody(element)}, motions=(motion,), settings=Settings(t_end=0.01))
        )


def test_motions_from_a_model_file(tmp_path):
    path = tmp_path / "table.toml"
    path.write_text("""
        [simulation]
        t_end = 0.2
        step = 1e-3
        [bodies.table]
        mass = 1.0
        inertia = [1.0, 1.0, 1.0]
        [bodies.wheel]
        mass = 1.0
        inertia = [1.0, 1.0, 1.0]
        [[joints]]
        name = "axle"
        type = "revolute"
        between = ["ground", "wheel"]
        axis = [0, 0, 1]
        start = {angle = 0.5, angle_rate = 2.0}
        [[motions]]
        name = "shake"
        on = "table"
        direction = [1, 0, 0]
        displacement = {polynomial = [0, 2]}
        [[motions]]
        name = "turn"
        on = "table"
        axis = [0, 1, 0]
        angle = {polynomial = [0, 3]}
    """)
    results = simulate(read_model(path))
    table, axle = results.body("table"), results.joint("axle").coordinates
    np.testing.assert_allclose(table.x[:, 0], 2.0 * results.time, rtol=0, atol=1e-13)
    np.testing.assert_allclose(table.v[:, 4], 3.0, rtol=1e-10)
    np.testing.assert_allclose(axle["angle"], 0.5 + 2.0 * results.time, rtol=0, atol=1e-12)

    path.write_text(path.read_text().replace("angle = {polynomial", "displacement = {polynomial"))
    with pytest.raises(
        ModelError,
        match=r"motion 'turn': expected direction and displacement, or axis and angle, fo",
    ):
        read_model(path)


def test_a_motion_that_starts_elsewhere_is_refused():
    with pytest.raises(ModelError, match=r"motion 'turn': angle: expected 0 at t = 0, got 0.5"):
        PrescribedRotation("turn", "body", [1, 0, 0], Constant(0.5))
    with pytest.raises(
        ModelError,
        match=r"motion 'shake': displacement: .* got 0.5: .*add an offset of -0.5",
    ):
        PrescribedDisplacement("shake", "body", [1, 0, 0], Constant(0.5))
