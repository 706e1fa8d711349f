"""Flexible bodies: frequencies, deflections and balances of the coupled motion."""

import numpy as np
import pytest
from duhamel.preprocess.body.body import Damping
from duhamel.solver import (
    Constant,
    Fixed,
    FlexibleBody,
    Force,
    Harmonic,
    Impulse,
    Model,
    Revolute,
    Settings,
    Spherical,
    Start,
    Torque,
    simulate,
)
from duhamel.superelement import GeneralizedAlpha
from scipy.optimize import minimize_scalar
from scipy.spatial.transform import Rotation

from .conftest import make_beam
from .models import model_of

EI, L = 5.5, 0.5


def rotations(quaternions):
    return Rotation.from_quat(quaternions, scalar_first=True)


def frequency(signal, h, rho_inf, near):
    """The frequency [Hz] of the peak of a spectrum, freed of the error of the time step.

    An oscillation z^n of the recursion belongs to omega^2 = -sigma(z), sigma = 1 / (Q F).
    """
    n = np.arange(len(signal))
    windowed = (signal - signal.mean()) * np.blackman(len(signal))

    def power(f):
        return -abs(windowed @ np.exp(-2j * np.pi * f * h * n))

    found = minimize_scalar(
        power, bounds=(0.98 * near, 1.02 * near), method="bounded", options={"xatol": 1e-9}
    ).x
    s, z = GeneralizedAlpha(rho_inf), np.exp(2j * np.pi * found * h)
    Q = (
        h**2
        * (s.beta * z**2 + (0.5 + s.gamma - 2 * s.beta) * z + 0.5 + s.beta - s.gamma)
        / (z - 1) ** 2
    )
    F = ((1 - s.alpha_f) * z + s.alpha_f) / ((1 - s.alpha_m) * z + s.alpha_m)
    return np.sqrt(-(1.0 / (Q * F)).real) / (2 * np.pi)


@pytest.mark.parametrize(
    ("phi", "frequencies"), [(4.0, (19.8986, 112.880, 314.770)), (0.5, (29.4008, 116.840, 316.841))]
)
def test_the_frequencies_of_a_beam_on_a_hub(beam, hub_and_beam, phi, frequencies):
    """docs/theory.md, Energy, within the error of ten elements in bending (4e-5 at 114 Hz, 3e-4 at
    314 Hz).
    """
    h, rho_inf = 1e-4, 0.99
    blow = Torque("hub", [0, 0, 1], Impulse(1e-6, 0.0))
    model = hub_and_beam(beam, phi, loads=(blow,), t_end=2.0, step=h, rho_inf=rho_inf)
    u = simulate(model).frame("beam.tip").u[:, 1]
    found = [frequency(u, h, rho_inf, near) for near in frequencies]
    np.testing.assert_allclose(found[:2], frequencies[:2], rtol=5e-5)
    assert found[2] == pytest.approx(frequencies[2], rel=3e-4)


def cantilever(element, **settings):
    return model_of(
        {
            "beam": FlexibleBody(
                element, Start(position=[0.3, -0.1, 0.2], rotation=[0.2, -0.4, 0.7])
            )
        },
        (Fixed("ground", "beam.root", name="wall"),),
        **settings,
    )


def test_a_cantilever_settles_at_its_static_deflection():
    """F L^3 / (3 EI) and F L^2 / (2 EI) at the tip, F and F L at the wall; the rest is of the order
    of u^2 / L^2.
    """
    element = make_beam(damping=Damping.model_validate({"modal": 3.0})).element
    F, R = 0.01, Rotation.from_rotvec([0.2, -0.4, 0.7])
    load = Force("beam.tip", R.apply([0, 0, 1]), Constant(F))
    results = simulate(cantilever(element, loads=(load,), t_end=1.5, step=2e-4, rho_inf=0.8))
    tip, wall = results.frame("beam.tip"), results.joint("wall")
    moved = R.inv().apply(tip.position[-1] - tip.position[0])
    turned = (R.inv() * rotations(tip.rotation[-1])).as_rotvec()
    assert moved[2] == pytest.approx(F * L**3 / (3 * EI), rel=1e-7)
    assert turned[1] == pytest.approx(-F * L**2 / (2 * EI), rel=1e-7)
    # rounding of positions (1e-16 m) times the axial stiffness of an element (4e8 N/m) is a force
    # of 4e-8 N
    np.testing.assert_allclose(R.inv().apply(wall.force[-1]), [0, 0, -F], atol=1e-7)
    np.testing.assert_allclose(R.inv().apply(wall.moment[-1]), [0, F * L, 0], atol=1e-7 * F * L)


def double_pendulum(element, **settings):
    """Two beams on spherical joints that swing in space from a horizontal line, the second tilted
    out of it.
    """
    a = Start(position=-element.interface("root").X, angular_velocity=[0.0, 1.0, 2.0])
    tilt = np.array([0.0, 0.4, 0.5])
    elbow = element.interface("tip").X - element.interface("root").X
    b = Start(
        position=elbow - Rotation.from_rotvec(tilt).as_matrix() @ element.interface("root").X,
        rotation=tilt,
    )
    return model_of(
        {"a": FlexibleBody(element, a), "b": FlexibleBody(element, b)},
        (
            Spherical("ground", "a.root", name="shoulder"),
            Spherical("a.tip", "b.root", name="elbow"),
        ),
        gravity=[0.0, -9.81, 0.0],
        **{"rho_inf": 0.9} | settings,
    )


def test_a_double_pendulum_of_two_beams_keeps_its_energy(coarse):
    """The drift of kinetic + elastic + potential energy falls fourfold when the step is halved."""
    drifts = []
    for h in (4e-4, 2e-4, 1e-4):
        energy = simulate(double_pendulum(coarse, t_end=0.4, step=h)).energy
        drifts.append(np.abs(energy.balance).max() / energy.kinetic.max())
    orders = np.log2(np.array(drifts[:-1]) / drifts[1:])
    assert (orders > 1.8).all(), orders
    assert drifts[-1] < 1e-4


def momenta(results, elements):
    """Linear and angular momentum (about the origin) over time."""
    linear, angular = 0.0, 0.0
    for name, element in elements.items():
        motion = results.body(name)
        p = element.mass * motion.v[:, :3]
        linear = linear + p
        angular = (
            angular
            + np.cross(motion.x, p)
            + rotations(motion.R).apply(motion.v[:, 3:] @ element.J_rot)
        )
    return linear, angular


def test_two_flexible_bodies_in_free_flight_keep_their_momenta(random_element):
    """Linear momentum to rounding; angular momentum to order two."""
    elements = {"a": random_element(5, (True, False)), "b": random_element(6, (True,))}
    starts = {
        "a": Start(
            position=-elements["a"].interface("i0").X,
            velocity=[1.0, 0, 0],
            angular_velocity=[1, 2, -1],
        ),
        "b": Start(position=-elements["b"].interface("i0").X, angular_velocity=[0.5, -1, 2]),
    }
    drifts = []
    for h in (1e-3, 5e-4, 2.5e-4):
        bodies = {name: FlexibleBody(elements[name], starts[name]) for name in "ab"}
        model = Model(
            bodies,
            (Revolute("a.i0", "b.i0", [1, 1, 1], name="hinge"),),
            settings=Settings(t_end=0.5, step=h, rho_inf=0.9),
        )
        linear, angular = momenta(simulate(model), elements)
        assert np.abs(linear - linear[0]).max() < 1e-11 * np.abs(linear).max()
        drifts.append(np.abs(angular - angular[0]).max() / np.abs(angular).max())
    orders = np.log2(np.array(drifts[:-1]) / drifts[1:])
    assert (orders > 1.9).all(), orders


def test_a_body_without_joints_or_loads_spins_undeformed(beam):
    body = FlexibleBody(beam.element, Start(angular_velocity=[3.0, 1.0, 4.0]))
    results = simulate(Model({"beam": body}, settings=Settings(t_end=0.2)))
    linear, angular = momenta(results, {"beam": beam.element})
    assert not results.frame("beam.tip").u.any()
    assert not linear.any()
    assert np.abs(angular - angular[0]).max() < 1e-6 * np.abs(angular).max()
    assert np.abs(results.energy.balance).max() < 1e-6 * results.energy.kinetic[0]


@pytest.mark.parametrize("rho_inf", [1.0, 0.9, 0.5])
def test_the_consistent_rule_is_passive_and_the_papers_is_not(beam, rho_inf):
    """A load just above the first resonance, where the beam answers like a mass: eq. (55) gives
    energy away.
    """
    load = Force("beam.tip", [0, 0.01, 0.02], Harmonic(1.0, 140.0))
    body = {"beam": FlexibleBody(beam.element)}
    least = {}
    for rule in ("consistent", "paper"):
        model = Model(
            body, (), (load,), settings=Settings(t_end=0.5, step=2e-4, rho_inf=rho_inf, rule=rule)
        )
        energy = simulate(model).energy
        put_in = energy.elastic + energy.numerical
        least[rule] = put_in.min() / put_in.max()
    assert least["consistent"] > -1e-12
    assert least["paper"] < -0.1
