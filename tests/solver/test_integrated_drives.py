"""Drives by velocity and by acceleration, of joints and of prescribed motions."""

import re
import warnings
from dataclasses import replace

import numpy as np
import pytest
from duhamel.results import Results
from duhamel.solver import (
    JOINTS,
    Constant,
    Contact,
    Cylindrical,
    Force,
    Frame,
    Function,
    HalfSine,
    Harmonic,
    Impact,
    Impulse,
    Input,
    Model,
    ModelError,
    Noise,
    Polynomial,
    PrescribedDisplacement,
    PrescribedOrientation,
    PrescribedRotation,
    Prismatic,
    Product,
    Pulse,
    Recorded,
    ResultsError,
    Revolute,
    RigidBody,
    Settings,
    Simulator,
    SmoothFunction,
    SmoothStep,
    Spline,
    Start,
    StateError,
    SteadyRotation,
    Table,
    Window,
    check,
    read_model,
    simulate,
    start,
    write_model,
)
from duhamel.solver.signals.orientations import OrientationDrive
from scipy.spatial.transform import Rotation

AXIS = np.array([1.0, 2.0, 2.0]) / 3.0
BODY = RigidBody(2.0, [0.1, 0.2, 0.3])
KICK = HalfSine(490.0, 6e-3, 1.3e-3)


def pushed(h=1e-3, t_end=0.1, body=BODY, settings=None, **drive):
    return Model(
        {"block": body},
        motions=[PrescribedDisplacement("push", "block", AXIS, **drive)],
        joints=[Prismatic("ground", "block", AXIS, name="rail")],
        settings=Settings(t_end=t_end, step=h, **(settings or {})),
    )


def test_a_kick_leaves_the_velocity_that_is_its_area():
    """Of six steps, that begin between two: positions to rounding, and the speed after it."""
    run = simulate(pushed(acceleration=KICK, settings={"rho_inf": 0.5}))
    speed, end = 490.0 * 6e-3 * 2.0 / np.pi, 7.3e-3
    t = run.time[run.time > end]
    moved = speed * (t - end) + 490.0 * 6e-3**2 / np.pi
    found = run.body("block").x[run.time > end]
    np.testing.assert_allclose(found, np.outer(moved, AXIS), rtol=0, atol=1e-13)
    np.testing.assert_allclose(run.body("block").v[-1, :3], speed * AXIS, rtol=1e-9)


def test_the_force_of_a_driven_mass_is_that_of_its_acceleration():
    """The error falls with the square of the step."""
    signal, errors = SmoothStep((0.0, 3.0), (0.0, 0.1)), []
    for h in (1e-3, 5e-4):
        run = simulate(pushed(h, velocity=signal, settings={"rho_inf": 0.9}))
        expected = [2.0 * signal.derivatives(t)[0] for t in run.time.tolist()]
        late = run.time > 0.03
        errors.append(np.abs(run.joint("push").multipliers[:, 0] - expected)[late].max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.3)


@pytest.mark.parametrize("kind", ["prismatic", "cylindrical"])
def test_a_slide_starts_where_its_body_is_placed(kind):
    away = RigidBody(2.0, [0.1, 0.2, 0.3], start=Start(position=0.7 * AXIS))
    model = Model(
        {"block": away},
        joints=[
            JOINTS[kind](
                "ground.wall",
                "block",
                AXIS,
                name="rail",
                acceleration=Constant(2.0),
                start={"distance_rate": -0.3},
            )
        ],
        ground_frames={"wall": Frame()},
        settings=Settings(t_end=0.5, step=1e-2),
    )
    run = simulate(model)
    t = run.time
    np.testing.assert_allclose(run.joint("rail").distance, 0.7 - 0.3 * t + t**2, atol=1e-13)
    np.testing.assert_allclose(run.joint("rail").distance_rate[0], -0.3, atol=1e-13)
    np.testing.assert_allclose(run.body("block").x[-1], (0.7 - 0.15 + 0.25) * AXIS, atol=1e-13)


@pytest.mark.parametrize("between", [("ground", "arm"), ("arm", "ground")])
def test_a_driven_joint_turns_by_the_integrals_of_its_signal(between):
    for key, power in (("angular_velocity", 1), ("angular_acceleration", 2)):
        model = Model(
            {"arm": RigidBody(1.0, [0.1, 0.2, 0.3])},
            joints=[Revolute(*between, AXIS, name="j", **{key: Constant(30.0)})],
            settings=Settings(t_end=1.0, step=2e-3),
        )
        run = simulate(model)
        np.testing.assert_allclose(run.joint("j").angle, 30.0 * run.time**power / power, atol=1e-10)
        assert run.joint("j").angle_rate[-1] == pytest.approx(30.0, rel=1e-6)


def test_a_turn_by_acceleration_is_that_by_the_angle():
    """To the bit where the integrals are: the same positions drive the same run."""
    wave = Harmonic(3.0, 5.0, 0.5 * np.pi)
    omega = 10.0 * np.pi
    for drive in (
        {"angular_acceleration": wave},
        {"angular_velocity": Harmonic(3.0 / omega, 5.0)},
        {
            "angle": SmoothFunction(
                lambda t: 3.0 * (1.0 - np.cos(omega * t)) / omega**2,
                lambda t: 3.0 * np.sin(omega * t) / omega,
                lambda t: 3.0 * np.cos(omega * t),
            )
        },
    ):
        model = Model(
            {"arm": BODY},
            motions=[PrescribedRotation("turn", "arm", AXIS, **drive)],
            settings=Settings(t_end=0.5, step=1e-3),
        )
        spin = simulate(model).body("arm").v[:, 5]
        expected = 2.0 / 3.0 * 3.0 * np.sin(omega * 1e-3 * np.arange(501)) / omega
        np.testing.assert_allclose(spin, expected, atol=1e-5)


def test_a_product_and_a_record_drive_by_quadrature_and_by_pieces(tmp_path):
    """A damped sine, whose integral is known; the points of its graph."""
    a, b = 4.0, 60.0
    decay = SmoothFunction(
        lambda t: np.exp(-a * t), lambda t: -a * np.exp(-a * t), lambda t: a**2 * np.exp(-a * t)
    )
    wave = Product((decay, Harmonic(2.0, b / (2.0 * np.pi))))
    z = -a + 1j * b
    t = 1e-3 * np.arange(1001)
    expected = 2.0 * ((np.exp(z * t) - 1.0) / z**2 - t / z).imag
    run = simulate(pushed(t_end=1.0, acceleration=wave))
    np.testing.assert_allclose(run.body("block").x @ AXIS, expected, rtol=0, atol=2e-13)
    times = np.linspace(0.0, 1.0, 2001)
    rows = "\n".join(f"{t},{float(wave(t))!r}" for t in times.tolist())
    (tmp_path / "wave.csv").write_text(rows)
    record = Recorded(tmp_path / "wave.csv", 2)
    run = simulate(pushed(t_end=1.0, acceleration=record))
    np.testing.assert_allclose(run.body("block").x @ AXIS, expected, rtol=0, atol=3e-6)


def test_what_is_left_at_the_end_is_stated():
    model = pushed(acceleration=KICK, t_end=0.1)
    speed = 490.0 * 6e-3 * 2.0 / np.pi
    (line,) = (line for line in check(model).lines() if "push" in line)
    for text in (line, simulate(model).solver["drift"]):
        assert text.startswith("motion 'push', driven by its acceleration: at t = 0.1 s")
        moved, rate = (float(number) for number in re.findall(r"(\S+) m(?!o)", text))
        assert rate == pytest.approx(speed, rel=1e-3)
        assert moved == pytest.approx(speed * (0.1 - 4.3e-3), rel=1e-3)


def test_a_drive_at_rest_to_rounding_starts_in_equilibrium():
    """A natural spline has no second derivative at its ends, nor a window a value before it."""
    t = np.linspace(0.0, 0.1, 41)
    spline = Spline(t, np.sin(7.0 * t) * t**2 * 0.1)
    noise = Product((Noise(1.0, (5.0, 50.0), 1.0), Window((0.0, 0.1), 0.02, 0.02)))
    for drive in (
        {"displacement": Spline(t, np.append(0.0, 0.1 * np.cumsum(t)[:-1]) ** 2)},
        {"acceleration": noise},
        {"acceleration": Harmonic(3.0, 10.0, np.pi)},
        {"velocity": Harmonic(3.0, 10.0, np.pi / 2.0, -3.0)},
    ):
        simulate(pushed(t_end=0.01, settings={"start": "equilibrium"}, **drive))
    assert spline.derivatives(0.0)[1] == pytest.approx(0.0, abs=1e-12)


def test_a_drive_that_accelerates_at_once_has_no_equilibrium():
    for drive in ({"acceleration": Constant(1.0)}, {"velocity": Polynomial((0.0, 1.0))}):
        with pytest.raises(
            ModelError,
            match="motion 'push': start = 'equilibrium' needs drives without acceleration at "
            "t = 0, got 1",
        ):
            start(pushed(settings={"start": "equilibrium"}, **drive))


def test_a_spin_by_acceleration_starts_in_steady_rotation():
    """It speeds up later; until then nothing changes."""
    faster = SmoothStep((0.0, 5.0), (0.1, 0.2))
    model = Model(
        {"rotor": RigidBody(2.0, [0.1, 0.1, 0.15])},
        joints=[
            Revolute(
                "ground",
                "rotor",
                [0, 0, 1],
                name="j",
                angular_acceleration=faster,
                start={"angle_rate": 2.0},
            )
        ],
        settings=Settings(
            t_end=0.3, step=1e-3, start="equilibrium", steady_rotation=SteadyRotation([0, 0, 2.0])
        ),
    )
    spin = simulate(model).body("rotor").v[:, 5]
    np.testing.assert_allclose(spin[:90], 2.0, atol=1e-9)
    assert spin[-1] == pytest.approx(2.0 + 5.0 * 0.15, abs=1e-4)


def test_a_simulator_takes_integrated_drives():
    model = pushed(h=1e-3, t_end=0.05, acceleration=KICK)
    simulator = Simulator(model, ["bodies/block/x"])
    rows = [simulator.step([]) for _ in range(50)]
    np.testing.assert_array_equal(rows, simulate(model).body("block").x[1:])


def test_drives_come_back_from_a_file(tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "base.csv").write_text("t,a\n0,0\n0.05,2\n0.1,0\n")
    record = Recorded(tmp_path / "base.csv", "a", 9.81)
    joint = Cylindrical(
        "ground",
        "block",
        AXIS,
        name="j",
        angular_acceleration=record,
        velocity=Harmonic(1.0, 2.0),
        start={"angle_rate": 1.0 / 3.0},
    )
    turn = PrescribedRotation(
        "turn", "other", AXIS, angular_acceleration=record, start={"angle_rate": 0.2}
    )
    model = Model(
        {"block": BODY, "other": BODY},
        [joint],
        motions=[turn, PrescribedDisplacement("go", "other", AXIS, velocity=Constant(1.0))],
        settings=Settings(t_end=0.01, step=1e-3),
    )
    path = tmp_path / "sub" / "model.toml"
    write_model(path, model)
    assert 'file = "../base.csv"' in path.read_text()
    again = read_model(path)
    assert again.joints[0].angular_acceleration == record
    np.testing.assert_array_equal(simulate(again).body("block").x, simulate(model).body("block").x)
    np.testing.assert_array_equal(simulate(again).body("other").R, simulate(model).body("other").R)


@pytest.mark.parametrize(
    ("drive", "message"),
    [
        ({}, "expected one of displacement, velocity, acceleration, found none"),
        (
            {"velocity": Constant(1.0), "acceleration": Constant(1.0)},
            "expected one of displacement, velocity, acceleration, found velocity and acceleration",
        ),
        ({"acceleration": Impulse(1.0, 0.0)}, "acceleration: an impulse makes the velocity jump"),
        ({"acceleration": Input("a")}, "acceleration: an input is known only when"),
        ({"velocity": Pulse(1.0, 0.25, 0.5)}, "velocity without jumps, found one at t = 0.25 s"),
        (
            {"velocity": Constant(1.0), "start": {"displacement_rate": 1.0}},
            "start: takes displacement_rate with acceleration alone, got 'displacement_rate'",
        ),
        ({"acceleration": Constant(1.0), "start": {"rate": 1.0}}, "with acceleration alone, got"),
    ],
)
def test_drives_that_cannot_be_are_refused(drive, message):
    with pytest.raises(ModelError, match="motion 'push': .*" + message):
        pushed(**drive)


def test_a_joint_names_the_key_that_it_does_not_take():
    with pytest.raises(TypeError, match="unexpected keyword argument 'acceleration'"):
        Revolute("ground", "a", [0, 0, 1], name="j", acceleration=Constant(1.0))
    with pytest.raises(ModelError, match="start: angle is driven"):
        Revolute(
            "ground",
            "a",
            [0, 0, 1],
            name="j",
            angular_acceleration=Constant(1.0),
            start={"angle": 1.0},
        )


def test_the_area_that_steps_miss_is_told():
    """A half-sine of two steps in a table has more area than its samples."""
    x = np.linspace(0.0, 1.0, 21)
    table = Table(1.03e-2 + 2e-3 * x, 100.0 * np.sin(np.pi * x))
    within_a_step = HalfSine(100.0, 2e-4, 1.03e-2)
    for signal, warned in (
        (table, True),
        (HalfSine(100.0, 2e-3, 1.03e-2), False),
        (HalfSine(100.0, 1e-3, 1e-2), False),
        (within_a_step, False),
    ):
        model = Model(
            {"block": BODY},
            loads=[Force("block", [1, 0, 0], signal)],
            settings=Settings(t_end=0.05, step=1e-3),
        )
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            simulate(model)
        assert bool(caught) == warned
        assert {str(warning.message) for warning in caught} <= set(check(model).warnings)
        if warned:
            assert "load (force) on 'block': its signal has an area of 0.127" in str(caught[0])


def tilted(t_end=1.0, h=1e-3, settings=None, **drive):
    place = Start(position=[1000.0, -3.0, 2.0], rotation=[0.4, 0.1, -0.3])
    return Model(
        {"table": RigidBody(2.0, [0.1, 0.2, 0.3], {"rim": Frame([0.3, 0, 0], [0, 1, 0])}, place)},
        motions=[
            PrescribedOrientation("tilt", "table.rim", **drive),
            *(
                PrescribedDisplacement(f"hold{k}", "table.rim", np.eye(3)[k], Constant(0.0))
                for k in range(3)
            ),
        ],
        settings=Settings(t_end=t_end, step=h, **(settings or {})),
    )


def test_a_frame_turns_about_three_axes():
    """A kilometre away, from an oblique start: R_z R_y R_x, to rounding."""
    roll, pitch, yaw = Harmonic(0.7, 1.0), Harmonic(0.9, 1.3), Harmonic(-0.8, 0.7)
    run = simulate(tilted(angles=[roll, pitch, yaw]))
    angles = np.array([[f(t) for f in (yaw, pitch, roll)] for t in run.time.tolist()])
    turns = Rotation.from_euler("ZYX", angles).as_matrix()
    R = Rotation.from_quat(run.body("table").R, scalar_first=True).as_matrix()
    np.testing.assert_allclose(R, turns @ R[0], rtol=0, atol=3e-12)
    spin = Rotation.from_matrix(turns[2:] @ turns[:-2].transpose(0, 2, 1)).as_rotvec() / 2e-3
    omega = np.einsum("nij,nj->ni", R, run.body("table").v[:, 3:])
    np.testing.assert_allclose(omega[1:-1], spin, rtol=0, atol=1e-3)


def test_three_angles_by_their_accelerations_are_those_by_angles():
    twice = (2.0 * np.pi) ** 2
    wave = Harmonic(0.1 * twice, 1.0, np.pi / 2)
    motion = SmoothFunction(
        lambda t: 0.1 * (1.0 - np.cos(2 * np.pi * t)),
        lambda t: 0.2 * np.pi * np.sin(2 * np.pi * t),
        lambda t: 0.1 * twice * np.cos(2 * np.pi * t),
    )
    by_angle = simulate(tilted(0.5, angles=[motion, Constant(0.0), motion]))
    by_acceleration = simulate(tilted(0.5, angular_accelerations=[wave, Constant(0.0), wave]))
    np.testing.assert_allclose(
        by_acceleration.body("table").R, by_angle.body("table").R, rtol=0, atol=1e-12
    )
    np.testing.assert_allclose(
        by_acceleration.body("table").v[0], by_angle.body("table").v[0], atol=1e-12
    )
    lines = by_acceleration.solver["drift"].splitlines()
    assert [line.split(",")[0] for line in lines] == [f"motion 'tilt' about {k}" for k in "xyz"]


def test_the_drives_of_an_orientation_have_their_derivatives():
    angles = (Harmonic(0.7, 1.0), Harmonic(0.9, 1.3), Harmonic(-0.8, 0.7))
    for row in range(3):
        drive, d = OrientationDrive(angles, row, ""), 1e-4
        t = np.linspace(0.05, 2.0, 31)
        before, at, after = (drive.values_at(t + k * d) for k in (-1, 0, 1))
        found = np.array([drive.derivatives(time) for time in t.tolist()]).T
        np.testing.assert_allclose(found[0], (after - before) / (2 * d), atol=1e-5)
        np.testing.assert_allclose(found[1], (after + before - 2 * at) / d**2, atol=1e-3)


@pytest.mark.parametrize(
    ("drive", "message"),
    [
        ({}, "expected three signals, angles, angular_velocities, .*found none"),
        ({"angles": [Constant(0.0)]}, "expected three signals, .*, found 1 angles"),
        ({"angles": [Constant(0.0)] * 2 + [KICK]}, "angles: expected smooth signals, found halfs"),
        ({"angles": [Constant(0.0)] * 2 + [Constant(0.1)]}, "angles: z: expected 0 at t = 0"),
        ({"angular_velocities": [Pulse(1, 0, 1)] * 3}, "angular_velocities: .*without jumps"),
        (
            {"angular_velocities": [Constant(0.0), Constant(3.0), Constant(0.0)]},
            r"angles: expected at most 1 rad, got 1.00\d* about y at t = 0.33",
        ),
    ],
)
def test_orientations_that_cannot_be_are_refused(drive, message):
    with pytest.raises(ModelError, match="motion 'tilt': " + message):
        simulate(tilted(**drive))


def test_a_restart_goes_on_to_the_bit_and_knows_the_numbers_of_its_record(tmp_path):
    """Wherever the file is; not with another number in it."""
    rows = "\n".join(
        f"{t},{float(np.sin(40.0 * t))!r}" for t in np.linspace(0.0, 0.2, 101).tolist()
    )
    places = {name: tmp_path / f"{name}.csv" for name in ("here", "there", "changed")}
    for name, path in places.items():
        path.write_text(rows if name != "changed" else rows + "\n0.3,9")

    def model(name, t_end):
        record = Recorded(places[name], 2, 30.0)
        swept = Product((record, Window((0.0, 0.2), 0.05, 0.05), Noise(1.0, (5.0, 50.0), 1.0)))
        run = pushed(t_end=t_end, acceleration=swept, settings={"checkpoint": {"every": 7}})
        return replace(run, loads=[Force("block", [1, 2, 3], swept)])

    target = tmp_path / "run.h5"
    simulate(model("here", 0.1), output=target)
    with pytest.raises(StateError, match=r"loads\.1\.signal\.product\.1\.file: was"):
        simulate(model("changed", 0.15), output=target, resume=True)
    simulate(model("there", 0.15), output=target, resume=True)
    resumed, whole = Results.read(target), simulate(model("here", 0.15))
    np.testing.assert_array_equal(resumed.body("block").v, whole.body("block").v)
    assert "at t = 0.15 s" in resumed.solver["drift"]


def test_the_record_of_a_run_is_not_overwritten(tmp_path):
    path = tmp_path / "base.h5"
    path.write_text("0,1\n1,2\n")
    with pytest.raises(ResultsError, match="a record that the model follows"):
        simulate(pushed(acceleration=Recorded(path, 2)), output=path)


@pytest.mark.parametrize("long", [1e-3, 4e-3])
def test_a_pulse_in_flight_keeps_its_momentum(long):
    """With long steps away from contacts, of which some end within a pulse of 2.3 ms."""
    away = RigidBody(1.0, [0.1, 0.1, 0.1], {"tip": Frame()}, Start(position=[0, 0, 9.0]))
    model = Model(
        {"ball": away},
        contacts=[
            Contact(
                "floor",
                ("ground.wall", "ball.tip"),
                "plane",
                ball=0.1,
                axis=[0, 0, 1],
                impact=Impact(stiffness=1e6),
            )
        ],
        loads=[Force("ball", [1, 0, 0], HalfSine(1000.0, 2.3e-3, 0.0113))],
        ground_frames={"wall": Frame()},
        settings=Settings(t_end=0.1, step=long, contact_step=1e-4, rho_inf=0.5),
    )
    speed = simulate(model).body("ball").v[-1, 0]
    assert speed == pytest.approx(1000.0 * 2.3e-3 * 2.0 / np.pi, rel=1e-5)


@pytest.mark.parametrize(
    ("drive", "message"),
    [
        ({"acceleration": Function(lambda t: np.nan)}, "does not converge near"),
        ({"displacement": SmoothFunction(lambda t: 0.0 * t, lambda t: np.nan, float)}, "0, nan, 0"),
    ],
)
def test_a_drive_that_is_no_number_at_the_start_is_named(drive, message):
    with pytest.raises(ModelError, match=f"motion 'push': .*{message}"):
        simulate(pushed(**drive))
