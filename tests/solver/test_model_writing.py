"""Models written to files and read back."""

import os
import re
import tomllib
from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from duhamel.solver import (
    JOINTS,
    LOADS,
    Chirp,
    Constant,
    Delayed,
    Drag,
    FlexibleBody,
    Force,
    Frame,
    Function,
    HalfSine,
    Harmonic,
    Haversine,
    Impulse,
    Input,
    LogarithmicChirp,
    Model,
    ModelError,
    Noise,
    OutputRequest,
    PatternLoad,
    Place,
    Polynomial,
    PrescribedDisplacement,
    PrescribedOrientation,
    PrescribedRotation,
    Product,
    Pulse,
    Recorded,
    RecordedSpline,
    RigidBody,
    Sawtooth,
    Settings,
    ShapedNoise,
    SmoothFunction,
    SmoothStep,
    Spline,
    Spring,
    Start,
    SteadyRotation,
    Steps,
    Sum,
    Table,
    TabulatedLaw,
    Trapezoid,
    Window,
    read_model,
    write_model,
)
from duhamel.solver.couplings.motions import PrescribedMotion
from duhamel.solver.couplings.springs import SPRING_TYPES
from duhamel.solver.signals import signal as signals
from duhamel.superelement import (
    Channels,
    Interface,
    Pattern,
    Superelement,
    Surface,
    Surfaces,
    write,
)

from .linkages import n_axes

EXAMPLES = Path(__file__).parents[2] / "examples"
MODELS = [path for path in sorted(EXAMPLES.glob("*.toml")) if "[bodies" in path.read_text()]
POINTS = (0.0, 0.1, 0.3), (0.0, 1.0 / 3.0, -np.pi)
SIGNALS = (
    Constant(0.1),
    Steps(*POINTS),
    Table(*POINTS),
    Spline(*POINTS),
    Harmonic(1.0 / 3.0, 7.0, 0.1, -0.2),
    Polynomial((0.1, 2.0 / 7.0)),
    Impulse(1e-3, 0.02),
    Pulse(5.0, 0.1, 0.2),
    Input("motor", 0.5),
    SmoothStep((0.0, 1.0 / 3.0), (0.1, 0.2)),
    Haversine((0.0, 1.0 / 3.0), (0.1, 0.2)),
    HalfSine(490.0, 6e-3),
    Trapezoid(1.0, 0.1, 1.0 / 30.0, 0.02, 0.1),
    Sawtooth(1.0, 0.1, 0.2),
    Window((0.0, 1.0), 1.0 / 3.0, 0.5),
    Chirp(1.0, (5.0, 500.0 / 3.0), (0.0, 1.0), 0.1),
    LogarithmicChirp(1.0, (5.0, 500.0 / 3.0), (0.0, 1.0), 0.1),
    Noise(0.1, (5.0, 50.0), 1.0 / 3.0, 5),
    ShapedNoise(((5.0, 0.1), (50.0, 1.0 / 3.0)), 1.0),
    Sum((Constant(1.0), Sum((Harmonic(0.1, 3.0), Impulse(1.0, 0.1))))),
    Product((Constant(1.0 / 3.0), Table(*POINTS), Window((0.0, 1.0), 0.1, 0.5))),
    Delayed(1.0 / 3.0, Spline(*POINTS)),
)


def content(value):
    """The numbers, words and signals in a model, without where its text and files are."""
    if isinstance(value, Superelement):
        return value.name, value.mass, value.J_rot.tolist()
    if is_dataclass(value):
        found = {field.name: getattr(value, field.name) for field in fields(value) if field.init}
        if isinstance(value, FlexibleBody):
            found["source"] = os.path.realpath(value.source)
        if isinstance(value, Model):
            del found["source"], found["path"]
        return type(value).__name__, content(found)
    if isinstance(value, Mapping):
        return {key: content(part) for key, part in value.items()}
    if isinstance(value, tuple | list):
        return [content(part) for part in value]
    return value.tolist() if isinstance(value, np.ndarray) else value


def frames_used(document, body):
    """The frames of a body that a model file names."""
    named = re.findall(rf"'{body}\.(\w+)'", repr(document))
    return {*named, document["bodies"][body].get("place", {}).get("frame", "root")}


def surfaces_used(document, bodies):
    """The surfaces of some bodies that the contacts of a model file name."""
    places = [place for one in document.get("contacts", []) for place in one.get("surfaces", [])]
    named = [place.partition(".") for place in places]
    return sorted({name for body, _, name in named if body in bodies})


def surfaces_of(element, names):
    """One square for each name, whose nodes the modes of an element move at random."""
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    square = np.arange(4)[None], "quad", np.tile([0.0, 0.0, 1.0], (4, 1)), 1.0
    patches = [
        Surface(name, np.arange(4) + 4 * k, corners, *square) for k, name in enumerate(names)
    ]
    omega = element.modes.omega
    phi = np.random.default_rng(0).normal(size=(12 * len(names), len(omega)))
    return Surfaces(tuple(patches), phi, (phi / omega**2) @ phi.T + 1e-6 * np.eye(len(phi)))


@pytest.mark.parametrize("source", MODELS, ids=lambda path: path.stem)
def test_the_examples_come_back_as_they_were(source, random_element, with_second_order, tmp_path):
    """With superelements of random numbers in the places of theirs."""
    document = tomllib.loads(source.read_text())
    path = tmp_path / "examples" / source.name
    path.parent.mkdir()
    path.write_text(source.read_text())
    for record in source.parent.glob("*.csv"):
        (path.parent / record.name).write_text(record.read_text())
    needed, bodies_of = {}, {}
    for body, given in document["bodies"].items():
        if "superelement" in given:
            element = (path.parent / given["superelement"]).resolve()
            bodies_of.setdefault(element, []).append(body)
            frames = frames_used(document, body) - {*surfaces_used(document, [body])}
            needed.setdefault(element, set()).update(frames)
    for number, (element, names) in enumerate(needed.items()):
        made = with_second_order(random_element(number, (True,) * len(names), steps=10))
        named = zip(made.interfaces, sorted(names), strict=True)
        interfaces = tuple(Interface(name, old.X, True) for old, name in named)
        patterns = [load["pattern"] for load in document.get("loads", []) if "pattern" in load]
        if patterns:
            phi = np.zeros((len(patterns), len(made.modes.omega)))
            spread = tuple(Pattern(name, np.zeros(3), np.zeros(3)) for name in patterns)
            made = replace(made, channels=Channels(spread, (), phi))
        if touching := surfaces_used(document, bodies_of[element]):
            made = replace(made, surfaces=surfaces_of(made, touching))
        element.parent.mkdir(parents=True, exist_ok=True)
        write(element, replace(made, interfaces=interfaces))
    model = read_model(path)
    written = tmp_path / "elsewhere" / "again" / "model.toml"
    written.parent.mkdir(parents=True)
    write_model(written, model)
    assert content(read_model(written)) == content(model)


def body(k, **start):
    inertia = [[1.0 / 3.0, 0.01, 0.0], [0.01, 0.4, 0.002], [0.0, 0.002, 0.5]]
    frames = {"f": Frame([0.5, 1.0 / 7.0, 0], [0.1, 0, np.pi / 3]), "g": Frame()}
    return RigidBody(1.0 + k / 3.0, inertia if k % 2 else [1.0, 2.0, 1.5], frames, Start(**start))


@pytest.fixture
def everything(random_element, tmp_path):
    """A model of every kind of joint, spring, motion, load and signal, with no setting as it is by
    default.
    """
    rng = np.random.default_rng(0)
    sheet = tmp_path / "records" / "shaker.csv"
    sheet.parent.mkdir()
    sheet.write_text("t,ax\n0,1\n0.3,2\n")
    recorded = Recorded(sheet, "ax", 9.81), RecordedSpline(sheet, 2, 1.0, "t", 1e-3, 0.1)
    spread = Channels((Pattern("wind", np.zeros(3), np.zeros(3)),), (), None)
    element = random_element(1, (True, False))
    phi = np.zeros((1, len(element.modes.omega)))
    element = replace(element, channels=replace(spread, phi=phi))
    write(tmp_path / "e.h5", element)
    names = [f"b{k}" for k in range(len(JOINTS) + 1)]
    bodies = {name: body(k, position=rng.normal(size=3)) for k, name in enumerate(names)}
    bodies["placed"] = body(1, place=Place("f", "b0.g"))
    place = Start(rng.normal(size=3), rng.normal(size=3))
    bodies["e"] = FlexibleBody(element, place, str(tmp_path / "e.h5"))
    axes = {"axis": rng.normal(size=3)}, {"axis": [1, 1, 0], "second_axis": [1, -1, 0]}
    smooth = {"angle": Harmonic(0.1, 3.0), "distance": Spline(*POINTS)}
    smooth |= {"second_angle": Polynomial((0.0, 0.1)), "rotation_vector": [Constant(0.1)] * 3}
    only = {"screw": "angle", "spherical": "rotation_vector"}
    joints = []
    for k, (name, kind) in enumerate(JOINTS.items()):
        given = axes[n_axes(name) - 1] if n_axes(name) else {}
        driven = [only[name]] if name in only else sorted(smooth.keys() & vars(kind).keys())
        given = given | {drive: smooth[drive] for drive in driven}
        given |= {"lead": 0.02} if name == "screw" else {}
        given |= {"radius": 0.3} if name == "rolling_disc" else {}
        given |= {"reference_coordinates": {"angle": 0.25}} if name == "cylindrical" else {}
        if name == "planar":
            given["start"] = {"angle": 1.0 / 3.0}
        joints.append(JOINTS[name](f"b{k}.f", f"b{k + 1}.g", name=name, **given))
    half = rng.normal(size=(6, 6))
    springs = (
        Spring("point", "point", ("b0", "ground.wall"), stiffness=1.0 / 3.0, rest=0.1),
        Spring(
            "coil",
            "torsion",
            ("b0", "b3"),
            [0, 1, 1],
            damping=2.0,
            law=TabulatedLaw((-1, 2), (-3, 4)),
        ),
        Spring("soft", "bushing", ("b0.f", "e.i0"), stiffness=rng.uniform(size=6)),
        Spring(
            "mount", "bushing", ("b0", "b4"), [1, 2, 3], half + half.T, half @ half.T, None, half[0]
        ),
    )
    motions = (
        PrescribedDisplacement("push", "b1.f", rng.normal(size=3), Polynomial((0.0, 1.0 / 3.0))),
        PrescribedRotation("turn", "b2", [1, 2, 3], Constant(0.0)),
        PrescribedOrientation("tilt", "b3", angular_accelerations=[Constant(1.0), *SIGNALS[1:3]]),
        PrescribedDisplacement(
            "go", "b4", [1, 2, 3], acceleration=recorded[0], start={"displacement_rate": 1.0 / 3.0}
        ),
    )
    kinds = ["force", "torque"]
    loads = [
        LOADS[kinds[k % 2]]("b0.f", rng.normal(size=3), signal, follower=k % 3 == 0)
        for k, signal in enumerate([*SIGNALS, *recorded])
    ]
    loads += [
        Drag("b0.f", quadratic=1.0 / 3.0, linear=0.1, signal=Harmonic(0.1, 3.0)),
        PatternLoad("e", element.patterns[0].name, Constant(1.0 / 3.0)),
    ]
    settings = Settings(
        t_end=1.0 / 3.0,
        step=1e-3,
        contact_step=1e-5,
        rho_inf=0.8,
        rule="paper",
        history="recursive",
        kernel_length=0.1,
        tolerance=1e-9,
        max_iterations=30,
        fixed_iterations=2,
        start="equilibrium",
        steady_rotation=SteadyRotation([0, 0, 1.0 / 3.0], [1, 2, 3]),
        assemble=True,
        redundant="remove",
        checkpoint={"every": 100},
        output=OutputRequest(3, ("bodies", "joints/fixed")),
    )
    return Model(
        bodies,
        joints,
        loads,
        springs,
        motions,
        gravity=[0, 0.1, -9.81],
        ground_frames={"wall": Frame([0, 0, 1.0 / 3.0])},
        settings=settings,
    )


def test_a_model_of_everything_comes_back_exactly(everything, tmp_path):
    assert {joint.type for joint in everything.joints} == set(JOINTS)
    assert {spring.type for spring in everything.springs} == set(SPRING_TYPES)
    assert {type(motion) for motion in everything.motions} == set(PrescribedMotion.__subclasses__())
    assert {load.tag for load in everything.loads} == set(LOADS)
    known = {form.kind for forms in signals.SIGNAL_FORMS.forms.values() for form in forms}
    assert {type(load.signal) for load in everything.loads} == known | {Constant}
    default = Settings(t_end=1.0)
    for field in fields(Settings):
        assert getattr(everything.settings, field.name) != getattr(default, field.name)
    path = tmp_path / "model.toml"
    write_model(path, everything)
    again = read_model(path)
    assert content(again) == content(everything)
    write_model(path, again)
    assert path.read_text() == again.source


def test_defaults_are_left_out(tmp_path):
    path = tmp_path / "model.toml"
    write_model(path, Model({"a": RigidBody(1.0, [1, 1, 1])}))
    document = {
        "simulation": {"t_end": 1.0},
        "bodies": {"a": {"mass": 1.0, "inertia": [1.0, 1.0, 1.0]}},
    }
    assert tomllib.loads(path.read_text()) == document


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda model: {"bodies": {**model.bodies, "e": replace(model.bodies["e"], source="")}},
            "body 'e': its superelement is not in a file",
        ),
        (
            lambda model: {"loads": [Force("b0.f", [1, 0, 0], Function(np.sin))]},
            "load (force) on 'b0.f': signal: a Function cannot be written to a file",
        ),
        (
            lambda model: {
                "motions": [
                    PrescribedRotation(
                        "turn", "b0", [1, 0, 0], SmoothFunction(np.sin, np.cos, np.sin)
                    )
                ]
            },
            "motion 'turn': angle: a SmoothFunction cannot be written to a file",
        ),
    ],
)
def test_what_no_file_can_say_leaves_the_file_that_was_there(everything, tmp_path, change, message):
    path = tmp_path / "model.toml"
    write_model(path, everything)
    before = path.read_text(), sorted(tmp_path.iterdir())
    with pytest.raises(ModelError, match=re.escape(message)):
        write_model(path, replace(everything, **change(everything)))
    assert (path.read_text(), sorted(tmp_path.iterdir())) == before


def test_a_file_is_whole_or_not_there(everything, tmp_path, monkeypatch):
    def full(self, *_, **__):
        raise OSError("no space left on device")

    monkeypatch.setattr(Path, "write_text", full)
    with pytest.raises(ModelError, match=r"model\.toml: cannot be written: no space left"):
        write_model(tmp_path / "model.toml", everything)
    assert {path.name for path in tmp_path.iterdir()} == {"e.h5", "records"}
