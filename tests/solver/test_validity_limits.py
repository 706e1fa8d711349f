"""Both sides of limits of docs/validity.md: within, results are as near as the page says; beyond, a
run says so.
"""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from duhamel.preprocess import read_body
from duhamel.preprocess.body.body import NonlinearCoordinates, PointMass
from duhamel.preprocess.body.selection import InterfaceSelection
from duhamel.results.criteria import CRITERIA
from duhamel.solver import (
    Constant,
    Contact,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Harmonic,
    Impact,
    Impulse,
    Model,
    PointOnLine,
    Prismatic,
    Revolute,
    RigidBody,
    Settings,
    Spring,
    Start,
    SteadyRotation,
    Torque,
    Universal,
    ValidityWarning,
    check,
    linearize,
    simulate,
    start,
)
from duhamel.solver.history.axial import axial_weights
from duhamel.solver.model.rigid_outline import box_of_inertia
from duhamel.superelement import Outline, Recovery
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from .conftest import BEAM, line_mesh, make_beam
from .models import model_of

L, EI, MASS, G = 0.5, 5.5, 0.0858 * 0.5, 9.81
PAPERS = read_body(BEAM)
EULER = np.pi**2 * EI / L**2
"""load of the beam hinged at both ends"""


def warned(validity, criterion):
    """Whether a warning names it."""
    quantity = f": {CRITERIA[criterion].quantity}: "
    return any(quantity in line for line in validity.warnings)


# Forces of joints


@pytest.mark.parametrize("rho_inf", [0.6, 0.9, 0.97])
@pytest.mark.parametrize(
    ("step", "away", "mass"),
    [(1e-5, 0.0, 1.0), (1e-6, 0.0, 1e-3), (1e-7, 0.0, 1.0), (1e-5, 1e3, 1.0)],
)
def test_noise_in_the_force_of_a_joint_is_told(step, away, mass, rho_inf):
    """A pendulum that swings; a smooth force has no third differences, an alternating one all."""
    bob = RigidBody(
        mass,
        [0.1 * mass] * 3,
        {"eye": Frame([0, 1, 0])},
        Start([away + 0.6, -0.8, 0], [0, 0, np.arctan2(0.6, 0.8)]),
    )
    model = Model(
        {"bob": bob},
        [Revolute("ground", "bob.eye", [0, 0, 1], name="pin")],
        gravity=[0, -G, 0],
        settings=Settings(t_end=3000 * step, step=step, rho_inf=rho_inf),
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ValidityWarning)
        results = simulate(model)
    force = results.joint("pin").force[500:]
    noise = np.sqrt((np.diff(force, 3, axis=0) ** 2).sum(axis=1).mean()) / 8.0
    share = noise / np.abs(force).max()
    (told,) = results.validity.values("force_noise").values()
    assert share / 3.0 < told < 3.0 * share
    assert warned(results.validity, "force_noise") == (told > CRITERIA["force_noise"].limit)


def test_a_joint_of_a_model_at_rest_has_no_noise():
    bodies = {"wheel": RigidBody(1.0, [1.0] * 3, {}, Start([0.3, 0.7, 1e3]))}
    axle = [Revolute("ground", "wheel", [0.6, 0.8, 0], name="axle")]
    results = simulate(Model(bodies, axle, settings=Settings(t_end=1e-4, step=1e-6)))
    assert results.validity.values("force_noise") == {"axle": 0.0}


# Axial loads


def hinged(element, force):
    """The beam hinged at both ends, under an axial force, tension positive, in equilibrium."""
    universal = Universal("ground", "beam.root", [0, 1, 0], [0, 0, 1], name="root")
    return model_of(
        {"beam": FlexibleBody(element, Start([0.5 * L, 0, 0]))},
        [universal, PointOnLine("ground.tip", "beam.tip", [1, 0, 0], name="tip")],
        loads=[Force("beam.tip", [1, 0, 0], Constant(force))],
        ground_frames={"tip": Frame([L, 0, 0])},
        start="equilibrium",
        t_end=1e-3,
        step=1e-4,
    )


@pytest.mark.parametrize("share", [-0.5, -0.06, -0.045, 0.019, 0.06])
def test_an_axial_force_changes_the_frequency_by_half_its_share_of_eulers_load(beam, share):
    """Which the body does not know without terms of second order: sqrt(1 + N / P)."""
    model = hinged(beam.element, share * EULER)
    validity = start(model).validity
    found = linearize(model).modes(6).frequencies
    right = np.pi / (2.0 * L**2) * np.sqrt(EI * L / MASS) * np.sqrt(1.0 + share)
    error = np.abs(found[found > 1.0].min() / right - 1.0)
    assert error == pytest.approx(abs((1.0 + share) ** -0.5 - 1.0), rel=0.05)
    assert validity.values("axial_load")["beam"] == pytest.approx(abs(share), rel=1e-3)
    assert warned(validity, "axial_load") == (error > 0.026)


@pytest.mark.parametrize("places", [(0.0, L), (0.5 * L,)])
def test_heavy_masses_change_neither_the_axial_force_nor_eulers_load(places):
    """Whatever frequency the free body has by them: in runs, and in linear analysis."""
    masses = {f"m{x}": PointMass(node=(x, 0.0, 0.0), mass=10.0 * MASS) for x in places}
    model = hinged(make_beam(masses=masses).element, 0.06 * EULER)
    validity, linear = start(model).validity, linearize(model).validity()
    (preload,) = (c.value for c in linear.checks if c.criterion.name == "axial_preload")
    assert [preload, validity.values("axial_load")["beam"]] == pytest.approx([0.06] * 2, rel=1e-3)
    assert warned(validity, "axial_load")
    assert any("axial force" in line for line in linear.warnings)


@pytest.mark.parametrize(("mass", "spin"), [(0.0, 0.049), (10.0, 0.049), (100.0, 0.029)])
def test_heavy_ends_of_a_free_beam_that_spins_stretch_it(mass, spin):
    """By M Omega^2 L / 2, and its own mass by m Omega^2 L / 12 in the mean.

    The bending frequency across the plane of rotation rises as that of a hinged beam at most.
    """
    ends = (0.0, L) if mass else ()
    masses = {f"m{x}": PointMass(node=(x, 0.0, 0.0), mass=mass * MASS) for x in ends}
    elements = [
        make_beam(masses=masses, **changes).element
        for changes in ({}, {"rotation": NonlinearCoordinates(modes=8)})
    ]
    omega = spin * elements[0].modes.omega.min()
    found = []
    for element in elements:
        model = model_of({"beam": FlexibleBody(element)}, t_end=6e-4, step=6e-5)
        linear = linearize(model, SteadyRotation([0, 0, omega]))
        frequencies = linear.modes(12).frequencies
        found.append(frequencies[frequencies > 0.3 * element.modes.frequencies.min()].min())
        if element is elements[0]:
            (preload,) = (
                c.value for c in linear.validity().checks if c.criterion.name == "axial_preload"
            )
    turning = FlexibleBody(elements[0], Start(angular_velocity=[0, 0, omega]))
    validity = simulate(model_of({"beam": turning}, t_end=6e-4, step=6e-5)).validity
    force = (mass / 2.0 + 1.0 / 12.0) * MASS * omega**2 * L / EULER
    assert preload == pytest.approx(force, rel=1e-3)
    assert validity.values("axial_load")["beam"] == pytest.approx(force, rel=1e-3)
    assert abs(found[0] / found[1] - 1.0) < 0.026 or warned(validity, "axial_load")


@pytest.mark.parametrize("mass", [1.0, 10.0, 100.0])
def test_a_heavy_tip_that_hangs_on_a_beam_with_one_interface(mass):
    """Its weight is the axial force, which the value tells to a third."""
    masses = {"tip": PointMass(node=(L, 0.0, 0.0), mass=mass * MASS)}
    root = {"root": PAPERS.interfaces["root"]}
    element = make_beam(masses=masses, interfaces=root).element
    weight = (mass + 0.5) * MASS
    model = model_of(
        {"beam": FlexibleBody(element, Start(-element.interface("root").X))},
        [Fixed("ground", "beam.root", name="clamp")],
        gravity=[0.05 * EULER / weight, 0, 0],
        start="equilibrium",
        t_end=1e-3,
        step=1e-4,
    )
    assert 0.045 < start(model).validity.values("axial_load")["beam"] < 0.067


@pytest.mark.parametrize("share", [-0.045, 0.045])
def test_what_a_clamped_column_misses_is_less(beam, share):
    """Deflection of its tip across an axial force N there, against that of a beam-column.

    Its critical load is P / 4, so that N changes the deflection by a fifth.
    """
    model = model_of(
        {"beam": FlexibleBody(beam.element, Start([0.5 * L, 0, 0]))},
        [Fixed("ground", "beam.root", name="clamp")],
        loads=[
            Force("beam.tip", [1, 0, 0], Constant(share * EULER)),
            Force("beam.tip", [0, 1, 0], Constant(1e-3)),
        ],
        start="equilibrium",
        t_end=1e-3,
        step=1e-4,
    )
    results = start(model)
    u = L * np.sqrt(complex(-share * EULER / EI))
    right = (1e-3 * L**3 / EI * (np.tan(u) - u) / u**3).real
    error = results.frame("beam.tip").position[0, 1] / right - 1.0
    assert 0.02 < abs(error) < 0.04
    assert not results.validity.warnings


def test_a_body_with_terms_of_second_order_has_no_such_limit():
    element = make_beam(rotation=NonlinearCoordinates()).element
    validity = start(hinged(element, -0.2 * EULER)).validity
    assert not validity.values("axial_load")
    assert not validity.warnings


@pytest.mark.parametrize("ends", [("root", "tip"), ("root",)])
def test_a_hanging_beam_bears_half_its_weight_in_the_mean(beam, ends):
    """Its Euler load is that between its interfaces, or with one that of a bar of its frequency."""
    interfaces = {name: PAPERS.interfaces[name] for name in ends}
    element = make_beam(interfaces=interfaces).element
    model = model_of(
        {"beam": FlexibleBody(element, Start([0.5 * L, 0, 0]))},
        [Fixed("ground", "beam.root", name="clamp")],
        gravity=[G, 0, 0],
        start="equilibrium",
        t_end=1e-3,
        step=1e-4,
    )
    found = start(model).validity.values("axial_load")["beam"]
    assert found == pytest.approx(0.5 * MASS * G / EULER, rel=1e-3)


def test_a_blow_along_a_beam_counts_by_its_impulse(beam):
    """In a mean over 1 / omega_1 of the beam when free; its peak is Euler's load."""
    h = 6e-5
    model = model_of(
        {"beam": FlexibleBody(beam.element)},
        loads=[Force("beam.tip", [1, 0, 0], Impulse(EULER * h, 0.003))],
        t_end=0.006,
        step=h,
    )
    angle = h * beam.element.modes.omega.min()
    found = simulate(model).validity.values("axial_load")["beam"]
    assert found == pytest.approx(0.5 * angle, rel=0.1)


def test_the_softest_lines_of_a_body_come_first_and_are_not_parallel(random_element):
    element = random_element(3, (True,) * 6)
    weights = axial_weights(element)
    assert len(weights) == 3
    for weight in weights:  # each a symmetric dipole along its line
        forces = weight.reshape(6, 6)
        assert not forces[:, 3:].any()
        assert np.linalg.matrix_rank(forces[:, :3], tol=1e-12) == 1


# Rigid bodies


def beside_a_slow_mass(steps, periods=60):
    """A mass on a spring beside one of a thousand times its energy, which is slow."""
    h, omega = 0.1 / steps, 2.0 * np.pi * 10.0
    fast = Start([1, 0, 0], velocity=[0.01 * omega, 0, 0])
    slow = Start([0, 1, 0], velocity=[0, 1.0, 0])
    return Model(
        {
            "fast": RigidBody(1.0, [0.01] * 3, start=fast),
            "slow": RigidBody(1000.0, [10.0] * 3, start=slow),
        },
        [
            Prismatic("ground", "fast", [1, 0, 0], name="x"),
            Prismatic("ground", "slow", [0, 1, 0], name="y"),
        ],
        springs=[
            Spring("stiff", "point", ("ground.wall", "fast"), stiffness=omega**2),
            Spring("soft", "point", ("ground.wall", "slow"), stiffness=1000.0),
        ],
        ground_frames={"wall": Frame()},
        settings=Settings(t_end=0.1 * periods, step=h),
    )


@pytest.mark.parametrize("steps", [3, 7, 9, 20])
def test_a_rigid_mass_on_a_spring_has_its_steps_in_a_period(steps):
    """Those of the period that the scheme gives it, which is longer."""
    results = simulate(beside_a_slow_mass(steps))
    x, t = results.body("fast").x[:, 0] - 1.0, results.time
    up = np.flatnonzero((x[:-1] < 0) & (x[1:] >= 0))
    crossing = t[up] - x[up] * np.diff(t)[up] / np.diff(x)[up]
    period = np.diff(crossing).mean() / 0.1
    found = results.validity.values("steps_per_period")
    assert found["fast"] == pytest.approx(steps * period, rel=0.02)
    assert found["slow"] > 30.0
    assert warned(results.validity, "steps_per_period") == (period > 1.05)
    assert period < 1.04 or steps < 8


def test_blows_and_steady_motion_are_no_vibration():
    """Nor is what gravity does, however few steps there are."""
    body = {"ball": RigidBody(1.0, [0.1] * 3, start=Start(velocity=[3.0, 0, 0]))}
    blow = Force("ball", [1, 0, 0], Impulse(5.0, 0.5))
    results = simulate(model_of(body, loads=[blow], gravity=[0, 0, -G], step=1e-2))
    assert np.isnan(results.validity.values("steps_per_period")["ball"])
    assert not results.validity.warnings


def test_a_driven_mass_vibrates_with_its_force():
    body = {"ball": RigidBody(1.0, [0.1] * 3)}
    force = Force("ball", [1, 0, 0], Harmonic(1.0, 10.0))
    found = simulate(model_of(body, loads=[force], step=1e-2)).validity
    assert found.values("steps_per_period")["ball"] == pytest.approx(10.0, rel=0.03)


INERTIA = np.array([1.0, 2.0, 2.5])


def attitude(spin, t):
    """Of a free body that tumbles, by Euler's equations and R' = R omega~."""

    def rate(t, y):
        R, omega = y[:9].reshape(3, 3), y[9:]
        spun = np.cross(R, -omega)  # each row r of R: (r^T omega~)^T = -omega x r = r x omega
        return np.r_[-spun.ravel(), -np.cross(omega, INERTIA * omega) / INERTIA]

    start_ = np.r_[np.eye(3).ravel(), spin]
    solved = solve_ivp(rate, (0, t), start_, method="DOP853", rtol=1e-11, atol=1e-12)
    return Rotation.from_matrix(solved.y[:9, -1].reshape(3, 3))


@pytest.mark.parametrize("turn", [0.06, 0.3, 0.45])
def test_a_free_body_that_tumbles_keeps_its_angular_momentum_or_says_so(turn):
    """Within the limit its attitude drifts by less than 1e-3 of what it turns."""
    h, t = 1e-3, 0.3
    spin = np.full(3, turn / h / np.sqrt(3.0))
    body = RigidBody(1.0, INERTIA, start=Start(angular_velocity=spin))
    results = simulate(Model({"body": body}, settings=Settings(t_end=t, step=h)))
    momentum = results.momentum.angular
    lost = np.linalg.norm(momentum - momentum[0], axis=1).max()
    error = results.validity.values("angular_momentum")["body"]
    assert error == pytest.approx(lost / np.linalg.norm(momentum, axis=1).max(), rel=1e-9)
    missed = attitude(spin, t).inv() * Rotation.from_quat(np.roll(results.body("body").R[-1], -1))
    drift = missed.magnitude() / (turn / h * t)
    assert warned(results.validity, "angular_momentum") == (turn > 0.4)
    assert drift < 1e-3 or turn > 0.4


def test_a_free_wheel_spins_about_its_axis_as_fast_as_it_likes():
    wheel = RigidBody(1.0, [0.1, 0.1, 0.2], start=Start(angular_velocity=[0, 0, 900.0]))
    validity = simulate(Model({"wheel": wheel}, settings=Settings(t_end=0.1, step=1e-3))).validity
    assert validity.values("angular_momentum")["wheel"] < 1e-9
    assert not validity.warnings


@pytest.mark.parametrize("moment", [Impulse(0.3, 0.05), Constant(3.0)])
def test_moments_explain_what_a_free_body_gains(moment):
    wheel = RigidBody(1.0, [0.1, 0.1, 0.2], start=Start(angular_velocity=[0, 0, 5.0]))
    load = Torque("wheel", [1, 0, 0], moment)
    validity = simulate(model_of({"wheel": wheel}, loads=[load], t_end=0.1, step=1e-3)).validity
    assert validity.values("angular_momentum")["wheel"] < 5e-3


def test_a_check_tells_what_the_first_steps_show():
    (line,) = [line for line in check(beside_a_slow_mass(5)).warnings if "steps per period" in line]
    assert line.startswith("in the first 128 steps: body 'fast': ")
    assert not check(beside_a_slow_mass(25)).warnings


# Contacts


PLACES = {"near": 0.425, "far": 0.375, "middle": 0.25}


@pytest.fixture(scope="module")
def noded(tmp_path_factory):
    """The beam with twenty elements, and interfaces at some of its nodes."""
    mesh = line_mesh(tmp_path_factory.mktemp("noded") / "beam.msh", 20)
    nodes = {name: InterfaceSelection(node=(x, 0, 0)) for name, x in PLACES.items()}
    impulse = PAPERS.impulse.model_copy(update={"steps": 10})
    return make_beam(mesh=mesh, interfaces={**PAPERS.interfaces, **nodes}, impulse=impulse).element


def hit(element, carrier):
    """A heavy mass meets the tip of the beam, clamped at its root, on a plane at an interface."""
    ball = RigidBody(5.0 * MASS, [1e-5] * 3, start=Start([L, 0, 0.005], velocity=[0, 0, -0.2]))
    return simulate(
        Model(
            {"beam": FlexibleBody(element, Start([0.5 * L, 0, 0])), "ball": ball},
            [Fixed("ground", "beam.root", name="clamp")],
            contacts=[
                Contact(
                    "c",
                    (f"beam.{carrier}", "ball"),
                    "plane",
                    ball=0.005,
                    axis=[0, 0, 1],
                    impact=Impact(stiffness=3e4),
                )
            ],
            settings=Settings(t_end=0.09, step=6e-5),
        )
    )


def deepest(results):
    """The point where the mass turns back, below that where it met the beam [m]."""
    z = results.body("ball").x[:, 2]
    return z[0] - z.min()


@pytest.fixture(scope="module")
def right(noded):
    """Where the tip itself carries the plane."""
    return deepest(hit(noded, "tip"))


@pytest.mark.parametrize("carrier", PLACES)
def test_a_contact_far_from_its_frame_is_warned_of(noded, right, carrier):
    results = hit(noded, carrier)
    arm = (L - PLACES[carrier]) / noded.size
    assert results.validity.values("contact_arm")["c"] == pytest.approx(arm, rel=0.02)
    assert warned(results.validity, "contact_arm") == (arm > 0.2)
    error = abs(deepest(results) / right - 1.0)
    assert error < 0.01 or arm > 0.2
    assert error > 0.05 or arm < 0.4


# Stress of spin


@pytest.fixture(scope="module")
def bar(coarse):
    """The beam as a box, of which stress is known."""
    outline = box_of_inertia(coarse.mass, coarse.J_rot)
    fields = np.zeros((len(outline.points), 6, len(coarse.modes.omega)))
    recovery = Recovery(outline.points, outline.cells, fields[:, :3], fields)
    return replace(coarse, outline=outline, recovery=recovery)


def spinning(element, spin):
    body = FlexibleBody(element, Start(angular_velocity=[0, 0, spin]))
    return simulate(Model({"bar": body}, settings=Settings(t_end=6e-4, step=6e-5))).validity


@pytest.mark.parametrize("stress", [0.0, 0.95e6, 1.05e6])
def test_stress_that_is_not_computed_is_told_in_pascal(bar, stress):
    """Of a free bar the true one is half of it, rho Omega^2 l^2 / 8 in its middle."""
    rho, half = bar.mass / bar.outline.volume, bar.outline.points[:, 0].max()
    validity = spinning(bar, np.sqrt(stress / rho) / half)
    found = validity.values("missing_stress")["bar"]
    assert found == pytest.approx(stress, rel=0.01)
    assert warned(validity, "missing_stress") == (stress > 1e6)


def test_a_body_of_unknown_volume_is_taken_for_steel(bar):
    lines = Outline(bar.outline.points[[0, -1]], [[0, 1]])
    half = np.linalg.norm(lines.points[0])
    for outline, radius in ((lines, half), (None, 0.5 * bar.size)):
        found = spinning(replace(bar, outline=outline), 20.0).values("missing_stress")["bar"]
        assert found == pytest.approx(8000.0 * (20.0 * radius) ** 2)


def test_a_body_without_stresses_misses_none(bar):
    bare = replace(bar, recovery=replace(bar.recovery, stress=None))
    assert not spinning(bare, 100.0).values("missing_stress")


# Steps of an impact


@pytest.mark.parametrize("steps", [20, 42])
@pytest.mark.parametrize("restitution", [1.0, 0.5, 0.1])
def test_the_peak_of_an_impact_is_right_to_two_per_cent_or_warned_of(restitution, steps):
    """Of a ball on a wall, the worst of four phases of the contact in its step."""
    e, m, speed, K, radius = restitution, 0.03, 1.0, 3e7, 0.01
    damped = 0.0
    if e < 1.0:  # a (1 + e) = ln((1 + a) / (1 - e a))
        damped = brentq(
            lambda a: a * (1.0 + e) - np.log((1.0 + a) / (1.0 - e * a)), 1e-6, (1.0 - 1e-9) / e
        )

    def force(d, rate):
        return np.maximum(0.0, K * d * (1.0 + damped * rate / speed))

    period = 2.0 * np.pi * np.sqrt(m / K)
    right = solve_ivp(
        lambda t, y: [y[1], -force(*y) / m],
        (0, 6.0 * period),
        [0.0, speed],
        rtol=1e-9,
        atol=1e-15,
        max_step=period / 500,
    )
    closed = right.y[0] >= 0.0
    duration, peak = right.t[closed][-1], force(*right.y).max()
    h, errors, warnings = duration / steps, [], []
    for phase in np.arange(4) / 4.0:
        start_ = Start([0, 0, radius + speed * (2.0 + phase) * h], velocity=[0, 0, -speed])
        wall = Contact(
            "wall",
            ("ground.wall", "ball"),
            "plane",
            ball=radius,
            axis=[0, 0, 1],
            impact=Impact(stiffness=K, restitution=e),
        )
        ball = RigidBody(m, [1e-6] * 3, start=start_)
        settings = Settings(t_end=1.3 * duration + 5 * h, step=h)
        model = Model(
            {"ball": ball}, contacts=[wall], ground_frames={"wall": Frame()}, settings=settings
        )
        results = simulate(model)
        errors.append(abs(np.abs(results.contact("wall").force).max() / peak - 1.0))
        warnings.append(warned(results.validity, "contact_steps"))
    assert max(errors) < 0.02 or all(warnings)
    assert max(errors) > 0.005 or not any(warnings)
