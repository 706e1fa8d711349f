"""The validity of linear analyses: values of known cases, and warnings where results are wrong."""

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
    Hertz,
    Impact,
    Polynomial,
    PrescribedDisplacement,
    Prismatic,
    Revolute,
    RigidBody,
    Start,
    SteadyRotation,
    linearize,
)
from duhamel.solver.linear.validity import LINEAR_CRITERIA
from scipy.linalg import eigh

from .models import model_of
from .test_linear_modes import CLAMP, SECTION, held, make_line

Z = [0.0, 0.0, 1.0]
ROUND = {**SECTION, "EI_y": 20.0, "EI_z": 20.0, "EA": 2e7, "polar_inertia_per_length": 1e-5}
UNIT = np.sqrt(ROUND["EI_y"] / ROUND["mass_per_length"])
"""sqrt(EI / (m L^4)) of a beam of 1 m [rad/s]"""


def value(linear, criterion, **asked):
    """Of the one check of a criterion, and its verdict."""
    (check,) = (c for c in linear.validity(**asked).checks if c.criterion.name == criterion)
    return check.value, check.verdict


def turning(element, spin):
    """A beam that is clamped to a driven hub without a radius."""
    beam = FlexibleBody(element, Start(-element.interface("root").X))
    bodies = {"hub": RigidBody(1.0, [0.1] * 3), "beam": beam}
    joints = (
        Revolute("ground", "hub", Z, name="axle", angle=Polynomial((0.0, 1.0))),
        Fixed("hub", "beam.root", name="clamp"),
    )
    model = model_of(bodies, joints, step=1e-3, start="equilibrium")
    return linearize(model, SteadyRotation([0.0, 0.0, spin]))


def lag_and_flap(eta):
    """First frequencies over UNIT of a turning cantilever, by Ritz's method with polynomials.

    int w''^2 + eta^2 (1 - x^2) w'^2 / 2 dx = flap^2 int w^2 dx,    lag^2 = flap^2 - eta^2
    """
    x, weight = np.polynomial.legendre.leggauss(80)
    x, weight = 0.5 * (x + 1.0), 0.5 * weight
    legendre = (np.polynomial.Legendre.basis(k, domain=[0, 1]) for k in range(16))
    square = np.polynomial.Polynomial([0.0, 0.0, 1.0])
    basis = [square * p.convert(kind=np.polynomial.Polynomial) for p in legendre]
    w, slope, bend = (np.array([p.deriv(k)(x) for p in basis]) for k in (0, 1, 2))
    K = (bend * weight) @ bend.T + eta**2 * (slope * weight * (1.0 - x * x) / 2.0) @ slope.T
    flap = np.sqrt(eigh(K, (w * weight) @ w.T, eigvals_only=True)[0])
    return np.array([np.sqrt(flap**2 - eta**2), flap])


@pytest.mark.parametrize(("modes", "eta", "error"), [(4, 20.0, 0.01), (2, 10.0, 0.01)])
def test_frequencies_are_right_up_to_the_spin_that_is_good(tmp_path, modes, eta, error):
    rotation = {"modes": modes, "loaded": ["root"]}
    linear = turning(make_line(tmp_path, 1.0, 24, section=ROUND, rotation=rotation), eta * UNIT)
    found = np.abs(linear.modes(2).values) / UNIT
    np.testing.assert_allclose(found, lag_and_flap(eta), rtol=error)
    ratio, verdict = value(linear, "second_order_spin")
    assert 0.4 < ratio < LINEAR_CRITERIA["second_order_spin"].good
    assert verdict == "good"
    assert linear.validity().warnings == ()


def test_too_few_terms_of_second_order_for_a_spin_are_warned_of(tmp_path):
    """The lag of a blade is a tenth too low at fifty times its own unit of frequency."""
    rotation = {"modes": 4, "loaded": ["root"]}
    linear = turning(make_line(tmp_path, 1.0, 24, section=ROUND, rotation=rotation), 50.0 * UNIT)
    lag = np.abs(linear.modes(1).values[0]) / UNIT
    assert abs(lag / lag_and_flap(50.0)[0] - 1.0) > 0.05
    (warning,) = linear.validity().warnings
    assert "body 'beam'" in warning
    assert "raise rotation.modes" in warning


@pytest.fixture(scope="module")
def line(tmp_path_factory):
    return make_line(tmp_path_factory.mktemp("line"), 1.0, 16, section=ROUND)


@pytest.mark.parametrize(("share", "verdict"), [(0.02, "good"), (0.04, "fair"), (0.06, "poor")])
def test_a_body_without_terms_of_second_order_that_spins(line, share, verdict):
    first = line.modes.omega.min()
    ratio, found = value(turning(line, share * first), "linear_spin")
    assert ratio == pytest.approx(share)
    assert found == verdict


@pytest.mark.parametrize("share", [0.01, 0.3, -0.3])
def test_an_axial_load_is_measured_by_the_buckling_load(line, share):
    """Of a column on two hinges, by Euler: its frequency would be sqrt(1 - P / P_E) of its own."""
    euler = np.pi**2 * ROUND["EI_y"]
    push = Force("beam.tip", [-share * euler, 0, 0], Constant(1.0))
    sides = {"y": [0, 1, 0], "z": [0, 0, 1]}
    column = model_of(
        {"beam": FlexibleBody(line, Start(-line.interface("root").X))},
        (Revolute("ground", "beam.root", Z, name="root"),),
        loads=(push,),
        motions=tuple(
            PrescribedDisplacement(name, "beam.tip", direction, Constant(0.0))
            for name, direction in sides.items()
        ),
        step=1e-3,
        start="equilibrium",
    )
    linear = linearize(column)
    ratio, verdict = value(linear, "axial_preload")
    assert ratio == pytest.approx(abs(share), rel=0.01)
    assert verdict == ("good" if share == 0.01 else "poor")


@pytest.mark.filterwarnings("ignore::duhamel.superelement.StepWarning")
def test_frequencies_beyond_the_band_of_a_superelement_are_warned_of(tmp_path):
    impulse = {"step": 1e-3, "steps": 1, "method": "craig-bampton", "modes": 12}
    element = make_line(tmp_path, 1.0, 16, section=ROUND, impulse=impulse)
    linear, band = linearize(held(element, CLAMP)), 0.25 / element.modes.h_min
    for share, verdict in ((0.7, "good"), (0.9, "fair"), (1.1, "poor")):
        found = value(linear, "linear_band", frequencies=[1e-3 * band, share * band])
        assert found == (pytest.approx(share), verdict)
    modes = linear.modes()
    ratio, verdict = value(linear, "linear_band", modes=modes)
    assert ratio == pytest.approx(modes.frequencies.max() / band)
    assert verdict == "poor"


def test_the_deformation_of_the_equilibrium_is_that_of_the_elastica(line):
    """A cantilever under P at its tip: P L^2 / (2 EI) of rotation, P L^3 / (3 EI) of deflection."""
    P = 0.2 * ROUND["EI_y"]
    load = Force("beam.tip", [0, P, 0], Constant(1.0))
    model = held(line, CLAMP, loads=(load,))
    loaded = linearize(replace(model, settings=replace(model.settings, start="equilibrium")))
    checks = loaded.validity().checks
    turned = sum(c.value for c in checks if c.criterion.name == "elastic_rotation")
    assert turned == pytest.approx(0.1, rel=0.02)  # of root and tip from the chord between


@pytest.mark.parametrize(("distance", "verdict"), [(0.05, "good"), (0.15, "fair"), (0.25, "poor")])
def test_a_closed_contact_far_from_its_frame(line, distance, verdict):
    """A light ball rests on the beam, on a plane that the tip carries."""
    tip, size = line.interface("tip").X[0] - line.interface("root").X[0], line.size
    ball = RigidBody(1e-3, [1e-6] * 3, start=Start([tip - distance * size, 0.0, 0.01]))
    model = model_of(
        {"beam": FlexibleBody(line, Start(-line.interface("root").X)), "ball": ball},
        (Fixed("ground", "beam.root", name="clamp"), Prismatic("ground", "ball", Z, name="guide")),
        contacts=[
            Contact("c", ("beam.tip", "ball"), "plane", 0.01, Z, impact=Impact(stiffness=1e5))
        ],
        gravity=[0.0, 0.0, -9.81],
        step=1e-3,
        start="equilibrium",
    )
    assert value(linearize(model), "contact_arm") == (pytest.approx(distance, rel=0.02), verdict)


@pytest.mark.parametrize(("patch", "verdict"), [(0.16, "good"), (0.25, "fair"), (0.35, "poor")])
def test_a_closed_contact_beyond_the_range_of_hertz(patch, verdict):
    """A ball that lies on a plane, under the force that makes this patch over its radius."""
    radius, hertz = 0.01, Hertz([2.1e9, 2.1e9], [0.3, 0.3])
    depth = radius * patch**2
    weight = 4.0 / 3.0 * hertz.modulus * np.sqrt(radius) * depth**1.5
    ball = RigidBody(weight / 9.81, [1e-3] * 3, start=Start([0.0, 0.0, radius - depth]))
    model = model_of(
        {"ball": ball},
        (Prismatic("ground", "ball", Z, name="guide"),),
        contacts=[Contact("c", ("ground.floor", "ball"), "plane", radius, Z, hertz=hertz)],
        ground_frames={"floor": Frame()},
        gravity=[0.0, 0.0, -9.81],
        step=1e-3,
        start="equilibrium",
    )
    assert value(linearize(model), "hertz_radius") == (pytest.approx(patch, rel=1e-3), verdict)
