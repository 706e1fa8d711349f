"""Degrees of freedom of mechanisms, and constraints that depend on one another."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    JOINTS,
    Constant,
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
    Results,
    Revolute,
    RigidBody,
    Settings,
    Simulator,
    Spherical,
    Start,
    simulate,
)
from duhamel.solver.start import redundancy
from duhamel.solver.start.initial import initialize
from scipy.spatial.transform import Rotation

from .frameworks import bar, framework
from .linkages import Z, four_bar, slider_crank, spatial_four_bar

X, Y = np.eye(3)[:2]


def freedoms(model):
    return initialize(model).degrees_of_freedom


def link(p, q):
    """A rigid link with its frames at p and q."""
    middle, half = 0.5 * (np.add(p, q)), 0.5 * np.subtract(q, p)
    return RigidBody(
        1.0, [0.1, 0.2, 0.3], {"near": Frame(-half), "far": Frame(half)}, Start(middle)
    )


def chain(*types, length=0.2):
    """Links along x, each on a joint of the given type to the one before, the first to the
    ground.
    """
    axes = {
        "universal": (Y, Z),
        "revolute": (Y,),
        "prismatic": (X,),
        "cylindrical": (X,),
        "planar": (Z,),
    }
    names = [f"link{k}" for k in range(len(types))]
    ends = length * np.outer(np.arange(len(types) + 1), X)
    parents = ["ground", *(f"{name}.far" for name in names)]
    return Model(
        bodies={name: link(p, q) for name, p, q in zip(names, ends[:-1], ends[1:], strict=True)},
        joints=[
            JOINTS[kind](parent, f"{name}.near", *axes.get(kind, ()), name=f"J{k}")
            for k, (kind, parent, name) in enumerate(zip(types, parents[:-1], names, strict=True))
        ],
        settings=Settings(t_end=0.01, step=1e-3),
    )


@pytest.mark.parametrize(
    ("types", "count"),
    [
        (["revolute", "revolute"], 2),
        (["spherical", "spherical"], 6),
        (["universal"] * 5, 10),
        (["fixed", "revolute", "prismatic", "cylindrical", "planar", "spherical"], 10),
    ],
)
def test_open_chains_move_as_their_joints_add_up(types, count):
    assert freedoms(chain(*types)) == count


def test_bodies_without_joints_have_six_each(tmp_path):
    beam = bar(tmp_path, 0.3)
    assert (
        freedoms(
            Model({"free": FlexibleBody(beam), "other": FlexibleBody(beam), "rigid": link(X, Y)})
        )
        == 18
    )


@pytest.mark.parametrize("make", [four_bar, slider_crank, spatial_four_bar])
def test_linkages_with_flexible_members_have_one(make, tmp_path):
    """No constraint is redundant: what would be among rigid members, a flexible one takes up."""
    model = make(tmp_path)
    beginning = initialize(model)
    assert beginning.degrees_of_freedom == 1
    assert not beginning.removed.rows
    joints = [
        replace(joint, angle=Polynomial((0.0, 1.0))) if joint.name == "A" else joint
        for joint in model.joints
    ]
    assert freedoms(replace(model, joints=joints)) == 0


def test_drives_and_motions_take_one_each_and_rotations_three():
    model = chain("spherical", "cylindrical")
    assert freedoms(model) == 5
    still = Harmonic(0.01, 1.0)
    first, second = model.joints
    assert freedoms(replace(model, joints=(first, replace(second, angle=still)))) == 4
    assert (
        freedoms(replace(model, joints=(first, replace(second, angle=still, distance=still)))) == 3
    )
    lift = PrescribedDisplacement("lift", "link0.far", Z, still)
    assert freedoms(replace(model, motions=(lift,))) == 4
    assert freedoms(replace(model, motions=(lift, replace(lift, name="push", direction=Y)))) == 3
    assert (
        freedoms(replace(model, motions=(PrescribedRotation("turn", "link0.far", Z, still),))) == 2
    )


LENGTH, TWIST, TURN = (1.0, 0.6), 0.7, 0.6
"""of Bennett's linkage: lengths a, b, a, b and twists alpha, beta, alpha, beta with a sin beta = b
sin alpha
"""
TWISTS = (TWIST, float(np.arcsin(LENGTH[1] / LENGTH[0] * np.sin(TWIST))))


def second_angle(first):
    """tan(first / 2) tan(second / 2) = sin((beta + alpha) / 2) / sin((beta - alpha) / 2)"""
    alpha, beta = TWISTS
    return 2 * np.arctan(
        np.sin(0.5 * (beta + alpha)) / np.sin(0.5 * (beta - alpha)) / np.tan(0.5 * first)
    )


def bennett(drive=None, **settings):
    """Four links on four hinges whose axes meet nowhere; the last link is the ground. It should be
    rigid, and moves.
    """
    angles = [TURN, second_angle(TURN), -TURN, -second_angle(TURN)]
    corners, axes = [np.zeros(3)], [Z]
    turn = Rotation.identity()
    for k, angle in enumerate(angles):
        turn = turn * Rotation.from_rotvec(angle * Z)
        corners.append(corners[-1] + LENGTH[k % 2] * turn.apply(X))
        turn = turn * Rotation.from_rotvec(TWISTS[k % 2] * X)
        axes.append(turn.apply(Z))
    np.testing.assert_allclose(corners[4], 0.0, atol=1e-14)
    np.testing.assert_allclose(axes[4], Z, atol=1e-14)
    links = {f"link{k}": link(corners[k], corners[k + 1]) for k in range(3)}
    sides = [
        "ground",
        "link0.near",
        "link0.far",
        "link1.near",
        "link1.far",
        "link2.near",
        "link2.far",
        "ground",
    ]
    joints = [Revolute(*tuple(sides[2 * k : 2 * k + 2]), axes[k], name=f"J{k}") for k in range(4)]
    joints[0] = replace(joints[0], angle=drive)
    return Model(links, joints, settings=Settings(t_end=1.0, step=1e-2, rho_inf=0.9, **settings))


def test_the_constraints_of_bennetts_linkage_are_told():
    with pytest.raises(
        ModelError,
        match=r"joints: 20 constraints of which 3 are redundant; dependent constraints: J0",
    ):
        simulate(bennett())
    beginning = initialize(bennett(redundant="remove"))
    assert beginning.degrees_of_freedom == 1
    assert len(beginning.removed.rows) == 3


def test_bennetts_linkage_moves_as_its_closed_form():
    """With the redundant constraints removed those left hold it together."""
    drive = Polynomial((0.0, 0.0, 4.5))
    results = simulate(bennett(drive, redundant="remove"))
    first = TURN + np.array([drive(t) for t in results.time])
    expected = second_angle(first)
    angle = [results.joint(f"J{k}").coordinates["angle"] for k in range(4)]
    np.testing.assert_allclose(angle[0], first - TURN, rtol=0, atol=1e-10)
    np.testing.assert_allclose(angle[1], expected - expected[0], rtol=0, atol=1e-9)
    np.testing.assert_allclose(angle[2], -angle[0], rtol=0, atol=1e-9)
    np.testing.assert_allclose(angle[3], -angle[1], rtol=0, atol=1e-9)
    assert np.ptp(angle[1]) > 2.0


def test_constraints_that_contradict_each_other_are_named():
    """A drive against a joint that blocks it, a linkage that cannot close."""
    model = chain("fixed", "revolute")
    doubled = Revolute("link0.far", "link1.near", Y, name="again", angle=Polynomial((0.0, 1.0)))
    blocked = Fixed(*model.joints[1].between, name=model.joints[1].name)
    with pytest.raises(ModelError, match="driven against other constraints"):
        simulate(
            replace(model, joints=(model.joints[0], blocked, doubled)).with_settings(
                redundant="remove"
            )
        )
    far = Spherical("link1.far", "ground.nail", name="far")
    out_of_reach = replace(
        model, joints=(*model.joints, far), ground_frames={"nail": Frame(0.5 * X + 0.3 * Z)}
    ).with_settings(assemble=True)
    with pytest.raises(ModelError, match=r"stays open by 0\.\d+ however the bodies are placed"):
        simulate(out_of_reach)


def planar(links, pins, **settings):
    """Rigid links in a plane, by their ends, on hinges across it."""
    bodies = {name: link(p, q) for name, (p, q) in links.items()}
    joints = [Revolute(*sides, Z, name=name) for name, sides in pins.items()]
    options = {"t_end": 1.0, "step": 1e-3, "redundant": "remove"} | settings
    return Model(bodies, joints, gravity=[0, -9.81, 0], settings=Settings(**options))


def parallelogram(angle, **settings):
    """Two cranks of 1 m, 2 m apart, and the rod between them."""
    B = np.array([np.cos(angle), np.sin(angle), 0.0])
    return planar(
        {"first": (0 * X, B), "rod": (B, B + 2 * X), "second": (2 * X, B + 2 * X)},
        {
            "A": ("ground", "first.near"),
            "B": ("first.far", "rod.near"),
            "C": ("rod.far", "second.far"),
            "D": ("ground", "second.near"),
        },
        **settings,
    )


def equal_slider_crank(angle, **settings):
    """Crank and rod of 1 m: folded, at a right angle, the rod can turn about the pin of the crank
    alone, or drive the slider.
    """
    B, P = np.array([np.cos(angle), np.sin(angle), 0.0]), 2.0 * np.cos(angle) * X
    model = planar(
        {"crank": (0 * X, B), "rod": (B, P), "slider": (P, P + 0.1 * X)},
        {
            "A": ("ground", "crank.near"),
            "B": ("crank.far", "rod.near"),
            "C": ("rod.far", "slider.near"),
        },
        **settings,
    )
    guide = Prismatic("ground", "slider.near", X, name="guide")
    push = Force("slider.near", X, Constant(1.0))
    return replace(model, joints=(*model.joints, guide), loads=(push,))


def opening(results, model):
    """The largest distance of the frames of a hinge."""
    gaps = []
    for joint in model.joints:
        if joint.type == "revolute":
            first, second = joint.between
            b = results.frame(second).position
            a = b[0] if first == "ground" else results.frame(first).position
            gaps.append(np.linalg.norm(b - a, axis=1).max())
    return max(gaps)


@pytest.mark.parametrize("redundant", ["error", "remove"])
@pytest.mark.parametrize("make", [parallelogram, equal_slider_crank])
def test_a_singular_start_is_refused(make, redundant):
    """What is redundant there is needed beside it: to remove it would let joints open."""
    angle = {parallelogram: 0.0, equal_slider_crank: np.pi / 2}[make]
    message = (
        r"joints: the start is a singular pose: A \(.*\), B \(.*\), C .* are dependent "
        r"constraints there, but independent in nearby poses, so that the motion is not "
        r"determined; start"
    )
    with pytest.raises(ModelError, match=message):
        simulate(make(angle, redundant=redundant))


def test_a_drive_at_a_dead_point_is_told_from_one_against_a_joint():
    """The slider of a straight crank and rod, which can be driven from any other pose."""

    def pushed_by_its_guide(angle):
        model = equal_slider_crank(angle)
        drive = Polynomial((0.0, -0.1))
        joints = [replace(j, distance=drive) if j.name == "guide" else j for j in model.joints]
        return replace(model, joints=joints)

    with pytest.raises(ModelError, match=r"the start is a singular pose: .* guide"):
        simulate(pushed_by_its_guide(0.0))
    assert opening(simulate(pushed_by_its_guide(0.3)), equal_slider_crank(0.3)) < 1e-12


def test_links_in_line_between_two_walls_are_a_singular_pose():
    """They cannot move, but nothing holds the pin between them across."""
    sides = {"A": ("ground", "a.near"), "B": ("a.far", "b.near"), "C": ("b.far", "ground")}
    with pytest.raises(ModelError, match="the start is a singular pose"):
        simulate(planar({"a": (0 * X, X), "b": (X, 2 * X)}, sides))


@pytest.mark.parametrize("angle", [0.3, 1e-3, -2.0])
@pytest.mark.parametrize("make", [parallelogram, equal_slider_crank])
def test_linkages_stay_closed_when_they_start_beside_singular_poses(make, angle):
    angle += {parallelogram: 0.0, equal_slider_crank: np.pi / 2}[make]
    model = make(angle)
    results = simulate(model)
    assert results.solver["degrees_of_freedom"] == 1
    assert results.solver["removed"].count("tion ") == 3
    assert opening(results, model) < 1e-12


def test_masses_do_not_make_constraints_redundant():
    """A light link between heavy ones; its joints depend on one another in no pose."""
    model = chain("revolute", "revolute", "revolute")
    bodies = {
        name: replace(body, mass=mass, inertia=mass * np.array([0.1, 0.2, 0.3]))
        for mass, (name, body) in zip((1e7, 1e-8, 1e7), model.bodies.items(), strict=True)
    }
    assert freedoms(replace(model, bodies=bodies)) == 3


def test_an_interface_that_moves_as_another_is_held_once(tmp_path):
    """Two at one node: what holds the second is redundant, all six rows, and changes nothing."""
    places = {"root": (0, 0, 0), "same": (0, 0, 0), "tip": (0.5, 0, 0)}
    element = framework(tmp_path, [(places["root"], places["tip"])], places)
    clamps = [Fixed("ground", f"bar.{frame}", name=frame) for frame in ("root", "same")]

    def swing(joints, **settings):
        return Model(
            {"bar": FlexibleBody(element, Start([0.25, 0, 0]))},
            joints,
            loads=[Force("bar.tip", [0, 0.1, 0], Constant(1.0))],
            settings=Settings(t_end=5e-4, step=1e-5, **settings),
        )

    with pytest.raises(ModelError, match="12 constraints of which 6 are redundant"):
        initialize(swing(clamps))
    once, twice = simulate(swing(clamps[:1])), simulate(swing(clamps, redundant="remove"))
    tips = [results.frame("bar.tip").u for results in (once, twice)]
    np.testing.assert_allclose(tips[1], tips[0], rtol=0, atol=1e-9 * np.abs(tips[0]).max())


@pytest.fixture
def unseen(monkeypatch):
    """A singular start that the search beside it has missed."""
    monkeypatch.setattr(redundancy, "poses_nearby", lambda *_: iter(()))
    return parallelogram(0.0)


OPEN = r"joints: \w+ \(.*\) was left out as redundant, but is open by .* it is needed there"


def test_a_constraint_that_was_left_out_and_is_needed_later_stops_the_run(unseen, tmp_path):
    with pytest.raises(ModelError, match=OPEN):
        simulate(unseen, output=tmp_path / "flat.h5")
    time = Results.read(tmp_path / "flat.h5").time
    assert 0.0 < time[-1] <= 1.0


def test_a_simulator_stops_there_too(unseen):
    simulator = Simulator(unseen, [])

    def run():
        while True:
            simulator.step([])

    with pytest.raises(ModelError, match=OPEN):
        run()
    assert 0.0 < simulator.time < 1.0
