"""Numbers that no calculation can bear are refused where they are given; rounding is none."""

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    Force,
    Frame,
    Harmonic,
    Impulse,
    Input,
    Model,
    ModelError,
    Polynomial,
    PrescribedDisplacement,
    PrescribedRotation,
    Prismatic,
    Pulse,
    Revolute,
    RigidBody,
    Settings,
    Spline,
    Spring,
    Start,
    SteadyRotation,
    Steps,
    Table,
    TabulatedLaw,
    read_model,
    simulate,
)
from scipy.spatial.transform import Rotation

Z = [0, 0, 1]
ON = ("ground", "a")
UNIT = [1.0, 1.0, 1.0]
MAKERS = {
    "a constant": lambda x: Constant(x),
    "a time of steps": lambda x: Steps((0.0, x), (1.0, 1.0)),
    "a value of steps": lambda x: Steps((0.0, 1.0), (1.0, x)),
    "a value of a table": lambda x: Table((0.0, 1.0), (x, 1.0)),
    "a value of a spline": lambda x: Spline((0.0, 1.0), (x, 1.0)),
    "an amplitude": lambda x: Harmonic(x, 1.0),
    "a frequency": lambda x: Harmonic(1.0, x),
    "a phase": lambda x: Harmonic(1.0, 1.0, x),
    "an offset": lambda x: Harmonic(1.0, 1.0, 0.0, x),
    "a coefficient": lambda x: Polynomial((0.0, x)),
    "an impulse": lambda x: Impulse(x, 0.0),
    "its time": lambda x: Impulse(1.0, x),
    "a pulse": lambda x: Pulse(x, 0.0, 1.0),
    "its end": lambda x: Pulse(1.0, 0.0, x),
    "an input": lambda x: Input("motor", x),
    "a mass": lambda x: RigidBody(x, UNIT),
    "an inertia": lambda x: RigidBody(1.0, [x, 1.0, 1.0]),
    "a frame": lambda x: Frame([x, 0, 0]),
    "its rotation": lambda x: Frame(rotation=[x, 0, 0]),
    "a position": lambda x: Start([x, 0, 0]),
    "a velocity": lambda x: Start(velocity=[x, 0, 0]),
    "an angular velocity": lambda x: Start(angular_velocity=[x, 0, 0]),
    "an axis": lambda x: Revolute(*ON, [0, 0, x], name="j"),
    "a starting angle": lambda x: Revolute(*ON, Z, name="j", start={"angle": x}),
    "a direction": lambda x: Force("a", [0, x, 0], Constant(1.0)),
    "a stiffness": lambda x: Spring("s", "point", ON, stiffness=x),
    "six stiffnesses": lambda x: Spring("s", "bushing", ON, stiffness=[x] * 6),
    "a damping": lambda x: Spring("s", "point", ON, damping=x),
    "a length at rest": lambda x: Spring("s", "point", ON, stiffness=1.0, rest=[x]),
    "a force of a law": lambda x: TabulatedLaw((0.0, 1.0), (0.0, x)),
    "a displacement": lambda x: PrescribedDisplacement("m", "a", [x, 0, 0], Constant(0.0)),
    "a rotation": lambda x: PrescribedRotation("m", "a", [0, 0, x], Constant(0.0)),
    "gravity": lambda x: Model({"a": RigidBody(1.0, UNIT)}, gravity=[0, x, 0]),
    "the end": lambda x: Settings(t_end=x),
    "a step": lambda x: Settings(t_end=1.0, step=x),
    "a memory": lambda x: Settings(t_end=1.0, kernel_length=x),
    "a steady rotation": lambda x: SteadyRotation([0, 0, x]),
}


@pytest.mark.parametrize("number", [np.nan, np.inf, -np.inf, 1e308, -1e308])
@pytest.mark.parametrize("name", MAKERS)
def test_no_number_is_taken_that_overflows(name, number):
    with pytest.raises(ModelError, match=r"expected .*, got|must") as caught:
        MAKERS[name](number)
    assert "\n" not in str(caught.value)


FILE = """
[simulation]
t_end = {t_end}
step = 1e-3
gravity = [0, 0, {gravity}]
[bodies.bob]
mass = {mass}
inertia = [1, 1, 1]
position = [{position}, 0, 0]
[[joints]]
name = "pin"
type = "revolute"
between = ["ground", "bob"]
axis = [0, 0, 1]
start = {{angle = {start}}}
[[loads]]
type = "force"
on = "bob"
direction = [1, 0, 0]
signal = {signal}
[[springs]]
name = "spring"
type = "torsion"
between = ["ground", "bob"]
axis = [0, 0, 1]
stiffness = {stiffness}
"""
NUMBERS = {
    "t_end": "simulation.t_end: ",
    "gravity": "simulation.gravity",
    "mass": "bodies.bob.mass: ",
    "position": "bodies.bob.position",
    "start": "joints.pin.start.angle: ",
    "signal": "load (force) on 'bob': signal: ",
    "stiffness": "springs.spring.stiffness: ",
}
OWNERS = {
    "gravity": "gravity: ",
    "position": "bodies.bob: position: ",
    "start": "joint 'pin': start: ",
    "stiffness": "spring 'spring': stiffness: ",
}


@pytest.mark.parametrize("number", ["nan", "inf", "-inf", "1e308"])
@pytest.mark.parametrize("key", NUMBERS)
def test_a_file_is_told_where_such_a_number_stands(key, number, tmp_path):
    path = tmp_path / "model.toml"
    values = dict.fromkeys(NUMBERS, "1.0") | {key: number}
    path.write_text(FILE.format(**values))
    with pytest.raises(ModelError) as caught:
        read_model(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    places = (NUMBERS[key], OWNERS.get(key, NUMBERS[key]))
    assert any(place in message for place in places), message


def test_text_is_no_number():
    for value in ("1", b"1"):
        with pytest.raises(ModelError, match="value: expected a number"):
            Constant(value)


@pytest.mark.parametrize("size", [1e-200, 1e-80, 1e90])
def test_an_axis_of_any_length_is_a_direction(size):
    joint = Revolute(*ON, [size, size, 0.0], name="j")
    np.testing.assert_allclose(joint.axis, [np.sqrt(0.5), np.sqrt(0.5), 0], rtol=1e-15)


def test_an_inertia_is_symmetric_up_to_rounding():
    """Turned, its small entries differ by more than they are."""
    R = Rotation.from_rotvec([0.1, 0.2, 0.3]).as_matrix()
    J = np.diag([1.0, 1.0 + 1e-12, 1.0])
    turned = R @ J @ R.T + 1e-17 * np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 0]])
    RigidBody(1.0, turned)
    with pytest.raises(ModelError, match="symmetric 3x3 matrix"):
        RigidBody(1.0, np.eye(3) + 1e-3 * np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 0]]))


def test_a_small_stiffness_is_symmetric_too():
    matrix = 1e-9 * np.eye(6)
    matrix[0, 1] = 0.5e-9
    with pytest.raises(ModelError, match="symmetric 6x6 matrix"):
        Spring("s", "bushing", ON, stiffness=matrix)


TIMES = (0.0, 0.21, 0.33, 0.39, 0.44)
TURNING = Spline(TIMES, tuple(20.0 * t for t in TIMES))


def test_a_motion_measured_at_constant_speed_starts_in_steady_rotation():
    """The second derivative of its spline is zero but for rounding."""
    assert TURNING.derivatives(0.0)[1] != 0.0
    disk = RigidBody(1.0, UNIT)
    bearing = Revolute("ground", "disk", Z, name="bearing", angle=TURNING)
    rotation = SteadyRotation([0, 0, 20.0])
    settings = Settings(t_end=0.6, step=1e-3, start="equilibrium", steady_rotation=rotation)
    results = simulate(Model({"disk": disk}, [bearing], settings=settings))
    np.testing.assert_allclose(results.body("disk").v[:, 5], 20.0, rtol=1e-9)


def test_a_drive_that_accelerates_is_refused_where_its_rate_is_rounding():
    """A sine from its crest."""
    crest = Harmonic(0.3, 2.0, 0.5 * np.pi)
    assert crest.derivatives(0.0)[0] != 0.0
    slide = Prismatic("ground", "bob", Z, name="slide", distance=crest)
    settings = Settings(t_end=0.6, step=1e-3, start="equilibrium", assemble=True)
    with pytest.raises(ModelError, match="needs drives without acceleration"):
        simulate(Model({"bob": RigidBody(1.0, UNIT)}, [slide], settings=settings))


def test_a_measured_motion_starts_in_equilibrium():
    """A natural spline with a level beginning, where both derivatives are rounding."""
    times = (0.0, 0.1, 0.3, 0.6)
    level = Spline(times, (0.7, 0.7, 0.7, 0.7))
    drive = Spline((0.0, 0.1, 0.25, 0.6), (0.1 + 0.2, 0.3, 0.3, 0.3))
    bob = RigidBody(1.0, UNIT)
    for signal in (level, drive):
        slide = Prismatic("ground", "bob", Z, name="slide", distance=signal)
        settings = Settings(t_end=0.6, step=1e-3, start="equilibrium", assemble=True)
        simulate(Model({"bob": bob}, [slide], gravity=[1, 0, 0], settings=settings))


def test_a_motion_begins_at_zero_up_to_rounding():
    PrescribedDisplacement("shake", "a", Z, Harmonic(0.01, 20.0, np.pi))
    PrescribedDisplacement("small", "a", Z, Harmonic(1e-14, 20.0, np.pi))
    with pytest.raises(ModelError, match="expected 0 at t = 0, got 1e-06"):
        PrescribedDisplacement("shake", "a", Z, Harmonic(0.01, 20.0, np.pi, 1e-6))
