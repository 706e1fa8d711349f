"""Rods, points on lines and planes, shafts at an angle, attitudes, zeros and names."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    ConstantVelocity,
    Coupler,
    Cylindrical,
    Frame,
    Harmonic,
    Impulse,
    Input,
    Model,
    ModelError,
    OutOfRangeError,
    Place,
    PointOnLine,
    PointOnPlane,
    Polynomial,
    Revolute,
    RigidBody,
    Rod,
    Screw,
    Settings,
    Simulator,
    SmoothFunction,
    Spherical,
    Spring,
    Start,
    Steps,
    Torque,
    Universal,
    read_model,
    simulate,
    write_model,
)
from duhamel.solver.signals.attitude import Attitude
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

G = 9.81
FAR = np.array([1000.0, -2000.0, 500.0])
TURN = Rotation.from_rotvec([0.3, -0.5, 0.7])


def settings(**given):
    return Settings(**{"t_end": 1.0, "step": 1e-3} | given)


def stone(mass=2.0, J=0.1, **start):
    return RigidBody(mass, [J, J, J], start=Start(**start))


@pytest.mark.parametrize("origin", [np.zeros(3), FAR], ids=["near", "far"])
def test_a_stone_on_a_rod_swings_as_a_pendulum(origin):
    L, turn = 0.7, TURN.as_matrix()
    body = stone(position=origin + turn @ [L, 0, 0])
    model = Model(
        {"stone": body},
        [Rod("ground.pin", "stone", name="rod")],
        ground_frames={"pin": Frame(origin)},
        gravity=turn @ [0, -G, 0],
        settings=settings(step=5e-4),
    )
    run = simulate(model)
    swing = solve_ivp(
        lambda t, y: [y[1], -G / L * np.cos(y[0])],
        (0, 1),
        [0.0, 0.0],
        t_eval=run.time,
        rtol=1e-10,
        atol=1e-12,
    )
    angle, rate = swing.y
    expected = L * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    np.testing.assert_allclose((run.body("stone").x - origin) @ turn, expected, atol=4e-6)
    pull = 2.0 * (L * rate**2 - G * np.sin(angle))
    np.testing.assert_allclose(-run.joint("rod").multipliers[:, 0], pull, atol=1e-3)
    assert run.solver["degrees_of_freedom"] == 5
    assert np.abs(run.energy.balance).max() < 1e-4


def test_a_rod_that_shortens_speeds_up_as_a_skater_does():
    """r^2 omega stays, and the drive does the work m (v^2 - v_0^2) / 2."""
    L, v = 1.0, 0.5
    length = Polynomial((L, 0.0, -0.3))
    model = Model(
        {"stone": stone(position=[L, 0, 0], velocity=[0, v, 0])},
        [Rod("ground.pin", "stone", name="rod", distance=length)],
        ground_frames={"pin": Frame()},
        settings=settings(),
    )
    run = simulate(model)
    x, velocity = run.body("stone").x, run.body("stone").v[:, :3]
    r = L - 0.3 * run.time**2
    np.testing.assert_allclose(np.linalg.norm(x, axis=1), r, atol=1e-12)
    np.testing.assert_allclose(np.cross(x, velocity)[:, 2], L * v, rtol=1e-6)
    work = 0.5 * 2.0 * ((velocity**2).sum(1) - v**2)
    np.testing.assert_allclose(run.energy.work, work, atol=1e-5)


def test_a_rod_needs_ends_that_are_apart():
    joints = [Rod("ground", "stone", name="rod")]
    model = Model({"stone": stone()}, joints, settings=settings())
    with pytest.raises(ModelError, match=r"joint 'rod': its ends .* coincide"):
        simulate(model)


def test_a_rod_of_another_length_than_drawn_is_assembled_if_asked_for():
    joint = Rod("ground.pin", "stone", name="rod", distance=Constant(0.5))
    model = Model(
        {"stone": stone(position=[0.8, 0, 0])},
        [joint],
        ground_frames={"pin": Frame()},
        settings=settings(t_end=0.01),
    )
    with pytest.raises(ModelError, match="joint 'rod': open by 0"):
        simulate(model)
    run = simulate(model.with_settings(assemble=True))
    np.testing.assert_allclose(run.body("stone").x[0], [0.5, 0, 0], atol=1e-12)


def test_a_bead_on_a_turning_line_flies_outwards():
    """r = r_0 cosh(omega t), pushed by 2 m omega r' across the line."""
    omega, r_0, m = 3.0, 0.2, 2.0
    turn = TURN.as_matrix()
    arm = RigidBody(1.0, [0.1, 0.1, 0.1], {"slot": Frame(turn.T @ [0, 0, 0])})
    model = Model(
        {"arm": arm, "bead": stone(m, position=r_0 * turn[:, 0])},
        [
            Revolute("ground", "arm", turn[:, 2], name="axle", angle=Polynomial((0, omega))),
            PointOnLine("arm.slot", "bead", turn[:, 0], name="line"),
        ],
        settings=settings(t_end=0.8, rho_inf=0.3),
    )
    run = simulate(model)
    r = r_0 * np.cosh(omega * run.time)
    np.testing.assert_allclose(run.joint("line").distance, r, rtol=2e-5)
    coriolis = 2 * m * omega * r_0 * omega * np.sinh(omega * run.time)
    force = np.linalg.norm(run.joint("line").force, axis=1)
    np.testing.assert_allclose(force[50:], coriolis[50:], rtol=1e-4)
    assert run.solver["degrees_of_freedom"] == 4


def test_a_ball_slides_down_a_plane():
    tilt = 0.4
    normal = np.array([np.sin(tilt), 0.0, np.cos(tilt)])
    model = Model(
        {"ball": stone(position=FAR + np.cross(normal, [0, 1, 0]))},
        [PointOnPlane("ground.slope", "ball", normal, name="plane")],
        ground_frames={"slope": Frame(FAR)},
        gravity=[0, 0, -G],
        settings=settings(),
    )
    run = simulate(model)
    moved = np.linalg.norm(run.body("ball").x - run.body("ball").x[0], axis=1)
    np.testing.assert_allclose(moved, 0.5 * G * np.sin(tilt) * run.time**2, atol=1e-8)
    force = run.joint("plane").force
    np.testing.assert_allclose(force @ normal, 2.0 * G * np.cos(tilt), rtol=1e-5)
    assert run.solver["degrees_of_freedom"] == 5


def shafts(joint, bend=0.6):
    """Two shafts on the ground at an angle, the first turned at a constant rate."""
    u, v = np.array([1.0, 0, 0]), np.array([np.cos(bend), np.sin(bend), 0])
    z = np.array([0, 0, 1.0])
    between = ["first.end", "second.end"]
    middle = {
        "universal": Universal(*between, z, np.cross(v, z), name="middle"),
        "constant_velocity": ConstantVelocity(*between, u, v, name="middle"),
    }[joint]
    inertia = [0.2, 0.2, 0.2]
    bodies = {
        "first": RigidBody(1.0, inertia, {"end": Frame(0.5 * u)}, Start(-0.5 * u)),
        "second": RigidBody(1.0, inertia, {"end": Frame(-0.5 * v)}, Start(0.5 * v)),
    }
    joints = [
        Revolute("ground", "first", u, name="in", angle=Polynomial((0.0, 10.0))),
        Revolute("ground", "second", v, name="out"),
        middle,
    ]
    return simulate(Model(bodies, joints, settings=settings(redundant="remove")))


def test_a_universal_joint_turns_unevenly():
    """tan(out) = tan(in) cos(bend) where the cross is first across the plane of the shafts."""
    run, bend = shafts("universal"), 0.6
    turned, out = run.joint("in").angle, run.joint("out").angle
    error = np.sin(out) * np.cos(turned) * np.cos(bend) - np.sin(turned) * np.cos(out)
    other = np.sin(out) * np.cos(turned) - np.sin(turned) * np.cos(out) * np.cos(bend)
    assert min(np.abs(error).max(), np.abs(other).max()) < 1e-9
    assert np.abs(out - turned).max() > 0.08


def test_a_constant_velocity_joint_turns_evenly_over_full_turns():
    run = shafts("constant_velocity")
    np.testing.assert_allclose(run.joint("out").angle, run.joint("in").angle, atol=1e-9)
    assert run.joint("out").angle[-1] > 3 * np.pi


def test_a_constant_velocity_joint_takes_no_shafts_against_each_other():
    with pytest.raises(ModelError, match="second_axis: the shafts"):
        ConstantVelocity("ground", "b", [1, 0, 0], [-1, 0.1, 0], name="j")


@pytest.mark.parametrize("torque", [0.0, 500.0])
def test_a_constant_velocity_joint_that_takes_the_wrong_branch_stops_the_run(torque):
    """A torque about the first shaft while the bend goes through 180 degrees; without it, the joint
    comes through on its own branch, on which it does not twist.
    """
    bend, start, end = 2.5, 0.6, 1.4
    body = RigidBody(1.0, [0.3, 0.2, 0.4], start=Start(angular_velocity=[0, 0, 1.0]))
    shaft = [np.cos(bend), np.sin(bend), 0]
    joint = ConstantVelocity("ground", "b", [1, 0, 0], shaft, name="bent")
    twist = Torque("b", [1, 0, 0], Steps((0.0, start), (0.0, torque)))
    model = Model(
        {"b": body}, [joint], [twist], settings=Settings(t_end=end, step=1e-3, rho_inf=0.5)
    )
    if torque:
        with pytest.raises(OutOfRangeError, match="joint 'bent': its shafts have passed 180 degre"):
            simulate(model)
    else:
        q = simulate(model).body("b").R[-1]
        assert bend + end > np.pi
        np.testing.assert_allclose(np.abs(q), np.abs([np.cos(0.7), 0, 0, np.sin(0.7)]), atol=1e-9)


def stepped(model):
    with Simulator(model, []) as simulator:
        while simulator.time < model.settings.t_end - 1e-9:
            simulator.step([])


@pytest.mark.parametrize("steps", [simulate, stepped])
def test_a_joint_on_the_wrong_branch_stops_the_run_before_it_fails_there(steps):
    """Newton's method does so at 1.165 s."""
    shaft = [np.cos(2.5), np.sin(2.5), 0]
    body = RigidBody(1.0, [0.3, 0.2, 0.4], start=Start(angular_velocity=[0, 0, 1.0]))
    loads = [
        Torque("b", [1, 0, 0], Steps((0.0, 0.6), (0.0, 500.0))),
        Torque("b", [0, 0, 1], Impulse(-1.0, 0.7)),
    ]
    joint = ConstantVelocity("ground", "b", [1, 0, 0], shaft, name="bent")
    model = Model({"b": body}, [joint], loads, settings=Settings(t_end=1.2, step=1e-3, rho_inf=0.5))
    with pytest.raises(OutOfRangeError, match="joint 'bent': its shafts have passed 180 degre"):
        steps(model)


def differences(f, t, h=1e-3):
    """First and second derivative of a function of time, of fourth order."""
    at = {k: f(t + k * h) for k in range(-2, 3)}
    first = (8 * (at[1] - at[-1]) - (at[2] - at[-2])) / (12 * h)
    second = (16 * (at[1] + at[-1]) - (at[2] + at[-2]) - 30 * at[0]) / (12 * h**2)
    return first, second


@pytest.mark.parametrize("size", [1.5, 1e-3, 0.05, 0.0])
@pytest.mark.parametrize("form", ["vector", "angles"])
def test_the_derivatives_of_an_attitude(form, size):
    signals = tuple(Harmonic(size, f, phase, 0.3 * size) for f, phase in ((1, 0), (2, 1), (0.5, 2)))
    attitude = Attitude(signals, form)
    R, rate, acceleration = attitude.rotation(0.37)
    first, second = differences(lambda t: attitude.rotation(t)[0], 0.37)
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-13)
    np.testing.assert_allclose(rate, first, atol=1e-6)
    np.testing.assert_allclose(acceleration, second, atol=1e-4)
    values = np.array([signal(0.37) for signal in signals])
    known = Rotation.from_rotvec(values) if form == "vector" else Rotation.from_euler("XYZ", values)
    np.testing.assert_allclose(R, known.as_matrix(), atol=1e-13)
    np.testing.assert_allclose(attitude.rotations(np.array([0.1, 0.37]))[1], R, atol=1e-13)


@pytest.mark.parametrize("tilt", [0.5, 2.0])
def test_a_body_on_a_driven_ball_joint_cones(tilt):
    """Of R = R_z(phi) R_y(tilt) R_z(-phi): M = phi'^2 (C (cos - 1) - A cos) e_z x c, c = R e_z."""
    A, C, f = 0.3, 0.4, 1.0
    rate = 2 * np.pi * f
    turn = TURN
    joint = Spherical(
        "ground.post",
        "top",
        name="ball",
        rotation_vector=[Harmonic(-tilt, f), Harmonic(tilt, f, np.pi / 2), Constant(0.0)],
    )
    post = Frame(FAR, turn.as_rotvec())
    start = turn * Rotation.from_rotvec([0.0, tilt, 0.0])
    top = RigidBody(1.0, [A, A, C], start=Start(FAR, start.as_rotvec()))
    model = Model({"top": top}, [joint], ground_frames={"post": post})
    run = simulate(model, settings(rho_inf=0.3))
    phi = rate * run.time
    axis = np.stack(
        [np.sin(tilt) * np.cos(phi), np.sin(tilt) * np.sin(phi), np.cos(tilt) + 0 * phi], 1
    )
    R = Rotation.from_quat(run.body("top").R, scalar_first=True)
    np.testing.assert_allclose(R.apply([0, 0, 1.0]), turn.apply(axis), atol=1e-9)
    size = rate**2 * (C * (np.cos(tilt) - 1) - A * np.cos(tilt))
    moment = turn.apply(size * np.cross([0, 0, 1.0], axis))
    np.testing.assert_allclose(run.joint("ball").moment[50:], moment[50:], atol=1e-4 * abs(size))
    assert run.solver["degrees_of_freedom"] == 0


def test_cardan_angles_turn_about_new_axes():
    angles = [Polynomial((0.0, 1.0)), Polynomial((0.0, 2.0)), Polynomial((0.0, -1.0))]
    joint = Spherical("ground", "b", name="ball", cardan_angles=angles)
    run = simulate(Model({"b": stone()}, [joint], settings=settings()))
    values = np.outer(run.time, [1.0, 2.0, -1.0])
    expected = Rotation.from_euler("XYZ", values)
    R = Rotation.from_quat(run.body("b").R, scalar_first=True)
    assert (R * expected.inv()).magnitude().max() < 1e-9
    kinetic = run.energy.kinetic
    np.testing.assert_allclose(run.energy.work, kinetic - kinetic[0], atol=1e-5)


def test_a_universal_joint_follows_two_angles():
    """R = R_x(a) R_y(b), with no pose in which it could not."""
    first, second = Harmonic(3.0, 0.7), Polynomial((0.0, 4.0))
    joint = Universal(
        "ground", "b", [1, 0, 0], [0, 1, 0], name="u", angle=first, second_angle=second
    )
    run = simulate(Model({"b": stone()}, [joint], settings=settings()))
    a, b = run.joint("u").angle, run.joint("u").second_angle
    np.testing.assert_allclose(a, 3.0 * np.sin(2 * np.pi * 0.7 * run.time), atol=1e-9)
    np.testing.assert_allclose(b, 4.0 * run.time, atol=1e-9)
    R = Rotation.from_quat(run.body("b").R, scalar_first=True)
    expected = Rotation.from_euler("XY", np.stack([a, b], 1))
    assert (R * expected.inv()).magnitude().max() < 1e-9
    kinetic = run.energy.kinetic
    np.testing.assert_allclose(run.energy.work, kinetic - kinetic[0], atol=1e-3)


def test_a_spherical_joint_follows_one_kind_of_signals():
    three = [Constant(0.0)] * 3
    with pytest.raises(ModelError, match="rotation_vector or cardan_angles, got both"):
        Spherical("ground", "b", name="j", rotation_vector=three, cardan_angles=three)
    with pytest.raises(ModelError, match="rotation_vector: expected three smooth signals"):
        Spherical("ground", "b", name="j", rotation_vector=three[:2])
    told = [Constant(0.0), Input("pitch"), Constant(0.0)]
    with pytest.raises(ModelError, match="cardan_angles: expected a signal known before the run"):
        Spherical("ground", "b", name="j", cardan_angles=told)


def pendulum(**joint):
    bob = RigidBody(1.0, [0.1, 0.1, 0.1], {"eye": Frame([0.0, 0.5, 0.0])}, Start([0, -0.5, 0]))
    return Model(
        {"bob": bob},
        [Cylindrical("ground.pin", "bob.eye", [0, 0, 1], name="p", **joint)],
        ground_frames={"pin": Frame([0.0, 0.0, 0.1])},
        gravity=[0, -G, 0],
        settings=settings(t_end=0.5, assemble=True),
    )


def test_coordinates_are_measured_from_where_the_bodies_are_drawn():
    """Another zero changes the numbers, not the motion."""
    start = {"angle": 0.2, "angle_rate": 3.0, "distance": -0.1}
    plain = simulate(pendulum(start=start))
    moved = {"angle": 40.2, "angle_rate": 3.0, "distance": 5.0}
    other = simulate(pendulum(start=moved, reference_coordinates={"angle": 40.0, "distance": 5.0}))
    np.testing.assert_allclose(other.joint("p").angle, plain.joint("p").angle + 40.0, atol=1e-12)
    np.testing.assert_allclose(other.joint("p").distance, plain.joint("p").distance + 5.1)
    np.testing.assert_allclose(other.body("bob").x, plain.body("bob").x, atol=1e-12)


def test_a_drive_that_starts_elsewhere_than_drawn_moves_the_body_there():
    """Also by more than half a turn, and along the axis."""
    drives = {"angle": Constant(2.9), "distance": Constant(0.3)}
    run = simulate(pendulum(reference_coordinates={"angle": -1.0, "distance": 0.0}, **drives))
    np.testing.assert_allclose(run.joint("p").angle, 2.9, atol=1e-12)
    turned = Rotation.from_rotvec([0, 0, 3.9]).apply([0, -0.5, 0])
    np.testing.assert_allclose(run.body("bob").x[-1], turned + np.array([0, 0, 0.3]), atol=1e-12)


def test_an_angle_of_a_universal_joint_is_measured_from_where_it_is_drawn():
    axes = ([1, 0, 0], [0, 1, 0])
    placed = {"angle": 0.5, "second_angle": -0.25}
    drive = {"second_angle": Constant(1.75)}
    joint = Universal("ground", "b", *axes, name="u", reference_coordinates=placed, **drive)
    run = simulate(Model({"b": stone()}, [joint], settings=settings(t_end=0.01)))
    np.testing.assert_allclose(run.joint("u").second_angle, 1.75, atol=1e-12)
    R = Rotation.from_quat(run.body("b").R[0], scalar_first=True)
    assert abs(R.magnitude() - 2.0) < 1e-12


def test_drawn_is_read_as_the_former_name_of_reference_coordinates(tmp_path):
    former = Revolute("ground", "b", [0, 0, 1], name="j", drawn={"angle": 0.5})
    assert former.reference_coordinates == former.drawn == {"angle": 0.5}
    changed = replace(former, reference_coordinates={"angle": 0.25})
    assert changed.reference_coordinates == {"angle": 0.25}
    path = tmp_path / "model.toml"
    write_model(pendulum(reference_coordinates={"angle": 0.5}), path)
    written = path.read_text()
    assert "reference_coordinates" in written
    assert "drawn" not in written
    path.write_text(written.replace("reference_coordinates", "drawn"))
    assert read_model(path).joints[0].reference_coordinates == {"angle": 0.5}


def test_a_field_by_its_former_name_and_its_present_one_is_an_error():
    both = {"drawn": {"angle": 0.5}, "reference_coordinates": {"angle": 0.25}}
    with pytest.raises(ModelError, match="drawn is the former name of reference_coordinates"):
        Revolute("ground", "b", [0, 0, 1], name="j", **both)


def test_reference_coordinates_name_a_coordinate():
    with pytest.raises(
        ModelError, match="reference_coordinates: a revolute joint takes angle, got 'distance'"
    ):
        Revolute("ground", "b", [0, 0, 1], name="j", reference_coordinates={"distance": 1.0})


def test_a_screw_needs_a_lead():
    with pytest.raises(TypeError, match="missing 1 required positional argument: 'lead'"):
        Screw("ground", "b", [0, 0, 1], name="j")
    with pytest.raises(TypeError, match="unexpected keyword argument 'lead'"):
        Revolute("ground", "b", [0, 0, 1], name="j", lead=0.1)


def test_what_has_no_name_is_numbered_by_type(tmp_path):
    """Beside names that are given, in results, messages and files."""
    (tmp_path / "model.toml").write_text("""
[simulation]
t_end = 0.01
step = 1e-3
[bodies.a]
mass = 1
inertia = [1, 1, 1]
[bodies.b]
mass = 1
inertia = [1, 1, 1]
[[joints]]
type = "revolute"
between = ["ground", "a"]
axis = [0, 0, 1]
[[joints]]
name = "revolute 3"
type = "prismatic"
between = ["ground", "b"]
axis = [0, 0, 1]
[[springs]]
type = "torsion"
between = ["ground", "a"]
axis = [0, 0, 1]
stiffness = 1
[[couplers]]
type = "rack"
joints = ["revolute 1", "revolute 3"]
radius = 0.1
""")
    model = read_model(tmp_path / "model.toml")
    assert [c.name for c in model.couplings] == ["revolute 1", "revolute 3", "spring 1", "rack 1"]
    write_model(tmp_path / "again.toml", model)
    assert read_model(tmp_path / "again.toml").couplers[0].name == "rack 1"
    assert simulate(model).couplers == ("rack 1",)


def test_a_number_that_is_taken_is_passed_over():
    wheels = {name: stone() for name in "abc"}
    names = ["", "revolute 3", ""]
    joints = [
        Revolute("ground", body, [0, 0, 1], name=name)
        for name, body in zip(names, wheels, strict=True)
    ]
    spring = Spring("revolute 1", "torsion", ["a", "b"], [0, 0, 1], stiffness=1.0)
    model = Model(wheels, joints, springs=[spring])
    assert [joint.name for joint in model.joints] == ["revolute 2", "revolute 3", "revolute 4"]


def test_an_error_of_what_has_no_name_says_its_type():
    with pytest.raises(ModelError, match=r"joint without a name \(revolute\): axis: expected"):
        Revolute("ground", "b", [0, 0, 0])


def test_a_body_is_placed_by_its_center():
    """With the axes of the frame that it is placed on; on a center too."""
    on = np.array([5.0, 0.0, 0.0])
    frame = Frame([0.1, 0.2, 0.3], TURN.as_rotvec())
    base = RigidBody(1.0, [1, 1, 1], {"seat": frame}, Start(on, [0, 0, 0.5]))
    on_frame, on_center = Start(place=Place("", "base.seat")), Start(place=Place("", "base"))
    bodies = {
        "base": base,
        "top": RigidBody(1.0, [1, 1, 1], start=on_frame),
        "twin": RigidBody(1.0, [1, 1, 1], start=on_center),
    }
    run = simulate(Model(bodies, settings=settings(t_end=0.01)))
    turn = Rotation.from_rotvec([0, 0, 0.5])
    np.testing.assert_allclose(run.body("top").x[0], frame.position @ turn.as_matrix().T + on)
    R = Rotation.from_quat(run.body("top").R[0], scalar_first=True)
    assert (R * (turn * TURN).inv()).magnitude() < 1e-12
    np.testing.assert_allclose(run.body("twin").R, run.body("base").R, atol=1e-15)


def test_a_driven_ball_joint_follows_functions():
    zero = SmoothFunction(lambda t: 0.0, lambda t: 0.0, lambda t: 0.0)
    spin = SmoothFunction(lambda t: t**2, lambda t: 2 * t, lambda t: 2.0)
    joint = Spherical("ground", "b", name="ball", rotation_vector=[zero, zero, spin])
    run = simulate(Model({"b": stone()}, [joint], settings=settings()))
    np.testing.assert_allclose(run.body("b").v[:, 5], 2 * run.time, atol=1e-5)
    np.testing.assert_allclose(run.joint("ball").moment[:, 2], 0.2, rtol=1e-3)


def test_new_joints_are_written_and_read(tmp_path):
    angles = [Constant(0.5), Harmonic(1, 2), Constant(0.0)]
    joints = [
        Screw("ground", "b", [0, 0, 1], name="a", lead=0.02, reference_coordinates={"angle": 1.0}),
        Spherical("b", "c", name="b", cardan_angles=angles),
    ]
    coupler = Coupler("m", "linear", ["a.angle", "a.distance"], ratios=[1, 2], offset=Constant(3.0))
    model = Model({"b": stone(), "c": stone()}, joints, couplers=[coupler])
    write_model(tmp_path / "model.toml", model)
    again = read_model(tmp_path / "model.toml")
    assert again.joints[1].cardan_angles == model.joints[1].cardan_angles
    assert again.joints[0].reference_coordinates == {"angle": 1.0}
    assert again.joints[0].lead == 0.02
    assert again.couplers[0].offset == Constant(3.0)
