"""Every way to write a model that contradicts itself, and what is said about it."""

import re
from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    ConvergenceError,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Function,
    Harmonic,
    Joint,
    Model,
    ModelError,
    Place,
    Polynomial,
    PrescribedDisplacement,
    Prismatic,
    Revolute,
    RigidBody,
    Settings,
    Spherical,
    Spring,
    Start,
    Steps,
    Torque,
    Universal,
    read_model,
    simulate,
)
from duhamel.superelement import GeneralizedAlpha, sample_kernel, write

from .models import model_of


def body(**settings):
    return RigidBody(1.0, [1.0, 2.0, 1.5], {"f": Frame([0.5, 0, 0])}, **settings)


def model(joints=(), loads=(), **settings):
    bodies = {"a": body(), "b": body(start=Start(position=[1.0, 0, 0], rotation=[0, 0, np.pi]))}
    return model_of(
        **{"bodies": bodies, "joints": joints, "loads": loads, "t_end": 0.1, "step": 0.01}
        | settings
    )


def weld(*between):
    return Fixed(*between, name="weld")


MADE = {
    "a body that is not there": (
        lambda: model((weld("a", "c.f"),)),
        "joint 'weld': no body 'c'; there are: ground, a, b",
    ),
    "a frame that is not there": (
        lambda: model((weld("a.g", "b"),)),
        "joint 'weld': no frame 'g' on 'a'; it has: f",
    ),
    "a frame of the ground that is not there": (
        lambda: model((weld("ground.wall", "b"),)),
        "joint 'weld': no frame 'wall' on 'ground'; it has: none",
    ),
    "a load on nothing": (
        lambda: model((), (Force("c", [1, 0, 0], Constant(1.0)),)),
        "load (force) on 'c': no body 'c'; there are: ground, a, b",
    ),
    "a load on the ground": (
        lambda: model((), (Torque("ground", [1, 0, 0], Constant(1.0)),)),
        "load (torque) on 'ground': expected a frame of a body, got 'ground'",
    ),
    "a place on nothing": (
        lambda: model(bodies={"a": body(start=Start(place=Place("f", "z.f")))}),
        "body 'a': place: no body 'z'; there are: ground, a",
    ),
    "a place by a frame that is not there": (
        lambda: model(bodies={"a": body(start=Start(place=Place("g", "ground")))}),
        "body 'a': place: no frame 'g' on 'a'; it has: f",
    ),
    "a joint of a body with itself": (
        lambda: model((weld("a", "a.f"),)),
        "joint 'weld': expected frames of two bodies, got ['a', 'a.f']",
    ),
    "two joints of one name": (
        lambda: model((weld("a", "ground"), weld("b", "ground"))),
        "joints, springs, motions, contacts, stops, motors, couplers, bearings, fmus: expected "
        "different names, got 'weld' more than once",
    ),
    "no bodies": (lambda: model(bodies={}), "bodies: expected at least one body, got none"),
    "a body called ground": (
        lambda: model(bodies={"ground": body()}),
        "bodies: a body cannot be named 'ground'",
    ),
    "a body with a dot": (
        lambda: model(bodies={"a.b": body()}),
        "bodies: a body cannot be named 'a.b'",
    ),
    "a joint with a colon": (
        lambda: model((Fixed("a", "ground", name="motor:1"),)),
        "joints: a joint cannot be named 'motor:1': expected 1 to 100 printable characters "
        "without '.', '/' and ':'",
    ),
    "a frame of the ground with a NUL": (
        lambda: replace(model(), ground_frames={"a\0b": Frame()}),
        "ground: a frame cannot be named 'a\\x00b': expected 1 to 100 printable characters",
    ),
    "a step whose square is zero": (
        lambda: Settings(t_end=1.0, step=1e-300),
        "step: expected a positive time, 1e-100 to 1e100, got 1e-300",
    ),
    "a joint with a slash": (
        lambda: model((Fixed("a", "ground", name="a/b"),)),
        "joints: a joint cannot be named 'a/b'",
    ),
    "a frame with a slash": (
        lambda: model(bodies={"a": RigidBody(1.0, [1, 1, 1], {"x/y": Frame()})}),
        "body 'a': a frame cannot be named 'x/y'",
    ),
    "an axis too few of a torsion spring": (
        lambda: Spring("s", "torsion", ("ground", "a"), stiffness=1.0),
        "spring 's': axis: a torsion spring needs one",
    ),
    "an axis too many of a spring": (
        lambda: Spring("s", "point", ("ground", "a"), axis=[0, 0, 1]),
        "spring 's': axis: a point spring takes none, got [0.0, 0.0, 1.0]",
    ),
    "a second axis without the first": (
        lambda: Spring("s", "bushing", ("ground", "a"), second_axis=[0, 0, 1]),
        "spring 's': second_axis: a bushing spring takes one only with axis, got [0.0, 0.0, 1.0]",
    ),
    "a second axis of a torsion spring": (
        lambda: Spring("s", "torsion", ("ground", "a"), [0, 0, 1], second_axis=[0, 1, 0]),
        "spring 's': second_axis: a torsion spring takes none, got [0.0, 1.0, 0.0]",
    ),
    "axes of a bushing that are not perpendicular": (
        lambda: Spring("s", "bushing", ("ground", "a"), [0, 0, 1], second_axis=[0, 1, 1]),
        "spring 's': second_axis: expected an axis perpendicular to axis at the start",
    ),
    "an axis without direction": (
        lambda: Revolute("a", "b", [0, 0, 0], name="j"),
        "joint 'j': axis: expected three numbers that are not all zero, got [0, 0, 0]",
    ),
    "oblique axes": (
        lambda: Universal("a", "b", [0, 0, 1], [0, 1, 1], name="j"),
        "joint 'j': the axes of a universal joint must be perpendicular at the start",
    ),
    "a drive that jumps": (
        lambda: Revolute("a", "b", [0, 0, 1], name="j", angle=Steps((0.0,), (1.0,))),
        "joint 'j': angle: expected a smooth signal (constant, harmonic, polynomial, spline, "
        "smooth step, chirp, noise, or of such parts), "
        "got steps",
    ),
    "a load with two numbers": (
        lambda: Force("a", [1, 0], Constant(1.0)),
        "load (force) on 'a': direction: expected three numbers, got [1, 0]",
    ),
    "a load without a signal": (
        lambda: Force("a", [1, 0, 0], 2.0),
        "load (force) on 'a': signal: expected a signal such as Constant, got 2.0",
    ),
    "no mass": (
        lambda: RigidBody(0.0, [1, 1, 1]),
        "mass: expected a positive number, 1e-100 to 1e100, got 0.0",
    ),
    "no inertia": (
        lambda: RigidBody(1.0, [1, 1, 0]),
        "inertia: expected positive principal values, got",
    ),
    "a skew inertia": (
        lambda: RigidBody(1.0, [[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]),
        "inertia: expected three principal values or a symmetric 3x3 matrix",
    ),
    "an inertia of nothing that is": (
        lambda: RigidBody(1.0, [1, 1, 2.1]),
        "inertia: expected principal values of which none exceeds the sum of the other two, "
        "got [1.0, 1.0, 2.1]",
    ),
    "an inertia in an array": (
        lambda: RigidBody(1.0, np.array([1.0, 2.0])),
        "inertia: expected three principal values or a symmetric 3x3 matrix, got [1.0, 2.0]",
    ),
    "a damper that drives": (
        lambda: Spring("s", "point", ("a", "b"), damping=-0.5),
        "spring 's': damping: expected zero or more, got -0.5",
    ),
    "a bushing that drives": (
        lambda: Spring("s", "bushing", ("a", "b"), damping=np.eye(6) + 2.0 * np.eye(6)[::-1]),
        "spring 's': damping: expected no negative eigenvalue, which would create energy, got -1",
    ),
    "a spring with a dot": (
        lambda: model(springs=(Spring("a.b", "point", ("a", "b")),)),
        "springs: a spring cannot be named 'a.b'",
    ),
    "two positions": (
        lambda: Start(position=[1, 0, 0], place=Place("f", "ground")),
        "expected `place`, or `position` and `rotation`, got both",
    ),
    "a position that is no number": (
        lambda: Start(position=[np.nan, 0, 0]),
        "position: expected three numbers, got [nan, 0, 0]",
    ),
    "no time": (
        lambda: model(t_end=0.0),
        "t_end: expected a positive time, 1e-100 to 1e100, got 0.0",
    ),
    "no end": (
        lambda: model(t_end=np.inf),
        "t_end: expected a positive time, 1e-100 to 1e100, got inf",
    ),
    "a step backwards": (
        lambda: model(step=-1e-3),
        "step: expected a positive time, 1e-100 to 1e100, got -0.001",
    ),
    "a radius above one": (
        lambda: model(rho_inf=1.5),
        "rho_inf: expected a number from 0 to 1, got 1.5",
    ),
    "an unknown rule": (
        lambda: model(rule="exact"),
        "rule: expected 'consistent' or 'paper', got 'exact'",
    ),
    "an unknown history": (
        lambda: model(history="modal"),
        "history: expected 'auto', 'recursive', 'direct' or 'fft', got 'modal'",
    ),
    "a memory of no length": (
        lambda: model(kernel_length=0.0),
        "kernel_length: expected a positive time, 1e-100 to 1e100, got 0.0",
    ),
    "a tolerance of one": (
        lambda: model(tolerance=1.0),
        "tolerance: expected a number between 0 and 1, got 1.0",
    ),
    "no iterations": (lambda: model(max_iterations=0), "max_iterations: expected 1 to 1000, got 0"),
}


@pytest.mark.parametrize("name", MADE)
def test_a_model_that_cannot_be_made(name):
    make, message = MADE[name]
    with pytest.raises(ModelError, match=re.escape(message)):
        make()


def circle():
    return model(
        bodies={
            "a": body(start=Start(place=Place("f", "b.f"))),
            "b": body(start=Start(place=Place("f", "a.f"))),
        }
    )


def two_pins(*others):
    """Two bodies on two spherical joints, which both keep their distance."""
    frames = {"low": Frame([0.5, 0, 0]), "high": Frame([0.5, 0.3, 0])}
    opposite = {"low": Frame([-0.5, 0, 0]), "high": Frame([-0.5, 0.3, 0])}
    bodies = {
        "a": RigidBody(1.0, [1.0, 2.0, 1.5], frames),
        "b": RigidBody(1.0, [1.0, 2.0, 1.5], opposite, Start([1.0, 0, 0])),
    }
    pins = [Spherical(f"a.{name}", f"b.{name}", name=name) for name in ("low", "high")]
    joints = [other for other in others if isinstance(other, Joint)]
    motions = [other for other in others if not isinstance(other, Joint)]
    return model((*pins, *joints), bodies=bodies, motions=motions)


STARTED = {
    "a circle of places": (circle, "bodies a, b: they are placed on one another in a cycle"),
    "an open joint": (
        lambda: model((weld("a", "b"),)),
        "joint 'weld': open by 1 m at the start: a is at [0.0, 0.0, 0.0], b at [1.0, 0.0, 0.0]",
    ),
    "a distance that starts elsewhere": (
        lambda: model(
            (Prismatic("a", "b", [1, 0, 0], name="j", distance=Polynomial((0.75, 1.0))),)
        ),
        "joint 'j': open by 0.25 m at the start: a is at [0.0, 0.0, 0.0], b at [1.0, 0.0, 0.0], "
        "the distance starts at 0.75",
    ),
    "redundant joints": (
        lambda: model((weld("a.f", "b.f"), Revolute("a.f", "b.f", [0, 0, 1], name="again"))),
        "joints: 11 constraints of which 5 are redundant; dependent constraints: weld "
        "(translation 1, translation 2, "
        "translation 3, rotation 2, rotation 3), again (translation 1, translation 2, "
        "translation 3, rotation 1, "
        "rotation 2); free a joint, or set redundant = 'remove' to drop again (translation 1, "
        "translation 2, "
        "translation 3, rotation 1, rotation 2)",
    ),
    "drives that fight": (
        lambda: model(
            (
                weld("a.f", "b.f"),
                Revolute("a.f", "b.f", [0, 0, 1], name="motor", angle=Harmonic(1.0, 1.0)),
            ),
        ),
        "joints: motor (rotation 3) is driven against other constraints: dependent constraints: "
        "weld (translation 1, ",
    ),
    "one constraint too many": (
        two_pins,
        "joints: 6 constraints of which 1 is redundant; dependent constraints: low "
        "(translation 2), high (translation 2); free a joint, or set redundant = 'remove' to drop "
        "high (translation 2)",
    ),
    "pins that are driven apart": (
        lambda: two_pins(
            PrescribedDisplacement("push", "b", [0, 1, 0], Polynomial((0.0, 1.0))),
            weld("ground", "a"),
        ),
        "joints: push (translation 1) is driven against other constraints: dependent "
        "constraints: low (translation 1, ",
    ),
    "no step": (
        lambda: model(step=None),
        "simulation: step: required in a model without superelements",
    ),
}


@pytest.mark.parametrize("name", STARTED)
def test_a_model_that_cannot_start(name, tmp_path):
    make, message = STARTED[name]
    path = tmp_path / "results.h5"
    with pytest.raises(ModelError, match=re.escape(message)):
        simulate(make(), output=path)
    assert not path.exists()


@pytest.fixture(scope="module")
def element(random_element):
    return random_element(1, (True, False))


def flexible(**bodies):
    return {name: FlexibleBody(element) for name, element in bodies.items()}


def test_a_flexible_body_is_joined_by_an_interface(element):
    with pytest.raises(
        ModelError,
        match=re.escape(
            "joint 'j': 'e' is flexible: name one of its interfaces (i0, i1) as e.INTERFACE"
        ),
    ):
        Model(flexible(e=element), (Spherical("ground", "e", name="j"),))


def test_an_interface_without_rotations_carries_no_moments(element):
    start = {"e": FlexibleBody(element)}
    with pytest.raises(
        ModelError,
        match=re.escape("joint 'j' (fixed): interface 'e.i1' has no rotations and carries"),
    ):
        simulate(Model(start, (Fixed("ground", "e.i1", name="j"),)))
    load = Torque("e.i1", [1, 0, 0], Constant(1.0))
    with pytest.raises(
        ModelError,
        match=re.escape("torque on 'e.i1': interface 'e.i1' has no rotations and carries"),
    ):
        simulate(Model(start, (), (load,)))


def test_superelements_of_different_steps_ask_for_one(element):
    other = replace(element, kernel=sample_kernel(element.modes, 2e-3, GeneralizedAlpha(0.7), 200))
    model = Model(flexible(e=element, f=other), settings=Settings(t_end=0.01, rho_inf=0.9))
    with pytest.raises(
        ModelError,
        match=re.escape(
            "simulation: step: the superelements differ (e: 0.001, f: 0.002), so the model must"
        ),
    ):
        simulate(model)
    with pytest.raises(
        ModelError,
        match=re.escape("simulation: rho_inf: the superelements differ (e: 0.9, f: 0.7)"),
    ):
        simulate(model.with_settings(step=1e-3, rho_inf=None))
    assert simulate(model.with_settings(step=1e-3)).solver["h"] == 1e-3


def test_a_kernel_alone_has_one_step_and_one_length(element, measured):
    model = Model(flexible(e=measured(element)), settings=Settings(t_end=0.05))
    with pytest.raises(ModelError, match=r"superelement random 1: .*0.002"):
        simulate(model.with_settings(step=2e-3))
    with pytest.raises(ModelError, match=r"superelement random 1: .*0.8"):
        simulate(model.with_settings(rho_inf=0.8))
    with pytest.raises(ModelError, match=r"superelement random 1: .*200"):
        simulate(model.with_settings(t_end=0.3))


def test_a_load_that_is_no_number_stops_the_run():
    signal = Function(lambda t: float("nan") if t > 0.0551 else 1.0)
    with pytest.raises(
        ConvergenceError, match=r"no convergence in step 6 \(t = 0.06 s\): relative residual inf"
    ):
        simulate(model((), (Force("a", [1, 0, 0], signal),)))


FILE = """
[simulation]
t_end = 0.1
step = 0.01
{simulation}

[bodies.a]
mass = 1.0
inertia = [1, 1, 1]
{body}

{rest}
"""

FILES = {
    "simulation.t_ned": (
        {"simulation": "t_ned = 1"},
        "simulation: unknown key 't_ned'; did you mean 't_end'?",
    ),
    "a joint of Adams": (
        {
            "rest": "[bodies.c]\nmass = 1\ninertia = [1, 1, 1]\n"
            "[[joints]]\nname = 'a'\ntype = 'hinge'\nbetween = ['ground', 'c']"
        },
        "found 'hinge'; did you mean 'revolute'?",
    ),
    "a damper": (
        {"rest": "[[springs]]\nname = 's'\ntype = 'damper'\nbetween = ['ground', 'a']"},
        "got 'damper'; did you mean 'point'?",
    ),
    "a table twice": (
        {"rest": "[joints]\nname = 'a'\n[joints]\nname = 'b'"},
        "'[joints]'; a table is written once, and each of several joints or loads as [[joints]]",
    ),
    "a comma": ({"simulation": "rho_inf = 0,9"}, "'rho_inf = 0,9'; decimals take a point"),
    "no quotes": ({"simulation": "start = equilibrium"}, "; texts take quotes"),
    "yes": ({"simulation": "rho_inf = yes"}, "; expected true or false"),
    "a body file for a superelement": (
        {"rest": "[bodies.b]\nsuperelement = 'model.toml'"},
        "a TOML file: duhamel preprocess makes",
    ),
    "a slip": (
        {"simulation": "rule = 'papr'"},
        "found 'papr'; did you mean 'paper'?",
    ),
    "unknown": ({"rest": "[[joint]]\nname = 'a'"}, "unknown key 'joint'; did you mean 'joints'?"),
    "gravity": (
        {"simulation": "gravity = [0, 1]"},
        "simulation.gravity: expected three numbers, found [0, 1]",
    ),
    "rule": (
        {"simulation": "rule = 'exact'"},
        "simulation.rule: input should be 'consistent' or 'paper', found 'exact'",
    ),
    "rho_inf": (
        {"simulation": "rho_inf = 2"},
        "simulation.rho_inf: expected a number from 0 to 1, found 2",
    ),
    "two kinds of body": (
        {"body": "superelement = 'a.h5'"},
        "bodies.a: the superelement already gives mass, inertia: leave these keys out",
    ),
    "no kind of body": (
        {"rest": "[bodies.b]\nmass = 1.0"},
        "bodies.b: expected mass and inertia of a rigid body, or superelement",
    ),
    "no superelement": ({"rest": "[bodies.b]\nsuperelement = 'none.h5'"}, "none.h5: no such file"),
    "a signal that is none": (
        {"rest": "[[loads]]\ntype='force'\non='a'\ndirection=[1,0,0]\nsignal={wave = 1}"},
        "load (force) on 'a': signal: expected a number or a table with one of the keys times, "
        "amplitude, polynomial, "
        "impulse, pulse, input, sum, "
        "product, delay, smooth_step, half_sine, trapezoid, sawtooth, window, chirp, noise, "
        "spectrum, file, found {'wave': 1}",
    ),
    "a signal that is nearly one": (
        {"rest": "[[loads]]\ntype='force'\non='a'\ndirection=[1,0,0]\nsignal={polynomal = [1]}"},
        "load (force) on 'a': signal: expected a number or a table with one of the keys times, "
        "amplitude, polynomial, "
        "impulse, pulse, input, sum, "
        "product, delay, smooth_step, half_sine, trapezoid, sawtooth, window, chirp, noise, "
        "spectrum, file, found {'polynomal': [1]}; did you mean 'polynomial'?",
    ),
    "a key of a signal": (
        {
            "rest": "[[loads]]\ntype='force'\non='a'\ndirection=[1,0,0]\n"
            "signal={amplitude = 1, frequenzy = 2}"
        },
        "load (force) on 'a': signal: unknown key 'frequenzy'; did you mean 'frequency'?",
    ),
    "a value of a signal": (
        {
            "rest": "[[loads]]\ntype='force'\non='a'\ndirection=[1,0,0]\n"
            "signal={times = [0], values = ['1']}"
        },
        "load (force) on 'a': signal: values.0: input should be a valid number, found '1'",
    ),
    "a signal of two kinds": (
        {
            "rest": "[[loads]]\ntype='force'\non='a'\ndirection=[1,0,0]\n"
            "signal={times = [0, 1], values = [0, 1], linear = true, spline = true}"
        },
        "load (force) on 'a': signal: expected linear or spline, found both",
    ),
    "a load of no type": (
        {"rest": "[[loads]]\ntype='push'\non='a'\ndirection=[1,0,0]\nsignal=1"},
        "loads.0.type: expected 'force', 'torque', 'drag' or 'pattern', found 'push'",
    ),
    "a law of one point": (
        {
            "rest": "[[springs]]\nname='s'\ntype='point'\nbetween=['ground', 'a']\n"
            "law={deformation = [0], force = [1]}"
        },
        "spring 's': law: a law needs two or more points, got [0.0] and [1.0]",
    ),
    "a law that goes back": (
        {
            "rest": "[[springs]]\nname='s'\ntype='point'\nbetween=['ground', 'a']\n"
            "law={deformation = [1, 0], force = [0, 1]}"
        },
        "spring 's': law: deformation: expected increasing values, got [1.0, 0.0]",
    ),
    "a setting that is no number": (
        {"simulation": "tolerance = 'fine'"},
        "simulation.tolerance: expected a number between 0 and 1, found 'fine'",
    ),
    "half an iteration": (
        {"simulation": "max_iterations = 2.5"},
        "simulation.max_iterations: expected 1 to 1000, found 2.5",
    ),
    "a key by its name in Python": (
        {"simulation": "kernel_length = 1"},
        "simulation: unknown key 'kernel_length'; known are",
    ),
    "a joint to nothing": (
        {"rest": "[[joints]]\nname='j'\ntype='fixed'\nbetween=['ground', 'b']"},
        "joint 'j': no body 'b'; there are: ground, a",
    ),
    "a mass below zero": (
        {"rest": "[bodies.b]\nmass = -1.0\ninertia = [1, 1, 1]"},
        "bodies.b.mass: expected a positive number, 1e-100 to 1e100, found -1.0",
    ),
    "an inertia of nothing": (
        {"rest": "[bodies.b]\nmass = 1.0\ninertia = [1, 1, -1]"},
        "bodies.b: inertia: expected positive principal values",
    ),
    "no TOML": ({"rest": "[bodies"}, "not a TOML file"),
}


@pytest.mark.parametrize("name", FILES)
def test_a_model_file_that_says_what_cannot_be(name, tmp_path):
    """The message names the file, the key, what was found and what was expected."""
    parts, message = FILES[name]
    path = tmp_path / "model.toml"
    path.write_text(FILE.format(**{"simulation": "", "body": "", "rest": ""} | parts))
    with pytest.raises(ModelError) as caught:
        read_model(path)
    assert str(path) in str(caught.value)
    assert message in str(caught.value)


def test_a_model_file_that_is_not_there(tmp_path):
    with pytest.raises(
        ModelError, match=re.escape(f"{tmp_path / 'none.toml'}: not a readable file")
    ):
        read_model(tmp_path / "none.toml")


SIGNALS = {
    "2.5": Constant(2.5),
    "{times = [0, 0.05], values = [1, 0]}": Steps((0.0, 0.05), (1.0, 0.0)),
    "{amplitude = 1, frequency = 50, offset = 2}": Harmonic(1.0, 50.0, 0.0, 2.0),
    "{polynomial = [1, 2, 3]}": Polynomial((1.0, 2.0, 3.0)),
}


def test_a_model_file_becomes_the_model_it_describes(element, tmp_path):
    write(tmp_path / "e.h5", element)
    loads = "\n".join(
        "[[loads]]\ntype = 'force'\non = 'e.i0'\ndirection = [0, 0, 2]\nfollower = "
        f"true\nsignal = {signal}"
        for signal in SIGNALS
    )
    text = FILE.format(
        simulation="gravity = [0, 0, -9.81]\nhistory = 'direct'",
        body="frames.f = {position = [1, 0, 0], rotation = [0, 0, 1]}\n"
        "angular_velocity = [0, 0, 3]",
        rest="[ground]\nframes.wall = {position = [0, 1, 0]}\n"
        "[bodies.e]\nsuperelement = 'e.h5'\nplace = {frame = 'i0', on = 'a.f'}\n"
        "[bodies.twin]\nsuperelement = 'e.h5'\n"
        "[[joints]]\nname = 'j'\ntype = 'cylindrical'\nbetween = ['ground.wall', 'a']\naxis = "
        "[0, 0, 1]\n"
        "angle = {amplitude = 1, frequency = 2}\n" + loads,
    )
    path = tmp_path / "model.toml"
    path.write_text(text)
    model = read_model(path)
    assert list(model.bodies) == ["a", "e", "twin"]
    assert model.bodies["e"].superelement is model.bodies["twin"].superelement
    assert model.bodies["e"].start.place == Place("i0", "a.f")
    assert (model.gravity, model.settings.history, model.settings.step, model.source) == (
        pytest.approx([0, 0, -9.81]),
        "direct",
        0.01,
        text,
    )
    assert model.bodies["a"].frames["f"].rotation == pytest.approx([0, 0, 1])
    assert model.bodies["a"].start.angular_velocity == pytest.approx([0, 0, 3])
    assert model.ground_frames["wall"].position == pytest.approx([0, 1, 0])
    (joint,) = model.joints
    assert (joint.type, joint.between, joint.angle) == (
        "cylindrical",
        ("ground.wall", "a"),
        Harmonic(1.0, 2.0),
    )
    assert [load.signal for load in model.loads] == list(SIGNALS.values())
    assert all(load.follower and load.direction[2] == 2.0 for load in model.loads)
