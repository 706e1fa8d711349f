"""Random mechanisms: trees and closed loops of rigid and flexible bodies, with joints of all kinds,
springs, loads and gravity.

Sizes are those of a desk: bodies of some 0.2 m and 0.1 kg that turn by some rad/s. A body hangs on
one before it, or on the ground, or flies. A link closes a loop: a rigid body made to measure, on
two spherical joints.
"""

import warnings
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import product
from tempfile import TemporaryDirectory

import numpy as np
from duhamel.solver import (
    JOINTS,
    LOADS,
    Constant,
    Contact,
    ConvergenceError,
    FlexibleBody,
    Frame,
    Harmonic,
    Impact,
    Model,
    ModelError,
    OutOfRangeError,
    RigidBody,
    Settings,
    Spherical,
    Spring,
    Start,
    ValidityWarning,
    simulate,
)
from hypothesis import reject
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from ..frameworks import bar, framework
from ..linkages import n_axes

GROUND = "ground"
STEP, STEPS = 5e-4, 24
KINDS = sorted(JOINTS.keys() - {"rod", "rolling_disc"})
"""of joints between frames in one place, where a rod has no direction"""
ROUNDED = 1e-6
"""[m] a gap that rounding does not close"""
BEFORE = {"bar": "left", "wing": "left"}
"""the interface by which a flexible body hangs on the one before it"""


@cache
def element(name):
    """A soft bar, or a soft T: superelements that all mechanisms share."""
    with TemporaryDirectory() as folder:
        if name == "bar":
            return bar(folder, 0.2, elements=3, stiffness=0.05)
        middle, points = (
            (0.1, 0, 0),
            {"left": (0, 0, 0), "right": (0.2, 0.05, 0), "tip": (0.1, 0, 0.15)},
        )
        ends = [(middle, point) for point in points.values()]
        return framework(folder, ends, points, elements=2, stiffness=0.05)


def numbers(limit):
    """Round ones, which are easy to read in a failure."""
    return st.integers(-100, 100).map(lambda n: n * limit / 100)


def between(low, high):
    return st.integers(0, 100).map(lambda n: low + n * (high - low) / 100)


def vectors(limit):
    return st.tuples(*[numbers(limit)] * 3).map(np.array)


@st.composite
def directions(draw):
    """Unit vectors: on a sphere of integers none is short."""
    axis = np.array(draw(st.tuples(*[st.integers(-4, 4)] * 3).filter(any)), dtype=float)
    return axis / np.linalg.norm(axis)


@st.composite
def geometry_of(draw, kind):
    """The axes, and the lead of a screw, that a joint of this kind takes."""
    n = n_axes(kind)
    if n == 0:
        return {}
    axis = draw(directions())
    if kind == "screw":
        return {"axis": axis, "lead": draw(between(0.02, 0.2))}
    if n == 1:
        return {"axis": axis}
    other = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    return {"axis": axis, "second_axis": other / np.linalg.norm(other)}


@dataclass
class Sketch:
    """A mechanism as it grows: bodies, couplings, and where frames are in space at the start."""

    bodies: dict = field(default_factory=dict)
    joints: list = field(default_factory=list)
    springs: list = field(default_factory=list)
    contacts: list = field(default_factory=list)
    loads: list = field(default_factory=list)

    def place(self, reference):
        """Of a frame "BODY.FRAME", in space."""
        name, _, frame = reference.partition(".")
        start = self.bodies[name].start
        turn = Rotation.from_rotvec(start.rotation)
        return start.position + turn.apply(self.bodies[name].frames[frame].position)

    def frames(self):
        return [f"{name}.{frame}" for name, body in self.bodies.items() for frame in body.frames]

    def is_slim(self, reference):
        body = self.bodies[reference.partition(".")[0]]
        return np.linalg.eigvalsh(body.inertia)[0] < 1e-6

    def new(self, prefix):
        parts = self.bodies, self.joints, self.springs, self.contacts
        return f"{prefix}{sum(map(len, parts))}"


@st.composite
def rigid_bodies(draw):
    """A cuboid's inertia, and two frames."""
    mass = draw(between(0.02, 0.3))
    a, b, c = np.array(draw(st.tuples(*[between(0.05, 0.2)] * 3))) ** 2
    inertia = mass / 3.0 * np.array([b + c, c + a, a + b])
    frames = {
        "left": Frame([-0.1, *draw(st.tuples(numbers(0.05), numbers(0.05)))], draw(vectors(1.0))),
        "right": Frame([0.1, *draw(st.tuples(numbers(0.05), numbers(0.05)))], draw(vectors(1.0))),
    }
    return RigidBody(mass, inertia, frames)


@st.composite
def bodies(draw):
    """A body, at rest at the origin."""
    kind = draw(st.sampled_from(["rigid", "bar", "wing"]))
    return draw(rigid_bodies()) if kind == "rigid" else FlexibleBody(element(kind))


@st.composite
def starts(draw, body, point):
    """Some orientation and velocities, with the frame `left` of the body at a point (3,)."""
    turn = Rotation.from_rotvec(draw(vectors(1.5)))
    return Start(
        point - turn.apply(body.frames["left"].position),
        turn.as_rotvec(),
        velocity=draw(vectors(0.5)),
        angular_velocity=draw(vectors(4.0)),
    )


def hang(draw, sketch, free):
    """One more body, on a joint to one before it or to the ground, or on none."""
    name, body = sketch.new("b"), draw(bodies())
    supports = sketch.frames() if free else [GROUND, *sketch.frames()]
    support = draw(st.sampled_from(supports)) if supports and draw(st.integers(0, 4)) else None
    point = draw(vectors(0.3)) if support in (None, GROUND) else sketch.place(support)
    sketch.bodies[name] = replace(body, start=draw(starts(body, point)))
    if support is not None:
        kind = draw(st.sampled_from(KINDS))
        geometry = draw(geometry_of(kind))
        sketch.joints.append(
            JOINTS[kind](support, f"{name}.left", name=sketch.new("j"), **geometry)
        )


def link(draw, sketch):
    """A rigid body on spherical joints between frames of two others, which closes a loop."""
    if (pair := draw(pairs(sketch))) is None:
        reject()
    first, second = pair
    A, B = sketch.place(first), sketch.place(second)
    name, middle, length = sketch.new("b"), 0.5 * (A + B), float(np.linalg.norm(B - A))
    frames = {"left": Frame(A - middle), "right": Frame(B - middle)}
    sketch.bodies[name] = RigidBody(
        0.05, np.full(3, 0.05 * (0.05 + length) ** 2), frames, Start(middle)
    )
    for end, frame in zip((first, second), frames, strict=True):
        sketch.joints.append(Spherical(end, f"{name}.{frame}", name=sketch.new("j")))


def spring(draw, sketch, conservative):
    """A point spring or a bushing between frames of two bodies."""
    if (frames := draw(pairs(sketch))) is None:
        reject()
    kind = draw(st.sampled_from(["point", "bushing"]))
    n = 1 if kind == "point" else 6
    scale = np.repeat([1.0, 0.01], 3)[:n]
    positive = between(0.5, 50.0)
    stiffness = scale * draw(st.tuples(*[positive] * n))
    damping = np.zeros(n) if conservative else 1e-3 * scale * draw(st.tuples(*[positive] * n))
    axis = {"axis": draw(directions())} if kind == "bushing" and draw(st.booleans()) else {}
    sketch.springs.append(
        Spring(sketch.new("s"), kind, frames, stiffness=stiffness, damping=damping, **axis)
    )


def contact(draw, sketch, conservative, rubs):
    """A soft ball that just touches a plane or a sphere on another body, or nearly so.

    Not on bars: about their axes they are too light for any step.
    """
    if (pair := draw(pairs(sketch, slim=False))) is None:
        return
    first, second = pair
    gap = sketch.place(second) - sketch.place(first)
    depth, sphere = draw(between(-0.002, 0.002)), draw(st.booleans())
    if abs(depth) < ROUNDED:
        depth = ROUNDED  # else rounding decides whether they touch, and how fast they met
    axis = draw(directions())
    axis = -axis if axis @ gap < 0.0 else axis
    ball = (np.linalg.norm(gap) if sphere else axis @ gap) + depth
    size = {"radius": 0.5 * ball} if sphere else {"axis": axis}
    friction = {}
    if rubs and not conservative and draw(st.booleans()):
        friction = {"friction": draw(between(0.1, 1.0)), "tangential_stiffness": 20.0}
    restitution = 1.0 if conservative else draw(between(0.2, 1.0))
    sketch.contacts.append(
        Contact(
            sketch.new("c"),
            (first, second),
            "sphere" if sphere else "plane",
            max(0.0, 0.5 * ball if sphere else ball),
            impact=Impact(draw(between(5.0, 50.0)), restitution=restitution),
            **size,
            **friction,
        )
    )


@st.composite
def pairs(draw, sketch, slim=True):
    """Frames of two bodies that are not in one place; slim: bars may be among them."""

    def apart(pair):
        first, second = pair
        same = first.partition(".")[0] == second.partition(".")[0]
        return not same and np.linalg.norm(sketch.place(first) - sketch.place(second)) > 0.05

    frames = [frame for frame in sketch.frames() if slim or not sketch.is_slim(frame)]
    known = [pair for pair in product(frames, frames) if apart(pair)]
    return draw(st.sampled_from(known)) if known else None


def load(draw, sketch):
    """A force, or a torque where there is a body that it does not spin up.

    A bar about its axis is so light that it would turn by a rad in each of the first steps, faster
    than it vibrates: what bends it then grows without limit, and rounding with it.
    """
    broad = [frame for frame in sketch.frames() if not sketch.is_slim(frame)]
    kind = draw(st.sampled_from(["force", "torque"] if broad else ["force"]))
    signal = draw(st.sampled_from([Constant(1.0), Harmonic(1.0, 25.0)]))
    direction = draw(vectors(1.0 if kind == "force" else 0.02))
    on = draw(st.sampled_from(sketch.frames() if kind == "force" else broad))
    follower = draw(st.booleans())
    sketch.loads.append(LOADS[kind](on, direction, signal, follower=follower))


@st.composite
def mechanisms(draw, free=False, conservative=False, loops=True, friction=True, **settings):
    """A model of one to five bodies.

    free: of nothing outside it, so that momenta are conserved; conservative: without loads and
    dampers, so that energy is; friction: of contacts.
    """
    sketch = Sketch()
    for _ in range(draw(st.integers(1, 4))):
        hang(draw, sketch, free)
    several = len(sketch.bodies) > 1
    if several and loops and draw(st.booleans()):
        link(draw, sketch)
    for _ in range(draw(st.integers(0, 2)) if several else 0):
        spring(draw, sketch, conservative)
    if several and draw(st.booleans()):
        contact(draw, sketch, conservative, friction)
    for _ in range(0 if free or conservative else draw(st.integers(0, 2))):
        load(draw, sketch)
    return Model(
        sketch.bodies,
        sketch.joints,
        sketch.loads,
        sketch.springs,
        contacts=sketch.contacts,
        gravity=np.zeros(3) if free else draw(vectors(10.0)),
        settings=Settings(**{"t_end": STEPS * STEP, "step": STEP, "rho_inf": 0.9} | settings),
    )


def run(model):
    """The results of a mechanism; no example is one whose joints say the same twice, nor one that
    leaves the range in which bodies can be integrated: slim ones, that a spring on them swings in
    less than a step: there Newton's iterations overflow, of which numpy warns where compiled code
    does not.
    """
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            return simulate(model)
    except ModelError as error:
        if "redundant" in str(error) or "singular pose" in str(error):
            reject()
        raise
    except OutOfRangeError:
        reject()
    except ConvergenceError as error:
        beyond = any(words in str(error) for words in ("turns by", "too short for the step"))
        if beyond or has_left_range(model, error.step - 1):
            reject()
        raise


def has_left_range(model, steps):
    """Whether one of the first steps passes a limit of `Results.validity`."""
    if not steps:
        return False
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ValidityWarning)
        return bool(
            simulate(model.with_settings(t_end=steps * model.settings.step)).validity.warnings
        )
