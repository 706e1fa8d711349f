"""Contacts, stops and friction against exact solutions, and against the full mesh."""

import math

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    Contact,
    Coulomb,
    FlexibleBody,
    Force,
    ForceTable,
    Frame,
    Hertz,
    Impact,
    JointFriction,
    Planar,
    Polynomial,
    Prismatic,
    Revolute,
    RigidBody,
    Spring,
    Start,
    Stop,
    Stribeck,
    Torque,
    simulate,
)
from duhamel.solver.laws.contact import restitution_factor
from duhamel.solver.laws.hertz import patch_of
from duhamel.solver.step import shapes
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from .models import model_of

G = 9.81
STEEL = Hertz([2.1e11, 2.1e11], [0.3, 0.3])
FLOOR = {"ground_frames": {"floor": Frame()}}
UP = np.array([0.0, 0.0, 1.0])


def ball(mass=0.1, radius=0.02, **start):
    return RigidBody(mass, np.full(3, 0.4 * mass * radius**2), start=Start(**start))


def floor(name="floor", body="ball", ball=0.0, axis=UP, **law):
    """A plane through the origin."""
    return Contact(name, ("ground.floor", body), "plane", ball, axis, **law)


def impact_of(steps, phase=0.0, rho_inf=0.9, restitution=1.0, turn=None, origin=(0, 0, 0)):
    """The sphere of contact.md on a plane at 1 m/s, in so many steps: its model, force and time."""
    m, r, E = 0.1, 0.02, 1.0 / (2 * (1 - 0.09) / 2.1e11)
    K = 4.0 / 3.0 * E * np.sqrt(r)
    d = (1.25 * m / K) ** 0.4
    force, duration = K * d**1.5, 2.9432 * d
    h = duration / steps
    turn = Rotation.identity() if turn is None else turn
    n = turn.apply(UP)
    contact = Contact(
        "floor",
        ("ground.floor", "ball"),
        "plane",
        r,
        n,
        hertz=STEEL,
        impact=Impact(restitution=restitution),
    )
    start = {"position": origin + (r + (2.0 + phase) * h) * n, "velocity": -n}
    model = model_of(
        {"ball": ball(m, r, **start)},
        contacts=(contact,),
        ground_frames={"floor": Frame(origin)},
        t_end=(steps + 30) * h,
        step=h,
        rho_inf=rho_inf,
    )
    return model, force, n


def speed_after(model, n=UP):
    return float(simulate(model).body("ball").v[-1, :3] @ n)


def largest_force(results, mass=0.1):
    """By the acceleration of a free body."""
    v = results.body("ball").v[:, 2]
    return mass * np.abs(np.diff(v)).max() / np.diff(results.time)[0]


@pytest.mark.parametrize(("steps", "error"), [(20, 8.2e-3), (40, 2.1e-3), (80, 5.3e-4)])
def test_the_peak_of_a_hertz_impact(steps, error):
    """0.82, 0.21 and 0.053 % at the worst of eight phases of the steps: of the second order."""
    for phase in np.linspace(0.0, 1.0, 8, endpoint=False):
        model, force, _ = impact_of(steps, phase)
        peak = simulate(model).contact("floor").events.peak[0]
        assert abs(peak / force - 1.0) < error
        assert speed_after(model) == pytest.approx(1.0, abs=0.1 * error)


@pytest.mark.parametrize("rho_inf", [0.5, 0.9, 0.99])
@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0])
@pytest.mark.parametrize("e", [0.9, 0.5, 0.1])
def test_the_restitution_is_that_asked_for(e, exponent, rho_inf):
    """Within 1e-3 at 40 steps, for every exponent."""
    m, K = 0.1, 2e10
    d = (0.5 * (exponent + 1.0) * m / K) ** (1.0 / (exponent + 1.0))
    h = 3.0 * d / 40
    model = model_of(
        {"ball": ball(m, position=[0, 0, 2.3 * h], velocity=[0, 0, -1])},
        contacts=(floor(impact=Impact(stiffness=K, exponent=exponent, restitution=e)),),
        **FLOOR,
        t_end=400 * h,
        step=h,
        rho_inf=rho_inf,
    )
    results = simulate(model)
    assert results.body("ball").v[-1, 2] == pytest.approx(e, abs=1e-3)
    lost = 0.5 * m * (1.0 - e**2)
    assert results.energy.dissipated[-1] == pytest.approx(lost, abs=1e-3 * m)


@pytest.mark.parametrize("e", [0.9999999, 0.999, 0.97, 0.9, 0.8, 0.7, 0.5, 0.3, 0.1])
def test_the_factor_of_a_restitution(e):
    """m v dv/(1 + a v) = -N dd from 1 to -e: the same area in and out."""
    a = restitution_factor(e)
    area, _ = quad(lambda v: v / (1.0 + a * v), -e, 1.0, epsabs=1e-12)
    assert area == pytest.approx(0.0, abs=1e-11)


def test_an_impact_is_the_same_turned_and_a_kilometre_away():
    turn = Rotation.from_rotvec([0.4, -1.1, 0.7])
    found = [
        speed_after(*impact_of(40, restitution=0.6, **where)[::2])
        for where in ({}, {"turn": turn}, {"origin": np.array([1e3, -500.0, 200.0])})
    ]
    assert found[1] == pytest.approx(found[0], abs=1e-12)
    assert found[2] == pytest.approx(found[0], abs=1e-4)  # positions are rounded to 1e-13 m


def test_a_ball_bounces_to_rest():
    """Impacts at the times of free flight, and rest at the static indentation, without jitter."""
    m, r, e, drop = 0.1, 0.02, 0.5, 0.05
    contact = floor(ball=r, hertz=STEEL, impact=Impact(restitution=e))
    model = model_of(
        {"ball": ball(m, r, position=[0, 0, r + drop])},
        contacts=(contact,),
        **FLOOR,
        gravity=[0, 0, -G],
        t_end=0.4,
        step=2e-6,
    )
    results = simulate(model)
    flight = np.sqrt(2.0 * drop / G)
    times = flight * (1.0 + 2.0 * np.cumsum([0.0, e, e**2, e**3, e**4]))
    events = results.contact("floor").events
    np.testing.assert_allclose(events.start[:5], times, atol=8e-4)  # the rest is time in contact
    v, x = results.body("ball").v[-1000:], results.body("ball").x[-1, 2]
    assert np.ptp(v, axis=0).max() < 1e-12
    K = 4.0 / 3.0 * STEEL.modulus * np.sqrt(r)
    assert r - x == pytest.approx((m * G / K) ** (2 / 3), rel=1e-4)


def slope(angle, mu, speed=0.0, t_end=1.0, h=1e-3):
    """A block on an incline, with its displacement and speed downhill."""
    a, K = np.radians(angle), 1e6
    n, down = np.array([-np.sin(a), 0, np.cos(a)]), np.array([-np.cos(a), 0, -np.sin(a)])
    start = {"position": -n * G * np.cos(a) / K, "velocity": speed * down}
    contact = floor(axis=n, impact=Impact(stiffness=K), friction=mu, tangential_stiffness=1e5)
    model = model_of(
        {"ball": ball(1.0, **start)},
        contacts=(contact,),
        **FLOOR,
        gravity=[0, 0, -G],
        t_end=t_end,
        step=h,
    )
    results = simulate(model)
    return results, results.body("ball").x @ down, results.body("ball").v[:, :3] @ down


@pytest.mark.parametrize("angle", [10.0, 16.6])
def test_what_sticks_does_not_creep(angle):
    results, _, v = slope(angle, 0.3, t_end=2.0)
    assert abs(v[-1]) < 1e-12
    contact = results.contact("floor")
    tangential = np.linalg.norm(contact.force[-1, 1:])
    assert tangential / contact.force[-1, 0] == pytest.approx(np.tan(np.radians(angle)), rel=1e-6)
    assert contact.state[-1] == 1


def test_what_slides_slides_by_coulomb():
    a = np.radians(25.0)
    _, s, v = slope(25.0, 0.3)
    acceleration = G * (np.sin(a) - 0.3 * np.cos(a))
    bristle = 0.3 * G * np.cos(a) / 1e5  # friction begins when it is bent
    assert s[-1] == pytest.approx(0.5 * acceleration, abs=np.sqrt(2 * bristle) * 1.5)
    assert np.diff(v)[-100:] / 1e-3 == pytest.approx(acceleration, rel=1e-6)
    a = np.radians(10.0)
    _, s, v = slope(10.0, 0.3, speed=1.0)
    assert s[-1] == pytest.approx(0.5 / (G * (0.3 * np.cos(a) - np.sin(a))), rel=5e-3)
    assert abs(v[-1]) < 1e-4


@pytest.mark.parametrize("stiffness", [1e9, 1e10])
@pytest.mark.parametrize("mu", [0.3, Stribeck(0.4, 0.3, 0.01)])
def test_a_sledge_stops_and_sticks_by_very_stiff_bristles(mu, stiffness):
    """Which give way by less than 1e-9 m, in forces a few digits above the rounding of positions.

    It brakes by sliding friction over v^2 / (2 mu g).
    """
    K, legs = 1e6, [[x, y, -0.05] for x in (-0.05, 0.05) for y in (-0.05, 0.05)]
    frames = {f"leg{k}": Frame(leg) for k, leg in enumerate(legs)}
    start = Start([0, 0, 0.05 - G / 4 / K], velocity=[1, 0, 0])
    contacts = [
        Contact(
            f"floor{k}",
            ("ground.floor", f"sledge.leg{k}"),
            "plane",
            0.0,
            axis=[0, 0, 1],
            impact=Impact(stiffness=K, damping=1.0),
            friction=mu,
            tangential_stiffness=stiffness,
        )
        for k in range(4)
    ]
    model = model_of(
        {"sledge": RigidBody(1.0, [0.01] * 3, frames, start)},
        contacts=contacts,
        **FLOOR,
        gravity=[0, 0, -G],
        t_end=0.5,
        step=1e-3,
    )
    sledge = simulate(model).body("sledge")
    assert sledge.x[-1, 0] == pytest.approx(1.0 / (2.0 * 0.3 * G), rel=5e-3)
    assert abs(sledge.v[-1, 0]) < 2e-3


def test_a_ball_that_slides_begins_to_roll():
    """At 5/7 of its speed; it loses 1/7 of m v^2, to the second order of the step."""
    m, r, K = 1.0, 0.1, 1e6
    losses = []
    for h in (4e-4, 2e-4, 1e-4):
        contact = floor(ball=r, impact=Impact(stiffness=K), friction=0.3, tangential_stiffness=1e5)
        model = model_of(
            {"ball": ball(m, r, position=[0, 0, r - m * G / K], velocity=[1, 0, 0])},
            contacts=(contact,),
            **FLOOR,
            gravity=[0, 0, -G],
            t_end=0.4,
            step=h,
        )
        results = simulate(model)
        v = results.body("ball").v[-1]
        np.testing.assert_allclose(v, [5 / 7, 0, 0, 0, 5 / 7 / r, 0], atol=1e-9)
        losses.append(results.energy.dissipated[-1] - 1 / 7)
    assert abs(losses[-1]) < 1e-10
    assert abs(losses[0]) > 3.0 * abs(losses[1]) > 9.0 * abs(losses[2])


@pytest.mark.parametrize("damping", [0.0, 20.0, 2000.0])
def test_a_slip_that_begins_in_full_motion_creates_no_energy(damping):
    """A bristle is bent by its own rate: a contact that closes at 5 m/s stores none of that."""
    m, r = 0.1, 0.02
    contact = floor(
        ball=r,
        impact=Impact(stiffness=1e6),
        friction=0.3,
        tangential_stiffness=1e4,
        tangential_damping=damping,
    )
    model = model_of(
        {"ball": ball(m, r, position=[0, 0, r + 1e-4], velocity=[5, 0, -1])},
        contacts=(contact,),
        **FLOOR,
        t_end=0.01,
        step=1e-6,
    )
    energy = simulate(model).energy
    total = energy.kinetic + energy.springs
    assert total.max() < total[0] * (1.0 + 1e-6)
    assert np.diff(energy.dissipated).min() > -1e-6 * total[0]
    assert energy.dissipated[-1] > 0.1 * 0.3 * m * 2.0 * 5.0


@pytest.mark.parametrize("stiffness", [20.0, 200.0, 1000.0])
@pytest.mark.parametrize("depth", [0.0, 1e-3])
def test_friction_makes_a_light_rod_roll(stiffness, depth):
    """At its rim it weighs J / r^2 = 1e-6 kg: what friction can do in a step turns it to and fro.

    So it takes it by 2 |v + r omega| J / (m r^2) off its way at most.
    """
    m, J, r, v, omega = 0.02, 1e-8, 0.1, 0.4, 3.0
    start = Start([0, 0, r - depth], velocity=[0, v, -0.2], angular_velocity=[omega, 0, 0])
    law = {"impact": Impact(stiffness), "friction": 0.5, "tangential_stiffness": 20.0}
    model = model_of(
        {"ball": RigidBody(m, [J, 5e-5, 5e-5], start=start)},
        contacts=[floor(ball=r, **law)],
        gravity=-G * UP,
        t_end=0.02,
        step=5e-4,
        **FLOOR,
    )
    motion = simulate(model).body("ball")
    change = np.abs(motion.v[:, 1] - v).max()
    assert 0.0 < change < 2.0 * (v + r * omega) * J / (m * r**2)


@pytest.mark.parametrize("shape", ["sphere", "cylinder"])
def test_a_ball_rolls_down_inside_a_bowl(shape):
    """Without slip: v^2 = 10/7 g (R - r)(1 - cos); the tangents are carried along."""
    m, r, R, K, angle = 1.0, 0.05, 0.3, 1e7, 0.6
    axis = {"axis": [0.0, 1.0, 0.0]} if shape == "cylinder" else {}
    place = (R - r) * np.array([np.sin(angle), 0.0, -np.cos(angle)])
    contact = Contact(
        "bowl",
        ("ground.floor", "ball"),
        shape,
        r,
        radius=R,
        hollow=True,
        impact=Impact(stiffness=K, damping=0.5),
        friction=0.9,
        tangential_stiffness=1e6,
        **axis,
    )
    model = model_of(
        {"ball": ball(m, r, position=place)},
        contacts=(contact,),
        **FLOOR,
        gravity=[0, 0, -G],
        t_end=0.6,
        step=1e-4,
    )
    results = simulate(model)
    x, v = results.body("ball").x, results.body("ball").v
    speed = np.linalg.norm(v[:, :3], axis=1)
    expected = np.sqrt(10 / 7 * G * (R - r) * (1 - np.cos(angle)))
    assert speed.max() == pytest.approx(expected, rel=2e-3)
    assert np.abs(x[:, 1]).max() < 1e-9
    assert results.iterations.max() <= 10


def box(**contacts):
    a, mass = 0.1, 1.0
    corners = {
        f"c{i}": Frame(a * np.array([1 - 2 * (i & 1), 1 - (i & 2), 1 - (i & 4) / 2]))
        for i in range(8)
    }
    start = Start([0, 0, 0.5], [0.4, 0.3, 0.2], velocity=[1, 0.3, 0], angular_velocity=[3, -4, 5])
    body = RigidBody(mass, np.full(3, mass * (2 * a) ** 2 / 6), corners, start)
    law = {"impact": Impact(stiffness=1e5, restitution=0.4), "friction": 0.4}
    return model_of(
        {"box": body},
        contacts=[
            floor(f"k{i}", f"box.c{i}", **law, tangential_stiffness=5e4, **contacts)
            for i in range(8)
        ],
        **FLOOR,
        gravity=[0, 0, -G],
        t_end=5.0,
        step=2e-4,
    )


def test_a_box_tumbles_to_rest():
    results = simulate(box())
    assert np.abs(results.body("box").v[-1]).max() < 1e-12
    forces = sum(results.contact(f"k{i}").force[-1, 0] for i in range(8))
    assert forces == pytest.approx(G, rel=1e-9)
    assert results.iterations.max() <= 10
    lost = results.energy.dissipated[-1] / (results.energy.kinetic[0] + G * 0.4)
    assert lost == pytest.approx(1.0, abs=5e-3)


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.1])
def test_a_journal_hangs_in_its_bore(angle):
    """In equilibrium at the depth (m g / K)^(1/n), whatever the direction of gravity."""
    K, n, m, play = 1e8, 1.5, 2.0, 1e-3
    g = G * np.array([np.sin(angle), -np.cos(angle), 0.0])
    depth = (m * G / K) ** (1 / n)
    contact = Contact(
        "bore",
        ("ground.floor", "journal"),
        "cylinder",
        0.009,
        [0, 0, 1],
        0.009 + play,
        True,
        impact=Impact(stiffness=K, exponent=n),
    )
    model = model_of(
        {"journal": RigidBody(m, [0.1] * 3, start=Start(g / G * (play + 0.5 * depth)))},
        [Planar("ground", "journal", [0, 0, 1], name="plane")],
        contacts=(contact,),
        **FLOOR,
        gravity=g,
        t_end=1e-3,
        step=1e-5,
        start="equilibrium",
    )
    x = simulate(model).body("journal").x[[0, -1]]
    np.testing.assert_allclose(x @ g / G, play + depth, rtol=1e-12)


def test_a_ball_passes_the_end_of_a_cylinder():
    """No contact beyond the end, none that begins there, and the usual one within."""
    rod = {"radius": 0.05, "length": 0.1, "impact": Impact(stiffness=1e6)}
    heights = {}
    for name, x, speed in (("past", 0.06, 0.0), ("in", 0.09, -2.0), ("on", 0.0, 0.0)):
        z = 0.04 if name == "in" else 0.2
        contact = Contact("rod", ("ground.floor", "ball"), "cylinder", 0.02, [1, 0, 0], **rod)
        model = model_of(
            {"ball": ball(position=[x, 0, z], velocity=[speed, 0, 0])},
            contacts=(contact,),
            **FLOOR,
            gravity=[0, 0, 0 if name == "in" else -G],
            t_end=0.3,
            step=1e-4,
        )
        heights[name] = simulate(model).body("ball").x[:, 2]
    assert heights["past"][-1] == pytest.approx(0.2 - 0.5 * G * 0.09, abs=1e-9)
    np.testing.assert_array_equal(heights["in"], 0.04)
    assert heights["on"].min() > 0.07 - 1e-3


def circle(R, n=48):
    angles = np.linspace(0.0, 2.0 * np.pi, n + 1)
    points = R * np.column_stack([np.cos(angles), np.sin(angles)])
    points[-1] = points[0]
    return points


@pytest.mark.parametrize("hollow", [False, True])
def test_a_profile_through_a_circle_is_a_cylinder(hollow):
    """A ball rolls on it, with friction, as on the cylinder."""
    r, R, K = 0.02, 0.1, 1e6
    found = {}
    for shape in ("cylinder", "profile"):
        size = {"radius": R} if shape == "cylinder" else {"points": circle(R)}
        turned = Rotation.from_rotvec([0.3, 0.2, 0.7])
        z = -(R - r + 1e-6) if hollow else R + r - 1e-6
        place = turned.apply([z * np.sin(0.5), 0.0, z * np.cos(0.5)])
        contact = Contact(
            "c",
            ("ground.floor", "ball"),
            shape,
            r,
            turned.apply([0, 1, 0]),
            hollow=hollow,
            impact=Impact(stiffness=K),
            friction=0.5,
            tangential_stiffness=1e5,
            **size,
        )
        model = model_of(
            {"ball": ball(0.1, r, position=place)},
            contacts=(contact,),
            **FLOOR,
            gravity=turned.apply([0, 0, -G]),
            t_end=0.2,
            step=1e-4,
        )
        found[shape] = simulate(model).body("ball").x
    assert np.ptp(found["cylinder"], axis=0).max() > 0.03
    np.testing.assert_allclose(found["profile"], found["cylinder"], rtol=0, atol=2e-5)


def test_a_follower_on_an_eccentric_cam():
    """The lift of a flat-footed point follower by the profile of an eccentric circle."""
    R, e, speed = 0.03, 0.008, 20.0
    cam = RigidBody(1.0, [1e-3] * 3, {"profile": Frame()})
    foot = RigidBody(0.2, [1e-4] * 3, {"foot": Frame()}, Start([0.0, R + e, 0.0]))
    points = circle(R, 96) + np.array([0.0, e])
    contact = Contact(
        "cam",
        ("cam.profile", "foot.foot"),
        "profile",
        0.0,
        [0, 0, 1],
        points=points,
        impact=Impact(stiffness=1e7, damping=1.0),
    )
    model = model_of(
        {"cam": cam, "foot": foot},
        [
            Revolute("ground", "cam", UP, name="shaft", angle=Polynomial((0.0, speed))),
            Prismatic("ground", "foot", [0, 1, 0], name="guide"),
        ],
        contacts=(contact,),
        springs=(Spring("back", "point", ("ground.under", "foot"), stiffness=500.0, rest=[0.01]),),
        ground_frames={"under": Frame([0.0, -0.1, 0.0])},
        t_end=0.4,
        step=1e-4,
    )
    results = simulate(model)
    angle = speed * results.time
    lift = e * np.cos(angle) + np.sqrt(R**2 - (e * np.sin(angle)) ** 2)
    height = results.body("foot").x[:, 1]
    sinking = results.contact("cam").force[:, 0] / 1e7
    np.testing.assert_allclose(height + sinking, lift, rtol=0, atol=3e-6)
    assert (results.contact("cam").state[100:] == 1).all()


def test_a_table_is_a_spring_by_its_points():
    """A ball on a bilinear spring: its depth from the energy under the table."""
    m, table = 0.1, ForceTable((0.0, 1e-3, 2e-3), (0.0, 10.0, 40.0))
    model = model_of(
        {"ball": ball(m, position=[0, 0, 1e-4], velocity=[0, 0, -0.6])},
        contacts=(floor(impact=Impact(law=table)),),
        **FLOOR,
        t_end=0.02,
        step=1e-5,
    )
    results = simulate(model)
    depth = -results.body("ball").x[:, 2].min()
    d = np.linspace(0.0, depth, 10001)
    force = np.interp(d, table.penetration, table.force)
    assert depth > 1e-3
    assert np.trapezoid(force, d) == pytest.approx(0.5 * m * 0.36, rel=1e-4)
    assert results.body("ball").v[-1, 2] == pytest.approx(0.6, rel=1e-4)


def test_the_compliance_of_a_patch_is_taken_off():
    """With it and the patch's own compliance in series the indentation is that of Hertz."""
    r, b = 0.02, 2e-3
    plain = Contact("c", ("a", "b"), "plane", r, UP, hertz=STEEL).law()
    less = Contact("c", ("a", "b"), "plane", r, UP, hertz=STEEL, patch=[b, 0.0]).law()
    C = STEEL.patch_compliance((b, 0.0))
    none = np.zeros(1)
    for force in (1.0, 100.0, 1e4):
        d = (force / plain.stiffness) ** (2 / 3) - C * force
        found, stiffness, _, energy = less.evaluate(np.array(less.parameters()), none, 0.0, -d, 0.0)
        assert -found == pytest.approx(force, rel=1e-10)
        hertz = 1.0 / (1.5 * plain.stiffness * (force / plain.stiffness) ** (1 / 3))
        assert 1.0 / stiffness == pytest.approx(hertz - C, rel=1e-9)
        stored = 0.4 * force * (force / plain.stiffness) ** (2 / 3) - 0.5 * C * force**2
        assert energy == pytest.approx(stored, rel=1e-9)


def test_backlash_of_a_torsion_pendulum():
    """Free play, then a stop on either side, against an integrator with a tolerance of 1e-10."""
    J, K, play = 0.01, 40.0, 0.02
    model = model_of(
        {"wheel": RigidBody(1.0, [J] * 3, start=Start(angular_velocity=[0, 0, 2.0]))},
        [Revolute("ground", "wheel", UP, name="axle")],
        stops=(Stop("play", "axle", "angle", (-play, play), Impact(stiffness=K, exponent=1.5)),),
        t_end=2.0,
        step=1e-4,
    )
    results = simulate(model)

    def rates(t, y):
        beyond = max(abs(y[0]) - play, 0.0)
        return [y[1], -np.sign(y[0]) * K * beyond**1.5 / J]

    exact = solve_ivp(
        rates, (0, 2), [0, 2.0], rtol=1e-10, atol=1e-12, t_eval=results.time, max_step=1e-3
    )
    assert np.abs(exact.y[1] - results.body("wheel").v[:, 5]).max() < 3e-4


@pytest.mark.parametrize("one_side", [(-np.inf, 0.3), (-0.3, np.inf)])
def test_a_stop_on_one_side(one_side):
    wheel = RigidBody(1.0, [0.01] * 3, start=Start(angular_velocity=[0, 0, 2.0]))
    model = model_of(
        {"wheel": wheel},
        [Revolute("ground", "wheel", UP, name="axle")],
        stops=(Stop("end", "axle", "angle", one_side, Impact(stiffness=1e3, restitution=0.5)),),
        t_end=1.0,
        step=1e-4,
    )
    w = simulate(model).body("wheel").v[-1, 5]
    assert w == pytest.approx(2.0 if one_side[1] > 1 else -1.0, abs=2e-3)


@pytest.mark.parametrize("coefficient", [0.1, Stribeck(0.2, 0.1, 0.05)])
def test_friction_stops_a_wheel(coefficient):
    """J w' = -mu r m g until it rests, without creep."""
    J, mu, r, m = 0.5, 0.1, 0.05, 2.0
    friction = JointFriction(coefficient, r)
    model = model_of(
        {"wheel": RigidBody(m, [J] * 3, start=Start(angular_velocity=[0, 0, 0.3]))},
        [Revolute("ground", "wheel", UP, name="axle", friction=friction)],
        gravity=[0, -G, 0],
        t_end=2.5,
        step=1e-3,
    )
    results = simulate(model)
    w, slowing = results.body("wheel").v[:, 5], mu * r * m * G / J
    if isinstance(coefficient, float):
        np.testing.assert_allclose(np.diff(w[100:1001]), -slowing * 1e-3, rtol=1e-9)
    assert np.abs(w[-300:]).max() < 1e-9
    assert results.energy.dissipated[-1] == pytest.approx(0.5 * J * 0.09, rel=1e-6)


@pytest.mark.parametrize("mu", [0.4, 0.2])
def test_friction_of_a_guide_on_an_incline(mu):
    a = np.radians(20.0)
    axis = np.array([np.cos(a), 0, -np.sin(a)])
    friction = JointFriction(Coulomb(mu))
    model = model_of(
        {"block": RigidBody(2.0, [0.5] * 3)},
        [Prismatic("ground", "block", axis, name="guide", friction=friction)],
        gravity=[0, 0, -G],
        t_end=1.0,
        step=1e-3,
    )
    v = simulate(model).body("block").v[:, :3] @ axis
    expected = max(0.0, G * (np.sin(a) - mu * np.cos(a)))
    assert (v[-1] - v[-101]) / 0.1 == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize(("width", "moment"), [(None, 0.0), (0.4, 3.0)])
def test_friction_by_thrust_moments_and_preload(width, moment):
    """mu r (|thrust| + preload + 2 M / width), and what is viscous."""
    J, mu, r, w0 = 0.5, 0.1, 0.05, 3.0
    friction = JointFriction(mu, r, width, preload=7.0, viscous=0.02)
    tilt = Torque("wheel", [moment, 0.0, 0.0], Constant(1.0))
    model = model_of(
        {"wheel": RigidBody(2.0, [J] * 3, start=Start(angular_velocity=[0, 0, w0]))},
        [Revolute("ground", "wheel", UP, name="axle", friction=friction)],
        loads=(tilt,),
        gravity=[0, 0, -G],
        t_end=0.5,
        step=1e-3,
    )
    results = simulate(model)
    torque = mu * r * (2.0 * G + 7.0 + (2.0 * moment / width if width else 0.0))
    rate = np.gradient(results.body("wheel").v[:, 5], results.time)[250]
    expected = -(torque + 0.02 * results.body("wheel").v[250, 5]) / J
    assert rate == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("thrust", [0.0, 500.0])
def test_friction_of_a_constant_torque_does_not_depend_on_the_load(thrust):
    """J w' = -torque - viscous w until it rests, whatever the axle carries."""
    J, torque, viscous, w0 = 0.5, 0.04, 0.1, 0.3
    friction = JointFriction(torque=torque, viscous=viscous)
    model = model_of(
        {"wheel": RigidBody(2.0, [J] * 3, start=Start(angular_velocity=[0, 0, w0]))},
        [Revolute("ground", "wheel", UP, name="axle", friction=friction)],
        loads=(Force("wheel", [1.0, 0.0, -1.0], Constant(thrust)),),
        t_end=4.0,
        step=1e-3,
    )
    results = simulate(model)
    w, t = results.body("wheel").v[:, 5], results.time
    # w = (w0 + T / c) exp(-c t / J) - T / c; friction acts from the first step on, not at t = 0
    exact = (w0 + torque / viscous) * np.exp(-viscous * t / J) - torque / viscous
    np.testing.assert_allclose(w, np.maximum(exact, 0.0), atol=1e-3 * w0)
    assert np.abs(w[-300:]).max() < 1e-9


@pytest.mark.parametrize(("force", "moves"), [(3.0, True), (7.0, False)])
def test_friction_of_a_constant_force_holds_a_slide_up_to_it(force, moves):
    """A block of 2 kg on a slope of 20 degrees is pulled down it by 6.71 N."""
    a = np.radians(20.0)
    axis = np.array([np.cos(a), 0, -np.sin(a)])
    model = model_of(
        {"block": RigidBody(2.0, [0.5] * 3)},
        [Prismatic("ground", "block", axis, name="guide", friction=JointFriction(force=force))],
        gravity=[0, 0, -G],
        t_end=1.0,
        step=1e-3,
    )
    v = simulate(model).body("block").v[:, :3] @ axis
    expected = G * np.sin(a) - 0.5 * force if moves else 0.0
    assert (v[-1] - v[-101]) / 0.1 == pytest.approx(expected, abs=1e-6)


def test_a_beam_on_a_wall_is_its_full_mesh_on_a_wall(beam):
    """Axial impact by the same law, every displacement an unknown: equal to 1e-10."""
    h, rho, K, factor, n = 1e-5, 0.9, 3e8, 0.3, 300
    element, structure = beam.element, beam.structure
    axis = structure.interfaces[1].X - structure.interfaces[0].X
    axis = axis / np.linalg.norm(axis)
    tip, gap = structure.interfaces[1].X, 1e-5
    contact = Contact(
        "wall",
        ("ground.wall", "beam.tip"),
        "plane",
        0.0,
        -axis,
        impact=Impact(stiffness=K, exponent=1.5, damping=factor),
    )
    model = model_of(
        {"beam": FlexibleBody(element, Start(velocity=axis))},
        contacts=(contact,),
        ground_frames={"wall": Frame(tip + gap * axis)},
        t_end=n * h,
        step=h,
        rho_inf=rho,
        history="recursive",
        tolerance=1e-13,
    )
    results = simulate(model)

    tip_row = structure.P_C.toarray()[6:9].T @ axis
    forces, x = march_on_wall(structure, tip_row, axis, gap, (K, factor), h, rho, n)
    found = results.contact("wall").force[:, 0]
    assert forces.max() > 300.0
    np.testing.assert_allclose(found, forces, rtol=0, atol=1e-10 * forces.max())
    assert results.body("beam").x[-1] @ axis == pytest.approx(x, abs=1e-12)


def march_on_wall(structure, tip, axis, gap, law, h, rho, n):
    """Generalized-alpha of M u'' + K u = -F tip, F = K d^1.5 (1 + c d'), d = tip . u - gap."""
    M, K = structure.M.toarray(), structure.K.toarray()
    alpha_m, alpha_f = (2 * rho - 1) / (rho + 1), rho / (rho + 1)
    gamma, beta = 0.5 - alpha_m + alpha_f, 0.25 * (1 - alpha_m + alpha_f) ** 2
    share = (1 - alpha_f) / (1 - alpha_m)
    S = np.linalg.inv(M + h * h * beta * share * K)
    flexibility = S @ tip
    u, U, frames = np.zeros(len(M)), structure.U, structure.P_C.toarray() @ structure.U
    along = U @ np.linalg.lstsq(frames, np.tile([*axis, 0, 0, 0], 2), rcond=None)[0]
    v, v_dot, a, forces = along, np.zeros(len(M)), np.zeros(len(M)), [0.0]
    for _ in range(n):
        a_free = (alpha_f * v_dot - alpha_m * a) / (1 - alpha_m)
        u_free = u + h * v + h * h * ((0.5 - beta) * a + beta * a_free)
        v_free = v + h * ((1 - gamma) * a + gamma * a_free)
        free = S @ (-K @ u_free)

        # displacement and rate of the tip are linear in the force
        d_free = tip @ (u_free + h * h * beta * share * free) - gap
        rate_free = tip @ (v_free + h * gamma * share * free)
        soft = tip @ flexibility
        F = force_on_wall(
            d_free, rate_free, h * h * beta * share * soft, h * gamma * share * soft, law
        )
        v_dot = free - flexibility * F
        a_new = a_free + share * v_dot
        u, v, a = u_free + h * h * beta * share * v_dot, v_free + h * gamma * share * v_dot, a_new
        forces.append(F)
    return np.array(forces), along @ M @ u / structure.rigid.mass


def force_on_wall(d_free, rate_free, sinking, slowing, law):
    """F = K d^1.5 (1 + c d') of d = d_free - sinking F and d' = rate_free - slowing F."""
    K, c = law

    def missed(F):
        d, rate = d_free - sinking * F, rate_free - slowing * F
        return F - (max(0.0, K * d**1.5 * (1 + c * rate)) if d > 0 else 0.0)

    if missed(0.0) >= 0.0:
        return 0.0
    return brentq(missed, 0.0, 1e9, xtol=1e-12, rtol=1e-15, maxiter=500)


@pytest.mark.parametrize(("speed", "stiffness"), [(1e-3, 1e4), (1e-5, 1e5)])
def test_stick_and_slip_have_the_period_of_the_closed_form(speed, stiffness):
    """A mass on a belt, held by a spring: it sticks until mu_s N, then slips as an oscillator.

    The bristle of what sticks bends at 1e-3 m/s and 1e-4 m/s, which is no slip: with it taken for
    slip the period was 21 % short.
    """
    m, k, V, static, sliding, h = 1.0, 100.0, 0.1, 0.6, 0.4, 2e-4
    drop, w = (static - sliding) * m * G, np.sqrt(k / m)
    period = 2.0 * drop / (k * V) + 2.0 / w * (np.pi - np.arctan(drop * w / (k * V)))
    belt = Contact(
        "belt",
        ("belt", "mass"),
        "plane",
        0.0,
        UP,
        impact=Impact(stiffness=1e6, restitution=0.1),
        friction=Stribeck(static, sliding, speed),
        tangential_stiffness=stiffness,
    )
    model = model_of(
        {
            "mass": RigidBody(m, [0.1] * 3),
            "belt": RigidBody(5.0, [1.0] * 3, start=Start(velocity=[V, 0, 0])),
        },
        (
            Planar("ground.floor", "mass", [0, 1, 0], name="guide"),
            Prismatic("ground", "belt", [1, 0, 0], name="drive", velocity=Constant(V)),
        ),
        springs=(
            Spring("spring", "bushing", ("ground.floor", "mass"), stiffness=[k, 0, 0, 0, 1000, 0]),
        ),
        contacts=(belt,),
        **FLOOR,
        gravity=[0, 0, -G],
        t_end=4.5,
        step=h,
        rho_inf=0.9,
    )
    results = simulate(model)
    late = results.time > 1.5
    x, t = results.body("mass").x[late, 0], results.time[late]
    tops = [i for i in range(1, len(x) - 1) if x[i - 1] < x[i] >= x[i + 1] and x[i] > 0.5 * x.max()]
    gaps = np.diff(t[tops])
    found = gaps[gaps > 0.3 * period].mean()  # not the ripples on one top
    assert found == pytest.approx(period, rel=0.015)  # by the bristle and the speed of the drop


@pytest.mark.parametrize("ratio", [1.0, 1.05, 2.0, 30.0, 1e4])
def test_the_elliptic_patch_of_hertz_carries_his_pressure(ratio):
    """The pressure p0 sqrt(1 - x^2/a^2 - y^2/b^2) sinks the surface by d - k1/2 x^2 - k2/2 y^2.

    By its potential, of which the integrals are taken numerically.
    """
    k1, k2 = 3.0, 3.0 * ratio
    patch = patch_of(k2, k1)
    a, b = patch.long, patch.short  # at d = 1

    def potential(i, j):
        def integrand(x):  # w = b^2 exp(x)
            w = b**2 * np.exp(x)
            return w / ((a**2 + w) ** (0.5 + i) * (b**2 + w) ** (0.5 + j) * np.sqrt(w))

        return quad(integrand, -60.0, 60.0, limit=500, epsabs=0.0, epsrel=1e-12)[0]

    pressure = 2.0 / (a * b * potential(0, 0))  # over E*
    assert 0.5 * pressure * a * b * potential(1, 0) == pytest.approx(0.5 * k1, rel=1e-9)
    assert 0.5 * pressure * a * b * potential(0, 1) == pytest.approx(0.5 * k2, rel=1e-9)
    assert patch.stiffness == pytest.approx(2.0 / 3.0 * np.pi * a * b * pressure, rel=1e-9)
    if ratio == 1.0:
        assert patch.stiffness == pytest.approx(4.0 / 3.0 * np.sqrt(1.0 / k1), rel=1e-12)


def test_a_ball_in_a_tight_bore_has_the_stiffness_of_its_ellipse():
    """1 % of clearance: sums of curvatures of 100 and 0.99 1/m; by their mean 1.44 times softer."""
    bore = Contact(
        "bore",
        ("ground.floor", "ball"),
        "cylinder",
        0.01,
        UP,
        radius=0.0101,
        hollow=True,
        hertz=STEEL,
    )
    along, around = 100.0, 100.0 - 1.0 / 0.0101
    E = 1.0 / (2 * (1 - 0.09) / 2.1e11)
    assert bore.law().stiffness == pytest.approx(E * patch_of(along, around).stiffness, rel=1e-14)
    mean = 4.0 / 3.0 * E * (along * around) ** -0.25
    assert bore.law().stiffness / mean == pytest.approx(1.44, abs=0.02)
    assert bore.patch_over_radius == pytest.approx(patch_of(along, around).long / 0.01, rel=1e-14)


def nearest_of_all(parameters, px, py):
    """As `shapes.nearest`, with the samples of all pieces."""
    best = math.inf, 0, 0.0
    for i in range(int(parameters[0])):
        for t in np.linspace(0.0, parameters[1 + shapes.NUMBERS_PER_PIECE * i], 5):
            at = [shapes.cubic(parameters, i, k, t)[0] for k in (1, 5)]
            best = min(best, ((px - at[0]) ** 2 + (py - at[1]) ** 2, i, t))
    return shapes.polished(parameters, int(parameters[0]), *best[1:], px, py)


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("seed", range(8))
def test_the_nearest_point_of_a_profile_is_that_of_a_search_of_all_pieces(seed, closed):
    rng = np.random.default_rng(seed)
    points = np.cumsum(rng.standard_normal((12, 2)), axis=0)
    points = np.vstack([points, points[:1]]) if closed else points
    law = Impact(1e6)
    cam = Contact("cam", ("ground", "ball"), "profile", 0.01, UP, points=points, impact=law)
    parameters = np.array(cam.shape_parameters())
    for p in 3.0 * rng.standard_normal((40, 2)):
        both = [search(parameters, *p) for search in (shapes.nearest, nearest_of_all)]
        at = [[shapes.cubic(parameters, i, k, t)[0] for k in (1, 5)] for i, t in both]
        found, expected = np.linalg.norm(np.array(at) - p, axis=1)
        assert found == pytest.approx(expected, rel=1e-12)
