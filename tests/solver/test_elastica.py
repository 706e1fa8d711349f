"""Where the limits of docs/validity.md come from: errors against exact beams, and of the scheme."""

import numpy as np
import pytest
import scipy.linalg
from duhamel.preprocess.body.body import NonlinearCoordinates
from duhamel.results.criteria import CRITERIA
from duhamel.solver import (
    Constant,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Model,
    Place,
    Revolute,
    RigidBody,
    Settings,
    Start,
    SteadyRotation,
    start,
)
from duhamel.superelement import GeneralizedAlpha
from scipy.integrate import solve_bvp

from .conftest import make_beam

L, EI, MASS_PER_LENGTH, EA = 0.5, 5.5, 0.0858, 2.16e7


def arm(results):
    """The tip seen from the root (3,)."""
    tip, root = (results.frame(f"beam.{name}").position[0] for name in ("tip", "root"))
    return tip - root


def elastica(alpha):
    """Tip of an inextensible cantilever over its length: theta'' = -alpha cos(theta)."""
    s = np.linspace(0.0, 1.0, 50)
    guess = np.zeros((4, 50))
    guess[2] = s
    solved = solve_bvp(
        lambda s, y: np.vstack([y[1], -alpha * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])]),
        lambda a, b: np.array([a[0], b[1], a[2], a[3]]),
        s,
        guess,
        tol=1e-8,
    )
    return solved.y[2:, -1]


@pytest.fixture(scope="module")
def curved():
    """The same beam with terms of second order."""
    return make_beam(rotation=NonlinearCoordinates())


def bent(beam, alpha):
    """In equilibrium under a dead force across its tip."""
    return start(
        Model(
            {"beam": FlexibleBody(beam.element)},
            [Fixed("ground", "beam.root", name="clamp")],
            [Force("beam.tip", [0, 1, 0], Constant(alpha * EI / L**2))],
            settings=Settings(t_end=6e-5, start="equilibrium"),
        )
    )


@pytest.mark.parametrize(
    ("alpha", "rotation", "displacement", "error"),
    [
        (0.2, 0.070, 0.010, 0.007),
        (0.4, 0.139, 0.020, 0.014),
        (0.6, 0.206, 0.029, 0.022),
        (0.8, 0.271, 0.039, 0.030),
        (1.0, 0.333, 0.048, 0.039),
        (2.0, 0.592, 0.085, 0.081),
        (4.0, 0.910, 0.130, 0.128),
    ],
)
def test_errors_of_a_cantilever_against_the_elastica(beam, alpha, rotation, displacement, error):
    results = bent(beam, alpha)
    exact = elastica(alpha)
    found = arm(results)[:2] / L
    deflection = np.linalg.norm(exact - [1.0, 0.0])
    assert np.linalg.norm(found - exact) / deflection == pytest.approx(error, abs=6e-4)
    validity = results.validity
    turned = validity.values("elastic_rotation")["beam.root"]
    assert turned == pytest.approx(rotation, abs=6e-4)
    moved = validity.values("elastic_displacement")["beam.root"]
    assert moved == pytest.approx(displacement, abs=6e-4)
    verdict = CRITERIA["elastic_rotation"].verdict(turned)
    assert verdict == ("good" if error < 0.01 else "fair" if error < 0.035 else "poor")


@pytest.mark.parametrize(
    ("alpha", "rotation", "displacement", "error"),
    [
        (0.2, 0.070, 0.010, 3e-4),
        (0.6, 0.204, 0.029, 0.0021),
        (1.0, 0.324, 0.046, 0.0051),
        (2.0, 0.553, 0.079, 0.0127),
        (4.0, 0.812, 0.115, 0.0217),
    ],
)
def test_errors_with_terms_of_second_order(curved, alpha, rotation, displacement, error):
    results = bent(curved, alpha)
    exact, found = elastica(alpha), arm(results)[:2] / L
    deflection = np.linalg.norm(exact - [1.0, 0.0])
    assert np.linalg.norm(found - exact) / deflection == pytest.approx(error, abs=2e-4)
    turned = results.validity.values("second_order_rotation")["beam.root"]
    moved = results.validity.values("second_order_displacement")["beam.root"]
    assert turned == pytest.approx(rotation, abs=6e-4)
    assert moved == pytest.approx(displacement, abs=6e-4)
    assert error < 0.01 or CRITERIA["second_order_rotation"].verdict(turned) == "poor"


@pytest.mark.parametrize(
    ("part", "precision"), [(0.5, 1e-5), (0.9, 1e-4), (0.99, 5e-3), (-4.0, 1e-3)]
)
def test_a_column_near_its_buckling_load(curved, part, precision):
    """Clamped, with a small force Q across its tip: w = Q (tan(k L) / k - L) / P, k^2 = P / EI."""
    P, small = part * np.pi**2 * EI / (4.0 * L**2), 1e-4
    model = Model(
        {"beam": FlexibleBody(curved.element)},
        [Fixed("ground", "beam.root", name="clamp")],
        [Force("beam.tip", [-P, small, 0], Constant(1.0))],
        settings=Settings(t_end=6e-5, start="equilibrium"),
    )
    k = np.sqrt(complex(P / EI))
    expected = (small * (np.tan(k * L) / k - L) / P).real
    assert arm(start(model))[1] == pytest.approx(expected, rel=precision)


def flap(gamma):
    """Tip of a rotating cantilever under a small force along the axis, over P L^3 / EI.

    w'''' - gamma^2 ((1 - x^2) / 2 w')' = 0
    """

    def slopes(x, y):
        tension, slope = 0.5 * gamma**2 * (1.0 - x * x), -(gamma**2) * x
        return np.vstack([y[1], y[2], y[3], tension * y[2] + slope * y[1]])

    x = np.linspace(0.0, 1.0, 101)
    ends = lambda a, b: np.array([a[0], a[1], b[2], b[3] + 1.0])  # noqa: E731
    return solve_bvp(slopes, ends, x, np.zeros((4, 101)), tol=1e-9).y[0, -1]


@pytest.mark.parametrize(
    ("ratio", "error", "precision"),
    [
        (0.0125, 0.002, 5e-4),
        (0.025, 0.008, 5e-4),
        (0.05, 0.03, 5e-3),
        (0.1, 0.10, 5e-3),
        (0.2, 0.26, 5e-3),
        (0.27, 0.38, 5e-3),
    ],
)
def test_errors_of_a_rotating_cantilever(beam, ratio, error, precision):
    """Its deflection along the axis; and its stretch, of which a quarter is always missing."""
    deflection, stretch, results = rotating(beam, ratio)
    assert deflection == pytest.approx(error, abs=precision)
    assert results.validity.values("spin")["beam"] == pytest.approx(ratio, rel=1e-9)
    assert stretch == pytest.approx(-0.25, abs=2e-3)


@pytest.mark.parametrize(("ratio", "errors"), [(0.1, (5e-5, 5e-6)), (0.27, (1e-3, 5e-5))])
def test_they_are_small_with_terms_of_second_order(curved, ratio, errors):
    deflection, stretch, _ = rotating(curved, ratio)
    assert abs(deflection) < errors[0]
    assert abs(stretch) < errors[1]


def rotating(beam, ratio):
    """The relative errors of its deflection and of its stretch, and the results."""
    speed = ratio * beam.element.modes.omega.min()
    force = 1e-3 * EI / L**2
    hub = RigidBody(1e3, [1e4] * 3, {"rim": Frame()})
    model = Model(
        {"hub": hub, "beam": FlexibleBody(beam.element, Start(place=Place("root", "hub.rim")))},
        [
            Revolute("ground", "hub", [0, 0, 1], name="pivot"),
            Fixed("hub.rim", "beam.root", name="clamp"),
        ],
        [Force("beam.tip", [0, 0, 1], Constant(force))],
        settings=Settings(
            t_end=6e-5, start="equilibrium", steady_rotation=SteadyRotation([0, 0, speed])
        ),
    )
    results = start(model)
    deflection = arm(results)[2] / (force * L**3 / EI)
    exact = flap(speed / np.sqrt(EI / (MASS_PER_LENGTH * L**4)))
    straight = start(Model(model.bodies, model.joints, settings=model.settings))
    k = speed * np.sqrt(MASS_PER_LENGTH / EA) * L
    stretch = L * (np.tan(k) / k - 1.0)
    return (
        deflection / exact - 1.0,
        (np.linalg.norm(arm(straight)) - L) / stretch - 1.0,
        results,
    )


@pytest.mark.parametrize(("steps", "error"), [(20, 0.008), (10, 0.033), (8, 0.050), (5, 0.12)])
def test_the_period_of_the_scheme(steps, error):
    """From the roots of its amplification matrix, on displacement, rate and pseudo-acceleration."""
    s, square = GeneralizedAlpha(0.9), (2.0 * np.pi / steps) ** 2
    after = np.array(
        [[1, 0, -s.beta], [0, 1, -s.gamma], [(1 - s.alpha_f) * square, 0, 1 - s.alpha_m]]
    )
    before = np.array(
        [[1, 1, 0.5 - s.beta], [0, 1, 1 - s.gamma], [-s.alpha_f * square, 0, -s.alpha_m]]
    )
    roots = np.linalg.eigvals(np.linalg.solve(after, before))
    turned = np.abs(np.angle(roots[np.argmax(roots.imag)]))
    assert np.sqrt(square) / turned - 1.0 == pytest.approx(error, abs=1e-3 if steps > 5 else 5e-3)


def test_modal_damping_is_that_of_the_free_body(beam):
    """The example of the paper's beam, clamped, with 2 % in the modes of the free one."""
    element, zeta = beam.element, 0.02
    x, y, z = element.interface("root").X
    rigid = np.eye(6)
    rigid[:3, 3:] = [[0, z, -y], [-z, 0, x], [y, -x, 0]]
    held = np.hstack([rigid, element.modes.phi[element.rows("root")]])
    omega = np.append(np.zeros(6), element.modes.omega)
    left = scipy.linalg.null_space(held)
    mass = scipy.linalg.block_diag(element.mass * np.eye(3), element.J_rot, np.eye(len(omega) - 6))
    square, shapes = scipy.linalg.eigh(left.T @ np.diag(omega**2) @ left, left.T @ mass @ left)
    clamped = np.sqrt(square[[0, 2, 4, 6]])
    shapes = (left @ shapes)[:, [0, 2, 4, 6]]
    ratios = (2.0 * zeta * omega) @ shapes**2 / (2.0 * clamped)
    np.testing.assert_allclose(clamped / (2.0 * np.pi), [17.9, 112.3, 314.6, 616.8], atol=0.06)
    np.testing.assert_allclose(ratios, [0.0014, 0.013, 0.016, 0.017], rtol=0.04)
    shares = (omega[6:, None] * shapes[6:]) ** 2 / clamped**2
    np.testing.assert_allclose(shares.sum(axis=0), 1.0, rtol=1e-6)
    by_formula = zeta * (shares / omega[6:, None]).sum(axis=0) * clamped
    np.testing.assert_allclose(by_formula, ratios, rtol=1e-9)
    assert np.all(ratios <= zeta * clamped / omega[6:].min() + 1e-12)
