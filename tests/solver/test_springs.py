"""Springs, dampers and bushings against closed forms and balances."""

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Harmonic,
    Model,
    ModelError,
    Revolute,
    RigidBody,
    Settings,
    Spring,
    Start,
    TabulatedLaw,
    simulate,
)
from scipy.integrate import cumulative_trapezoid, solve_ivp
from scipy.spatial.transform import Rotation

from .models import model_of

G = 9.81


def symmetric(seed, size):
    half = np.random.default_rng(seed).normal(size=(6, 6))
    return size * half @ half.T


def orders(errors):
    return np.log2(np.array(errors[:-1]) / errors[1:])


def hanging_mass(h, k=100.0, c=0.5, m=2.0, **spring):
    """A mass one meter below a hook, on a spring that starts without force, let go."""
    return simulate(
        Model(
            {"mass": RigidBody(m, [1, 1, 1], start=Start(position=[0, 0, -1]))},
            springs=(
                Spring("coil", "point", ("ground.hook", "mass"), stiffness=k, damping=c, **spring),
            ),
            ground_frames={"hook": Frame()},
            gravity=[0, 0, -G],
            settings=Settings(t_end=2.0, step=h, rho_inf=0.9),
        )
    )


def test_a_damped_oscillator():
    """x = -m g / k (1 - exp(-zeta omega t) (cos + zeta / sqrt(1 - zeta^2) sin)) to order two; so is
    the balance.
    """
    k, c, m = 100.0, 0.5, 2.0
    omega, zeta = np.sqrt(k / m), c / (2 * np.sqrt(k * m))
    errors, balances = [], []
    for h in (5e-3, 2.5e-3, 1.25e-3):
        results = hanging_mass(h, k, c, m)
        t, root = results.time, np.sqrt(1 - zeta**2)
        swing = np.cos(root * omega * t) + zeta / root * np.sin(root * omega * t)
        x = -1.0 - m * G / k * (1 - np.exp(-zeta * omega * t) * swing)
        errors.append(np.abs(results.body("mass").x[:, 2] - x).max())
        balances.append(np.abs(results.energy.balance).max())
    assert (orders(errors) > 1.95).all(), errors
    assert (orders(balances) > 1.94).all(), balances
    assert errors[-1] < (omega * 1.25e-3) ** 2 * omega * 2.0 / 6.0 * m * G / k


def test_what_a_spring_reports():
    """Length, rate, force on the second body, 1/2 k s^2 and the integral of c s'^2."""
    k, c, h = 100.0, 0.5, 1e-3
    results = hanging_mass(h, k, c)
    coil, x, v = results.spring("coil"), results.body("mass").x[:, 2], results.body("mass").v[:, 2]
    length = coil.coordinates["coordinates"][:, 0]
    np.testing.assert_allclose(length, -x, rtol=1e-13)
    force = k * (-x - 1.0) - c * v
    np.testing.assert_allclose(coil.force[:, 2], force, rtol=0, atol=1e-9)
    assert not coil.force[:, :2].any()
    np.testing.assert_allclose(
        results.energy.springs, 0.5 * k * (-x - 1.0) ** 2, rtol=0, atol=1e-12
    )
    lost = cumulative_trapezoid(c * v**2, dx=h, initial=0.0)
    assert np.abs(results.energy.dissipated - lost).max() < k / 2.0 * h**2 * lost[-1]


def test_a_spring_with_a_rest_length_pulls_at_once():
    """m x'' = -k (x - rest) at t = 0, and half of k (length - rest)^2 is in it."""
    results = hanging_mass(1e-3, k=100.0, c=0.0, m=2.0, rest=0.8)
    assert results.body("mass").v_dot[0, 2] == pytest.approx(100.0 * 0.2 / 2.0 - G, rel=1e-12)
    assert results.energy.springs[0] == pytest.approx(0.5 * 100.0 * 0.04, rel=1e-12)
    assert results.energy.balance[0] == 0.0


def test_a_tabulated_law_of_an_oscillator():
    """Between the points, and beyond the last, against an integrator of high order: order two."""
    law, J = TabulatedLaw((-0.5, 0.0, 0.2, 0.4), (-2.0, 0.0, 3.0, 3.5)), 0.3

    def moment(angle):
        return (
            np.interp(angle, law.deformation, law.force)
            + 2.5 * max(angle - 0.4, 0)
            + 4.0 * min(angle + 0.5, 0)
        )

    t = np.linspace(0, 2, 501)
    options = {"t_eval": t, "rtol": 1e-11, "atol": 1e-12, "max_step": 1e-3}
    exact = solve_ivp(lambda _, y: [y[1], -moment(y[0]) / J], (0, 2), [0, 3.0], **options).y[0]
    errors = []
    for h in (4e-3, 2e-3, 1e-3):
        results = simulate(
            Model(
                {"disk": RigidBody(1.0, [1, 1, J], start=Start(angular_velocity=[0, 0, 3.0]))},
                (Revolute("ground", "disk", [0, 0, 1], name="axle"),),
                springs=(Spring("coil", "torsion", ("ground", "disk"), [0, 0, 1], law=law),),
                settings=Settings(t_end=2.0, step=h, rho_inf=0.9),
            )
        )
        angle = results.joint("axle").coordinates["angle"]
        errors.append(np.abs(angle[:: round(4e-3 / h)] - exact).max())
    assert angle.min() < -0.5
    assert angle.max() > 0.4
    # the kinks of the law fall anywhere between steps: errors scatter about order two
    assert np.log2(errors[0] / errors[-1]) / 2 > 1.8, errors
    areas = np.concatenate([[0.0], cumulative_trapezoid(law.force, law.deformation)])
    inside = (angle > -0.5) & (angle < 0.4)
    k = np.searchsorted(law.deformation, angle[inside]) - 1
    start, end = np.take(law.deformation, k), angle[inside]
    stored = (
        areas[k]
        - areas[1]
        + 0.5 * (np.take(law.force, k) + np.interp(end, law.deformation, law.force)) * (end - start)
    )
    np.testing.assert_allclose(results.energy.springs[inside], stored, rtol=0, atol=1e-13)


@pytest.mark.parametrize(
    ("deformation", "force", "rest"),
    [
        ((-0.5, 0.0, 0.2), (-2.0, 0.0, 3.0), 0.0),
        ((-1.0, 1.0), (-1.0, 3.0), -0.5),
        ((1.0, 2.0), (1.0, 3.0), 0.5),
        ((1.0, 2.0), (-2.0, -1.0), 3.0),
        ((-3.0, -2.0, 5.0, 6.0), (-1.0, 0.0, 0.0, 1.0), 0.0),
        ((-1.0, 0.3, 0.4), (0.0, 0.0, 1e9), 0.0),
        ((-3.0, -2.0, 2.0, 2.5), (-1.0, 0.5, -0.5, 2.0), 0.0),
        ((-3.0, -2.0, 2.0, 4.0), (-1.0, 3.0, 5.0, 0.0), -2.75),
        ((0.0, 1.0), (5.0, 5.0), 0.0),
    ],
)
def test_a_tabulated_law_stores_nothing_without_force(deformation, force, rest):
    """At the deformation without force nearest to rest, or at rest; energy is the area from it."""
    law = TabulatedLaw(deformation, force)
    parameters = np.array(law.parameters())

    def at(c):
        """Force and energy."""
        force, _, _, energy = law.evaluate(parameters, parameters[:0], np.inf, c, 0.0)
        return force, energy

    def energy(c):
        return at(c)[1]

    assert energy(rest) == pytest.approx(0.0, abs=1e-15)
    for c in np.linspace(-4.0, 7.0, 12):
        points = np.linspace(rest, c, 200_001)
        forces = [at(point)[0] for point in points[::100]]
        area = np.trapezoid(forces, points[::100])
        assert energy(c) == pytest.approx(area, rel=1e-3, abs=1e-3 * np.abs(forces).max())


def test_a_gap_law_far_beyond_its_zero_does_not_flatter_the_balance():
    """Counted from its first point, 25 J would stand beside the 0.08 J that move."""
    law = TabulatedLaw((-1.0, 1.0), (-50.0, 50.0))
    ball = RigidBody(1.0, [0.1] * 3, start=Start([1.0, 0, 0], velocity=[0.4, 0, 0]))
    model = Model(
        {"ball": ball},
        springs=[Spring("law", "point", ("ground.a", "ball"), law=law)],
        ground_frames={"a": Frame()},
        settings=Settings(t_end=1.0, step=1e-3),
    )
    energy = simulate(model).energy
    assert energy.springs[0] == 0.0
    assert np.abs(energy.springs).max() == pytest.approx(0.08, rel=1e-3)


def test_a_torsion_spring_counts_full_turns():
    """It winds up over 7 turns and comes back: c = omega_0 / omega sin(omega t)."""
    J, k, speed = 2.0, 0.5, 25.0
    results = simulate(
        Model(
            {"disk": RigidBody(1.0, [1, 1, J], start=Start(angular_velocity=[0, 0, speed]))},
            (Revolute("ground", "disk", [0, 0, 1], name="axle"),),
            springs=(Spring("coil", "torsion", ("ground", "disk"), [0, 0, 1], stiffness=k),),
            settings=Settings(t_end=10.0, step=2e-3, rho_inf=0.9),
        )
    )
    omega, t = np.sqrt(k / J), results.time
    angle = results.spring("coil").coordinates["coordinates"][:, 0]
    assert angle.max() / (2 * np.pi) > 7
    np.testing.assert_allclose(
        angle, speed / omega * np.sin(omega * t), rtol=0, atol=50 * (omega * 2e-3) ** 2
    )
    np.testing.assert_allclose(
        results.joint("axle").coordinates["angle"], angle, rtol=0, atol=1e-12
    )


def tumbling_pair(**settings):
    """Two bodies in flight on a bushing with full matrices and a torsion spring with a table."""
    stiffness = symmetric(0, 50.0)
    return Model(
        {
            "a": RigidBody(
                1.0,
                [0.1, 0.2, 0.3],
                {"f": Frame([0.1, 0.2, 0.3], [0.1, 0.2, 0.3])},
                Start(velocity=[1, 0, 0], angular_velocity=[3, 2, 1]),
            ),
            "b": RigidBody(
                2.0,
                [0.3, 0.2, 0.2],
                {"g": Frame([-0.1, 0.1, 0])},
                Start(position=[0.4, 0.1, 0.3], angular_velocity=[-1, 2, 3]),
            ),
        },
        springs=(
            Spring(
                "bush",
                "bushing",
                ("a.f", "b.g"),
                [1, 1, 0],
                stiffness=stiffness,
                damping=1e-3 * stiffness,
            ),
            Spring(
                "coil",
                "torsion",
                ("a", "b"),
                [0, 0, 1],
                stiffness=5.0,
                damping=0.01,
                law=TabulatedLaw((-1, 0, 1), (-3, 0, 8)),
            ),
        ),
        settings=Settings(t_end=0.5, rho_inf=0.9, **settings),
    )


def test_springs_between_tumbling_bodies_keep_momenta_and_energy():
    """Linear momentum to rounding; angular momentum and the balance, dissipation counted, to order
    two.
    """
    angular, balance = [], []
    for h in (2e-3, 1e-3, 5e-4):
        results = simulate(tumbling_pair(step=h))
        linear = results.momentum.linear
        assert np.abs(linear - linear[0]).max() < 1e-12
        angular.append(np.ptp(results.momentum.angular, axis=0).max())
        balance.append(np.abs(results.energy.balance).max())
    assert (orders(angular) > 1.9).all(), angular
    assert (orders(balance) > 1.9).all(), balance
    assert results.energy.dissipated[-1] > 0.05 * results.energy.kinetic[0]
    # wrenches are opposite: F and M + r x F on both sides
    bush, A, B = results.spring("bush"), results.frame("a.f"), results.frame("b.g")
    np.testing.assert_allclose(A.force[:, :3], -bush.force, rtol=0, atol=1e-9)
    turned = bush.moment + np.cross(B.position - A.position, bush.force)
    np.testing.assert_allclose(A.force[:, 3:], -turned, rtol=0, atol=1e-9)


def test_the_coordinates_of_a_bushing():
    """Displacements along, and sines of rotations about, the axes carried by frame A."""
    results = simulate(tumbling_pair(step=1e-3))
    bush, A, B = results.spring("bush"), results.frame("a.f"), results.frame("b.g")
    start = Rotation.from_quat(A.rotation[0], scalar_first=True).as_matrix()
    axes = tumbling_pair(step=1e-3).springs[0].basis(start)
    turn_a = (
        Rotation.from_quat(A.rotation, scalar_first=True)
        * Rotation.from_quat(A.rotation[0], scalar_first=True).inv()
    )
    turn_b = (
        Rotation.from_quat(B.rotation, scalar_first=True)
        * Rotation.from_quat(B.rotation[0], scalar_first=True).inv()
    )
    e_a, e_b = turn_a.as_matrix() @ axes, turn_b.as_matrix() @ axes
    coordinates = bush.coordinates["coordinates"]
    gap = np.einsum("tik,ti->tk", e_a, B.position - A.position)
    np.testing.assert_allclose(coordinates[:, :3], gap, rtol=0, atol=1e-13)
    sines = [np.einsum("ti,ti->t", e_a[:, :, i], e_b[:, :, j]) for i, j in ((2, 1), (0, 2), (1, 0))]
    np.testing.assert_allclose(coordinates[:, 3:], np.transpose(sines), rtol=0, atol=1e-13)


def test_a_stiff_bushing_is_nearly_a_weld(random_element):
    """Motions differ by what the bushing gives way under the loads: a tenth if it is ten times as
    stiff.
    """
    element = random_element(1, (True, False))
    R = Rotation.from_rotvec([0.3, -0.2, 0.5])
    beam = FlexibleBody(element, Start(-R.as_matrix() @ element.interface("i0").X, R.as_rotvec()))
    load = Force("beam.i1", [1.0, 2.0, -1.0], Harmonic(1.0, 1.0))
    common = {"loads": (load,), "t_end": 0.5, "step": 1e-3, "rho_inf": 0.8}
    weld = simulate(
        model_of(
            {"beam": beam},
            (Fixed("ground", "beam.i0", name="weld"),),
            **common,
        )
    )
    apart = []
    for stiffness in (1e4, 1e5, 1e6):
        bush = Spring(
            "bush",
            "bushing",
            ("ground", "beam.i0"),
            stiffness=stiffness * np.eye(6),
            damping=np.eye(6),
        )
        results = simulate(model_of({"beam": beam}, springs=(bush,), **common))
        apart.append(np.abs(results.body("beam").x - weld.body("beam").x).max())
    np.testing.assert_allclose(np.array(apart[:-1]) / apart[1:], 10.0, rtol=0.1)


@pytest.mark.parametrize("stiffness", [0.0, 1e-3])
def test_a_body_flies_through_the_end_of_its_spring(stiffness):
    """Exactly at a step, where the spring has no direction."""
    bob = RigidBody(1.0, [0.1, 0.1, 0.1], start=Start([-1.0, 0, 0], velocity=[1.0, 0, 0]))
    spring = Spring("tie", "point", ("ground.post", "bob"), stiffness=stiffness, rest=[0.0])
    model = Model(
        {"bob": bob},
        springs=[spring],
        ground_frames={"post": Frame()},
        settings=Settings(t_end=2.0, step=0.125),
    )
    results, omega = simulate(model), np.sqrt(stiffness)
    t = results.time
    exact = t * np.sinc(omega * t / np.pi) - np.cos(omega * t)
    np.testing.assert_allclose(results.body("bob").x[:, 0], exact, rtol=0, atol=1e-5)


TILTED = Rotation.from_rotvec([0.3, -0.2, 0.5])
BASES = {
    "of the first frame": ({}, TILTED.as_matrix()),
    "given": (
        {"axis": [0, 1, 0], "second_axis": [0.6, 0, 0.8]},
        np.array([[0.6, 0.8, 0], [0, 0, 1], [0.8, -0.6, 0]]),
    ),
}


@pytest.mark.parametrize("name", BASES)
def test_a_bushing_gives_way_along_its_axes(name):
    """Pushed gently and held in equilibrium, by the flexibilities along e1, e2, e3."""
    axes, basis = BASES[name]
    stiffness, force = np.array([1e6, 2e6, 5e6]), np.array([1.0, 2.0, 3.0])
    bush = Spring(
        "bush", "bushing", ("ground.wall", "bob"), stiffness=[*stiffness, 1.0, 1.0, 1.0], **axes
    )
    model = Model(
        {"bob": RigidBody(1.0, [0.1, 0.1, 0.1])},
        springs=[bush],
        loads=[Force("bob", force, Constant(1.0))],
        ground_frames={"wall": Frame(rotation=TILTED.as_rotvec())},
        settings=Settings(t_end=1e-3, step=1e-3, start="equilibrium"),
    )
    expected = basis @ (basis.T @ force / stiffness)
    np.testing.assert_allclose(simulate(model).body("bob").x[0], expected, rtol=0, atol=1e-13)


def test_a_spring_between_interfaces_of_flexible_bodies(random_element):
    """Linear momentum to rounding; angular momentum and energy, the spring's included, to order
    two.
    """
    elements = {"a": random_element(5, (True, False)), "b": random_element(6, (True, False))}
    starts = {
        "a": Start(
            position=-elements["a"].interface("i0").X,
            velocity=[1.0, 0, 0],
            angular_velocity=[1, 2, -1],
        ),
        "b": Start(
            position=[0.5, 0.2, 0.1] - elements["b"].interface("i0").X,
            angular_velocity=[0.5, -1, 2],
        ),
    }
    model = Model(
        {name: FlexibleBody(elements[name], starts[name]) for name in "ab"},
        springs=(
            Spring(
                "bush",
                "bushing",
                ("a.i0", "b.i0"),
                stiffness=symmetric(4, 20.0),
                damping=symmetric(5, 0.02),
            ),
            Spring("tie", "point", ("a.i1", "b.i1"), stiffness=40.0, damping=0.3),
        ),
        settings=Settings(t_end=0.3, rho_inf=0.9),
    )
    angular, balance = [], []
    for h in (4e-4, 2e-4, 1e-4):
        results = simulate(model.with_settings(step=h))
        linear = results.momentum.linear
        assert np.abs(linear - linear[0]).max() < 1e-11 * np.abs(linear).max()
        angular.append(np.ptp(results.momentum.angular, axis=0).max())
        balance.append(np.abs(results.energy.balance).max())
    assert (orders(angular) > 1.9).all(), angular
    assert (orders(balance) > 1.8).all(), balance
    assert results.energy.dissipated[-1] > 0.0


def test_what_pulls_a_cantilever_by_a_spring_finds_its_stiffness(coarse):
    """A tip on a spring whose other end is held away: k s = F = 3 EI w / L^3, in equilibrium."""
    k, EI, L, away = 50.0, 5.5, 0.5, 1e-4
    results = simulate(
        Model(
            {"beam": FlexibleBody(coarse, Start(position=[0.25, 0, 0]))},
            (Fixed("ground", "beam.root", name="wall"),),
            springs=(Spring("pull", "point", ("ground.hook", "beam.tip"), stiffness=k, rest=0.1),),
            ground_frames={"hook": Frame([0.5, 0, 0.1 + away])},
            settings=Settings(t_end=0.01, start="equilibrium"),
        )
    )
    w = results.frame("beam.tip").position[0, 2]
    beam = 3 * EI / L**3
    assert w == pytest.approx(k * away / (k + beam), rel=1e-6)


def test_ends_of_a_spring_that_coincide_are_refused():
    ball = RigidBody(
        1.0, [1, 1, 1], {"f": Frame([0.1, 0.2, 0.3])}, Start(position=[-0.1, -0.2, -0.3])
    )
    model = Model(
        {"ball": ball},
        springs=(Spring("coil", "point", ("ground.o", "ball.f"), stiffness=1.0),),
        ground_frames={"o": Frame()},
        settings=Settings(t_end=1.0, step=0.1),
    )
    with pytest.raises(
        ModelError, match=r"spring 'coil': its ends \['ground.o', 'ball.f'\] coincide at the start"
    ):
        simulate(model)


def test_a_preloaded_spring_without_motion_stays_still():
    """A mass that hangs in equilibrium on a spring of steel."""
    results = simulate(
        Model(
            {"mass": RigidBody(2.0, [1, 1, 1], start=Start(position=[0, 0, -1]))},
            springs=(
                Spring("coil", "point", ("ground.hook", "mass"), stiffness=1e8, damping=10.0),
            ),
            loads=(Force("mass", [0, 0, -1], Constant(3.0)),),
            ground_frames={"hook": Frame()},
            gravity=[0, 0, -G],
            settings=Settings(t_end=0.3, step=1e-3, start="equilibrium"),
        )
    )
    x = results.body("mass").x
    assert x[0, 2] == pytest.approx(-1.0 - (2.0 * G + 3.0) / 1e8, abs=1e-15)
    assert np.abs(x - x[0]).max() < 1e-14
