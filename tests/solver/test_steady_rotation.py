"""Starts in steady rotation: what keeps turning as it starts, to rounding, and what cannot."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    JOINTS,
    Fixed,
    FlexibleBody,
    Frame,
    Harmonic,
    Model,
    ModelError,
    Place,
    Polynomial,
    PrescribedRotation,
    Revolute,
    RigidBody,
    Settings,
    Spherical,
    Spring,
    Start,
    SteadyRotation,
    TabulatedLaw,
    simulate,
)

from .models import model_of

SPIN, Z = 50.0, np.array([0.0, 0.0, 1.0])
L, MASS, RIM = 0.5, 0.0429, 0.05


def rotor(beam, drive=None, spin=SPIN, **settings):
    """A beam on the rim of a hub, on a bearing about z; it stretches under its rotation and sags
    under gravity.
    """
    hub = RigidBody(0.01, [0.0095, 0.0095, 0.019], {"rim": Frame([RIM, 0, 0])})
    common = {"t_end": 0.06, "gravity": [0, 0, -9.81], "start": "equilibrium", "rho_inf": 0.9}
    return model_of(
        bodies={
            "hub": hub,
            "beam": FlexibleBody(beam.element, Start(place=Place("root", "hub.rim"))),
        },
        joints=[
            Revolute("ground", "hub", Z, name="pivot", angle=drive),
            Fixed("hub.rim", "beam.root", name="clamp"),
        ],
        **(common | {"steady_rotation": SteadyRotation(spin * Z)} | settings),
    )


def unsteadiness(results):
    """Of the speed, relative, and of the displacement of the tip [m, rad]."""
    speed, u = results.body("hub").v[:, 5], results.frame("beam.tip").u
    return np.abs(speed / SPIN - 1.0).max(), np.abs(u - u[0]).max()


@pytest.mark.parametrize("history", ["recursive", "direct"])
@pytest.mark.parametrize("rule", ["consistent", "paper"])
def test_a_steady_rotation_goes_on(beam, history, rule):
    """Over 1000 steps, with gravity along the axis. That the scheme starts from what it steps
    itself is what does it: the velocities and accelerations of a continuous rotation differ by
    (spin h)^2, and leave 3e-7 of ringing.
    """
    results = simulate(rotor(beam, history=history, rule=rule))
    pull = MASS * (RIM + L / 2) * SPIN**2  # and a millionth more, as the beam stretches
    assert results.joint("clamp").force[0, 0] == pytest.approx(-pull, rel=4e-6)
    assert np.abs(results.frame("beam.tip").u).max() > 5e-4
    speed, displacement = unsteadiness(results)
    assert speed < 1e-11
    assert displacement < 2e-12


def test_what_is_lost_of_the_speed_is_numerical_dissipation(beam):
    """Of order h^3. At rho_inf = 1 there is none: see the springs that turn along below."""
    lost = [unsteadiness(simulate(rotor(beam, step=h, rho_inf=0.5)))[0] for h in (1.2e-4, 2.4e-4)]
    assert np.log2(lost[1] / lost[0]) == pytest.approx(3.0, abs=0.05)


def test_a_rotor_driven_at_constant_speed_starts_still(beam):
    results = simulate(rotor(beam, drive=Polynomial((0.0, SPIN))))
    _, displacement = unsteadiness(results)
    assert displacement < 2e-12
    np.testing.assert_allclose(
        results.joint("pivot").coordinates["angle"], SPIN * results.time, rtol=0, atol=1e-12
    )


def test_a_hub_turned_at_constant_speed_starts_still(beam):
    """The same by a prescribed motion, which takes the place of the bearing's axes."""
    model = rotor(beam)
    pivot = Spherical("ground", "hub", name="pivot")
    turn = PrescribedRotation("turn", "hub", Z, Polynomial((0.0, SPIN)))
    _, displacement = unsteadiness(
        simulate(replace(model, joints=(pivot, model.joints[1]), motions=(turn,)))
    )
    assert displacement < 2e-12


def test_springs_that_turn_along_stay_still():
    """An arm that springs hold to the axis and that turns along with them; a bob on springs at its
    end.
    """
    arm = RigidBody(2.0, [0.1, 0.2, 0.25], {"end": Frame([0.4, 0.1, 0])})
    bob = RigidBody(0.5, [1e-3, 1e-3, 1e-3], {}, Start([0.6, 0.1, 0.0]))
    model = Model(
        {"arm": arm, "bob": bob},
        springs=[
            Spring(
                "mount", "bushing", ("arm", "ground"), Z, stiffness=[1e4, 1e4, 1e4, 10.0, 10.0, 0.0]
            ),
            Spring("leaf", "bushing", ("arm.end", "bob"), stiffness=[5e3] * 3 + [20.0] * 3),
        ],
        settings=Settings(
            start="equilibrium",
            steady_rotation=SteadyRotation(20.0 * Z),
            t_end=0.5,
            step=1e-3,
            rho_inf=1.0,
        ),
    )
    results = simulate(model)
    coordinates = results.spring("leaf").coordinates["coordinates"]
    assert np.abs(coordinates[0, :3]).max() > 0.2
    assert np.abs(coordinates - coordinates[0]).max() < 1e-13
    assert np.abs(results.body("bob").v[:, 5] / 20.0 - 1.0).max() < 1e-12


def floating(n):
    """Links of 0.2 m in a row, hinged to one another and to nothing else, across the axis."""
    frames = {"near": Frame([-0.1, 0, 0]), "far": Frame([0.1, 0, 0])}
    links = {
        f"b{i}": RigidBody(1.0, [1e-3, 4e-3, 4e-3], frames, Start([0.2 * i - 0.1 * (n - 1), 0, 0]))
        for i in range(n)
    }
    joints = [Spherical(f"b{i - 1}.far", f"b{i}.near", name=f"j{i}") for i in range(1, n)]
    settings = Settings(
        start="equilibrium",
        steady_rotation=SteadyRotation(20.0 * Z),
        assemble=True,
        t_end=0.05,
        step=1e-3,
    )
    return Model(links, joints, settings=settings)


def pull(n, i):
    """Of joint i on the link after it: m r omega^2 of all links beyond."""
    return sum(0.2 * k - 0.1 * (n - 1) for k in range(i, n)) * 20.0**2


@pytest.mark.parametrize("n", range(2, 11))
def test_a_chain_that_nothing_holds_turns_steadily(n):
    """Also from beside the equilibrium, from which the centrifugal force pulls its center."""
    model, rng = floating(n), np.random.default_rng(n)
    beside = {
        name: replace(
            body,
            start=Start(
                body.start.position + 1e-3 * rng.normal(size=3), [0, 0, 0.05 * rng.normal()]
            ),
        )
        for name, body in model.bodies.items()
    }
    for given in (model, replace(model, bodies=beside)):
        results = simulate(given)
        center = np.mean([results.body(name).x for name in model.bodies], axis=0)
        assert np.abs(center[:, :2]).max() < 1e-12
        for i in range(1, n):
            force = np.linalg.norm(results.joint(f"j{i}").force, axis=1)
            np.testing.assert_allclose(force, abs(pull(n, i)), rtol=1e-3)
            assert np.ptp(force) < 1e-6 * force[0]


@pytest.mark.parametrize("spin", [1.0, 10.0, 30.0])
@pytest.mark.parametrize("n", [2, 3, 5, 8])
def test_flexible_bodies_that_nothing_holds_turn_steadily(beam, n, spin):
    """Beams welded to one another: the joint in the middle, or beside it, pulls the most."""
    root, tip = (beam.element.interface(name).X for name in ("root", "tip"))
    bodies = {
        f"b{i}": FlexibleBody(beam.element, Start((i - 0.5 * n) * (tip - root) - root))
        for i in range(n)
    }
    joints = [Fixed(f"b{i - 1}.tip", f"b{i}.root", name=f"j{i}") for i in range(1, n)]
    results = simulate(
        model_of(
            bodies,
            joints,
            start="equilibrium",
            steady_rotation=SteadyRotation(spin * Z),
            t_end=0.003,
        )
    )
    force = np.linalg.norm(results.joint("j1").force, axis=1)
    np.testing.assert_allclose(force, MASS * L * spin**2 * 0.5 * (n - 1), rtol=1e-4)
    assert np.ptp(force) < 1e-5 * force[0]


def disk(*springs, pivot="revolute", drive=None, motions=(), **settings):
    body = RigidBody(1.0, [0.1, 0.1, 0.2], {"rim": Frame([0.3, 0, 0])})
    axis = [] if pivot == "spherical" else [Z]
    given = {} if drive is None else {"angle": drive}
    joint = JOINTS[pivot]("ground", "disk", *axis, name="pivot", **given)
    start = {"start": "equilibrium", "t_end": 0.01, "step": 1e-3}
    hook = {"hook": Frame([0.0, 0.4, 0.0])}
    return model_of(
        {"disk": body},
        (joint,),
        springs=springs,
        motions=motions,
        ground_frames=hook,
        **(start | settings),
    )


def coil(**law):
    return Spring("coil", "torsion", ("ground", "disk"), Z, **law)


TURNING = {"steady_rotation": SteadyRotation([0.0, 0.0, 20.0])}
REFUSED = {
    "a bearing about another axis": (
        lambda: disk(steady_rotation=SteadyRotation([0, 20, 0])),
        "joint 'pivot': start = 'equilibrium': a steady rotation of [0.0, 20.0, 0.0] rad/s "
        "opens it by 20 rad/s",
    ),
    "a bearing off the axis": (
        lambda: disk(steady_rotation=SteadyRotation([0, 0, 20], [0.1, 0, 0])),
        "joint 'pivot': start = 'equilibrium': a steady rotation of [0.0, 0.0, 20.0] rad/s "
        "opens it by 2 m/s",
    ),
    "a torsion spring on the ground": (
        lambda: disk(coil(stiffness=1.0), **TURNING),
        "spring 'coil': start = 'equilibrium': a steady rotation of [0.0, 0.0, 20.0] rad/s "
        "deforms it by 20 rad/s",
    ),
    "a damper on the ground": (
        lambda: disk(coil(damping=1.0), **TURNING),
        "spring 'coil': start = 'equilibrium': a steady rotation of [0.0, 0.0, 20.0] rad/s "
        "deforms it by 20 rad/s",
    ),
    "a law on the ground": (
        lambda: disk(coil(law=TabulatedLaw((-1.0, 1.0), (-1.0, 1.0))), **TURNING),
        "spring 'coil': start = 'equilibrium'",
    ),
    "a spring that turns about another axis": (
        lambda: disk(
            Spring("strap", "point", ("ground.hook", "disk.rim"), stiffness=10.0), **TURNING
        ),
        "spring 'strap': start = 'equilibrium': a steady rotation of [0.0, 0.0, 20.0] rad/s "
        "deforms it by ",
    ),
    "a drive at another speed": (
        lambda: disk(drive=Polynomial((0.0, 25.0)), **TURNING),
        "joint 'pivot': start = 'equilibrium': a steady rotation of [0.0, 0.0, 20.0] rad/s "
        "misses its drive by 5 rad/s",
    ),
    "a drive from rest": (
        lambda: disk(drive=Polynomial((0.0, 25.0))),
        "joint 'pivot': start = 'equilibrium': rest misses its drive by 25 rad/s",
    ),
    "a motion from rest": (
        lambda: disk(
            pivot="spherical", motions=[PrescribedRotation("turn", "disk", Z, Harmonic(0.5, 1.0))]
        ),
        "motion 'turn': start = 'equilibrium': rest misses its drive by 3.14159 rad/s",
    ),
    "a drive that accelerates": (
        lambda: disk(drive=Polynomial((0.0, 20.0, 1.5)), **TURNING),
        "joint 'pivot': start = 'equilibrium' needs drives without acceleration at t = 0, got 3",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_turn_steadily_is_named(name):
    make, message = REFUSED[name]
    with pytest.raises(ModelError) as caught:
        simulate(make())
    assert str(caught.value).startswith(message)


def test_a_spring_without_law_turns_along():
    assert np.ptp(simulate(disk(coil(), **TURNING)).body("disk").v[:, 5]) < 1e-12
