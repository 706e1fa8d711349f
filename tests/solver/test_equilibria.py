"""Equilibria that are hard to find: without loads, with integrals of servos, of stiff contacts."""

import re
from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    Contact,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Impact,
    Model,
    ModelError,
    Motor,
    Place,
    Prismatic,
    Revolute,
    RigidBody,
    Settings,
    Spherical,
    Spring,
    Start,
    SteadyRotation,
    Torque,
    simulate,
    start,
)
from scipy.spatial.transform import Rotation

from .frameworks import bar

L, EI, MASS, G = 0.5, 5.5, 0.0429, 9.81
AT = {"at": Frame([0, 0, 0])}


def held_by_a_bushing(seed, place, size, stiffness):
    """Two bars, in any attitude, between a clamp and a bushing at rest."""
    rng = np.random.default_rng(seed)
    first, second = Rotation.random(2, rng)
    axis = rng.normal(size=3)
    tip = place + first.apply([size, 0, 0])
    end = tip + second.apply([size, 0, 0])

    def bar(begin, turn):
        frames = {"a": Frame([-size / 2, 0, 0]), "b": Frame([size / 2, 0, 0])}
        center = begin + turn.apply([size / 2, 0, 0])
        given = Start(position=center, rotation=turn.as_rotvec())
        return RigidBody(1.0, [0.01 * size**2] * 3, frames, start=given)

    return Model(
        {"first": bar(place, first), "second": bar(tip, second)},
        [
            Fixed("ground.clamp", "first.a", name="clamp"),
            Revolute("first.b", "second.a", axis / np.linalg.norm(axis), name="knee"),
        ],
        springs=[
            Spring(
                "bushing",
                "bushing",
                ("second.b", "ground.end"),
                stiffness=stiffness * np.array([1e4, 2e4, 5e3, 1, 2, 3]),
            )
        ],
        ground_frames={"clamp": Frame(place), "end": Frame(end)},
        settings=Settings(t_end=1e-3, step=1e-4, start="equilibrium"),
    )


@pytest.mark.parametrize("seed", range(16))
def test_an_unloaded_model_is_in_equilibrium_and_stays_there(seed):
    """Without a warning: the energy that moves is rounding, and so is the error of its balance."""
    rng = np.random.default_rng(1000 + seed)
    place, size, stiffness = np.zeros(3), 0.5, 1.0
    if seed % 2:
        place, size = rng.normal(size=3), 10.0 ** rng.uniform(-2, 2)
        stiffness = 10.0 ** rng.uniform(-2, 6)
    results = simulate(held_by_a_bushing(seed, place, size, stiffness))
    x = results.body("second").x
    assert not list(results.validity.brief())
    assert np.abs(x - x[0]).max() < 1e-12 * np.abs(x).max()


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize(("distance", "stiffness", "g"), [(1e5, 1.0, 0.0), (1e4, 1e4, G)])
def test_a_model_far_from_the_origin_is_where_a_near_one_is(seed, distance, stiffness, g):
    """Its joints close no better than coordinates are rounded."""
    place, gravity = distance * np.array([-0.8, 0.5, 0.3]), np.array([0.0, 0.0, -g])
    near, far = (
        simulate(replace(held_by_a_bushing(seed, at, 0.5, stiffness), gravity=gravity))
        for at in (np.zeros(3), place)
    )
    apart = far.body("second").x - near.body("second").x - place
    assert np.abs(apart).max() < 20.0 * np.finfo(float).eps * distance


@pytest.mark.parametrize("seed", range(8))
def test_integrals_of_servos_hold_what_an_elastic_arm_weighs(beam, seed):
    rng = np.random.default_rng(seed)
    tool, gain = rng.uniform(0.1, 1.0), 10.0 ** rng.uniform(1, 4)
    bodies = {
        "upper": FlexibleBody(beam.element, Start(position=[L / 2, 0, 0])),
        "elbow": RigidBody(0.5, [1e-4] * 3, AT, Start(place=Place("at", "upper.tip"))),
        "lower": FlexibleBody(beam.element, Start(place=Place("root", "elbow.at"))),
        "tool": RigidBody(tool, [1e-4] * 3, AT, Start(place=Place("at", "lower.tip"))),
    }
    joints = [
        Revolute("ground", "upper.root", [0, 1, 0], name="shoulder"),
        Fixed("upper.tip", "elbow.at", name="flange"),
        Revolute("elbow.at", "lower.root", [0, 1, 0], name="knee"),
        Fixed("lower.tip", "tool.at", name="grip"),
    ]
    motors = [
        Motor("lift", "shoulder", "angle", stiffness=5e3, damping=9.0, integral=gain),
        Motor("bend", "knee", "angle", stiffness=800.0, damping=5.0, integral=0.3 * gain),
    ]
    settings = Settings(t_end=6e-3, start="equilibrium")
    results = start(Model(bodies, joints, motors=motors, gravity=[0, 0, -G], settings=settings))
    for joint in ("shoulder", "knee"):
        assert abs(results.joint(joint).angle[0]) < 1e-12
    weights = np.array([MASS, 0.5, MASS, tool]) * G
    arms = np.array([results.body(name).x[0, 0] for name in bodies])
    assert abs(results.motor("lift").torque[0]) == pytest.approx(weights @ arms, rel=1e-9)


@pytest.mark.parametrize("stiffness", [1e6, 1e8, 1e10])
@pytest.mark.parametrize("depth", [1e-9, 1e-7, -1e-6, -1e-3])
@pytest.mark.parametrize("mass", [0.02, 0.1])
def test_a_ball_that_just_touches_a_cantilever_rests_on_its_tip(beam, stiffness, depth, mass):
    radius = 0.01
    model = Model(
        {
            "beam": FlexibleBody(beam.element, Start(position=[L / 2, 0, 0])),
            "ball": RigidBody(mass, [1e-6] * 3, {}, Start(position=[L, 0, radius - depth])),
        },
        [
            Fixed("ground", "beam.root", name="clamp"),
            Prismatic("ground", "ball", [0, 0, 1], name="guide"),
        ],
        contacts=[
            Contact(
                "touch",
                ("beam.tip", "ball"),
                "plane",
                radius,
                [0, 0, 1],
                impact=Impact(stiffness=stiffness),
            )
        ],
        gravity=[0, 0, -G],
        settings=Settings(t_end=6e-3, start="equilibrium"),
    )
    results = start(model)
    sag = mass * G * L**3 / (3 * EI) + MASS * G * L**3 / (8 * EI)
    assert -results.frame("beam.tip").position[0, 2] == pytest.approx(sag, rel=1e-3)


ARM = {"arm": RigidBody(1.0, [0.01] * 3, {})}
TORQUE = [Torque("arm", [0, 0, 1], Constant(1.0))]
WITHOUT = {
    "a body that falls": ([], [], r"no joint, spring or contact holds body 'arm'"),
    "a body that slides down": (
        [Prismatic("ground", "arm", [0, 0, 1], name="guide")],
        [],
        r"body 'arm' has moved [\d.]+ m from its place in the model without coming to rest",
    ),
    "a wheel that is turned": (
        [Revolute("ground", "arm", [0, 0, 1], name="pivot")],
        TORQUE,
        r"body 'arm' has turned by [\d.]+ rad without coming to rest",
    ),
}


@pytest.mark.parametrize("case", WITHOUT)
def test_a_model_without_equilibrium_is_told_the_cause_that_applies(case):
    joints, loads, cause = WITHOUT[case]
    settings = Settings(t_end=1e-3, step=1e-4, start="equilibrium")
    model = Model(ARM, joints, loads=loads, gravity=[0, 0, -G], settings=settings)
    with pytest.raises(ModelError, match=cause) as refusal:
        start(model)
    causes = [text for _, _, text in WITHOUT.values() if re.search(text, str(refusal.value))]
    assert causes == [cause]


def test_a_column_beyond_its_buckling_load_is_not_said_to_be_free(tmp_path):
    """A clamp holds it: what it cannot find is a bent shape within the range of the method."""
    column = bar(tmp_path, L, rotation=True)
    load = 1.5 * np.pi**2 * EI / (4.0 * L**2)
    model = Model(
        {"column": FlexibleBody(column, Start([L / 2, 0, 0]))},
        [Fixed("ground", "column.left", name="clamp")],
        loads=[Force("column.right", [-load, 1e-4, 0], Constant(1.0))],
        settings=Settings(t_end=1e-2, step=1e-3, start="equilibrium"),
    )
    cause = "body 'column' has turned by .* by elasticity alone, .* beyond a buckling load"
    with pytest.raises(ModelError, match=cause) as refusal:
        start(model)
    assert "free" not in str(refusal.value)


def test_a_spring_too_soft_for_a_rotation_is_not_said_to_be_missing():
    """A mass that slides on a wheel, beyond the critical speed sqrt(k / m)."""
    wheel, slider = (RigidBody(1.0, [1.0] * 3, {}, Start([x, 0, 0])) for x in (0.0, 1.0))
    model = Model(
        {"wheel": wheel, "slider": slider},
        [
            Revolute("ground", "wheel", [0, 0, 1], name="axle"),
            Prismatic("wheel", "slider", [1, 0, 0], name="guide"),
        ],
        springs=[Spring("spring", "point", ("wheel", "slider"), stiffness=1e3, rest=1.0)],
        settings=Settings(
            t_end=1e-2, step=1e-3, start="equilibrium", steady_rotation=SteadyRotation([0, 0, 50.0])
        ),
    )
    with pytest.raises(ModelError, match="no spring or contact stops it against the centrifugal"):
        start(model)


def hung_out_chain(links, length=0.1):
    """Links that start in a horizontal line, each on a spherical joint of the one before."""
    ends = {"begin": Frame([-length / 2, 0, 0]), "end": Frame([length / 2, 0, 0])}
    inertia = 0.1 * length**2 * np.array([0.01, 1 / 12, 1 / 12])
    bodies = {
        f"link{k}": RigidBody(0.1, inertia, ends, Start([(k + 0.5) * length, 0, 0]))
        for k in range(links)
    }
    before = ["ground", *(f"link{k}.end" for k in range(links))]
    joints = [Spherical(before[k], f"link{k}.begin", name=f"joint{k}") for k in range(links)]
    return Model(
        bodies,
        joints,
        gravity=[0, 0, -G],
        settings=Settings(t_end=0.01, step=1e-3, start="equilibrium"),
    )


def test_a_chain_of_thirty_links_hangs_down():
    results = simulate(hung_out_chain(30))
    for k in range(30):
        position = results.body(f"link{k}").x[0]
        np.testing.assert_allclose(position, [0, 0, -0.1 * (k + 0.5)], rtol=0, atol=1e-9)


@pytest.mark.parametrize("stiffness", [1e5, 1e8])
@pytest.mark.parametrize("gap", [0.0, 0.01])
def test_balls_on_one_another_rest_at_the_sum_of_their_penetrations(stiffness, gap):
    """Contact k carries the balls above: x_j is lower by the sum of (n - k) m g / stiffness."""
    n, radius, impact = 10, 0.1, Impact(stiffness)
    floor = Contact("c0", ("ground.floor", "b0"), "plane", radius, axis=[0, 0, 1], impact=impact)
    between = [
        Contact(f"c{k}", (f"b{k - 1}", f"b{k}"), "sphere", radius, radius=radius, impact=impact)
        for k in range(1, n)
    ]
    heights = radius + (2 * radius + gap) * np.arange(n)
    model = Model(
        {f"b{k}": RigidBody(1.0, [0.004] * 3, {}, Start([0, 0, heights[k]])) for k in range(n)},
        [Prismatic("ground", f"b{k}", [0, 0, 1], name=f"guide{k}") for k in range(n)],
        contacts=[floor, *between],
        ground_frames={"floor": Frame()},
        gravity=[0, 0, -G],
        settings=Settings(t_end=1e-4, step=1e-5, start="equilibrium"),
    )
    results = simulate(model)
    sunk = np.cumsum((n - np.arange(n)) * G / stiffness)
    rest = radius * (1 + 2 * np.arange(n)) - sunk
    found = [results.body(f"b{k}").x[0, 2] for k in range(n)]
    np.testing.assert_allclose(found, rest, rtol=0, atol=1e-8 * sunk[-1] + 1e-14)


def test_a_block_that_friction_alone_would_hold_is_refused_with_that_reason():
    rubs = {"impact": Impact(1e5), "friction": 0.5, "tangential_stiffness": 1e5}
    model = Model(
        {"block": RigidBody(1.0, [0.01] * 3, {}, Start([0, 0, 0.1]))},
        loads=[Force("block", [1, 0, 0], Constant(1.0))],
        contacts=[Contact("floor", ("ground.floor", "block"), "plane", 0.1, [0, 0, 1], **rubs)],
        ground_frames={"floor": Frame()},
        gravity=[0, 0, -G],
        settings=Settings(t_end=0.01, step=1e-3, start="equilibrium"),
    )
    with pytest.raises(
        ModelError, match=r"'block'.*friction does not count: it acts from the first"
    ):
        simulate(model)


def test_a_soft_spring_on_a_very_stiff_one_sags_by_its_own_stiffness():
    """1 kg on 100 N/m, on 1 kg on 1e12 N/m, whose rounding is 1e-4 N."""
    springs = [
        Spring("stiff", "bushing", ("ground.foot", "below"), stiffness=[1e12] * 6),
        Spring("soft", "bushing", ("below", "above"), stiffness=[1e2] * 6),
    ]
    model = Model(
        {
            "below": RigidBody(1.0, [0.01] * 3, {}, Start([0, 0, 1])),
            "above": RigidBody(1.0, [0.01] * 3, {}, Start([0, 0, 2])),
        },
        springs=springs,
        ground_frames={"foot": Frame([0, 0, 1])},
        gravity=[0, 0, -G],
        settings=Settings(t_end=1e-5, step=1e-6, start="equilibrium"),
    )
    assert simulate(model).body("above").x[0, 2] == pytest.approx(2.0 - G / 1e2, abs=1e-6)
