"""The models that stand alone, as TOML files: closed forms for what they start from and for how
they go on.
"""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import Harmonic, read_model, simulate
from scipy.integrate import solve_bvp
from scipy.optimize import brentq

from .conftest import EXAMPLES

EI, MASS_PER_LENGTH, L, G = 5.5, 0.0858, 0.5, 9.81
MASS, WEIGHT_PER_LENGTH = MASS_PER_LENGTH * L, MASS_PER_LENGTH * G


@pytest.fixture(scope="module", autouse=True)
def _superelement(example):
    example("rotating_beam").ensure_superelement()


def run(name):
    return simulate(read_model(EXAMPLES / f"{name}.toml"))


@pytest.fixture(scope="module")
def four_bar(_superelement):
    return run("four_bar")


def test_the_four_bar_starts_in_equilibrium(four_bar):
    """A coupler between hinges: its ends turn by q L^3 / (24 EI) each. The rubber carries the
    rocker and half of the coupler, the return spring pulls with 50 N/m x 0.05 m; what is missing is
    the sag of the rubber, 12 um.
    """
    bent = four_bar.frame("coupler.tip").u[0, 5] - four_bar.frame("coupler.root").u[0, 5]
    assert bent == pytest.approx(WEIGHT_PER_LENGTH * L**3 / (12 * EI), rel=1e-6)
    np.testing.assert_allclose(
        four_bar.spring("rubber").force[0], [0, (0.1 + MASS / 2) * G, 0], rtol=0, atol=2e-4
    )
    np.testing.assert_allclose(four_bar.spring("return").force[0], [2.5, 0, 0], rtol=0, atol=2e-4)


def test_the_rocker_of_the_four_bar_follows_the_crank(four_bar):
    """As rigid bars in rigid bearings do, by the law of cosines for rocker, coupler and the line
    from A to C, but for what coupler and rubber give: 14 N at most on 1e5 N/m, on a rocker of 0.3
    m.
    """
    angle = four_bar.joint("drive").coordinates["angle"]
    np.testing.assert_allclose(angle, 20.0 * four_bar.time**3, rtol=0, atol=1e-9)
    to_foot = np.array([0.5, -0.2]) - 0.1 * np.column_stack([-np.sin(angle), np.cos(angle)])
    distance = np.linalg.norm(to_foot, axis=1)
    between = np.arccos((distance**2 + 0.3**2 - L**2) / (2 * 0.3 * distance))
    expected = np.arctan2(-to_foot[:, 1], -to_foot[:, 0]) - between
    arm = four_bar.frame("rocker.pin").position - four_bar.frame("rocker.foot").position
    assert np.ptp(expected) > 0.6
    assert np.abs(np.arctan2(arm[:, 1], arm[:, 0]) - expected).max() < 14 / 1e5 / 0.3
    assert np.abs(four_bar.energy.balance).max() < 1e-5 * four_bar.energy.work.max()


@pytest.mark.parametrize(("part", "tolerance"), [(1.0, 3e-3), (0.1, 6e-4)])
def test_the_beam_on_the_shaker_answers_as_duhamels_integral(part, tolerance):
    """Mode by mode from rest, q'' + omega^2 q = -(acceleration of the base), which is two sines.
    The differences are 2.1e-3 of the peak, and 5.5e-4 for a tenth of the motion: most is of second
    order in it, the rest of the step.
    """
    model = read_model(EXAMPLES / "shaker.toml")
    surge, sway, heave, pitch = model.motions
    heave = replace(heave, displacement=Harmonic(part * heave.displacement.amplitude, 12.0))
    pitch = replace(pitch, angle=Harmonic(part * pitch.angle.amplitude, 30.0))
    results = simulate(replace(model, motions=(surge, sway, heave, pitch)))
    omega, heaving, pitching, tip = cantilever()
    expected = np.zeros(results.time.shape)
    for signal, participation in (
        (heave.displacement, heaving),
        (pitch.angle, -(0.1 * heaving + pitching)),
    ):
        w, t = 2.0 * np.pi * signal.frequency, results.time[:, None]
        unit = (np.sin(w * t) - w / omega * np.sin(omega * t)) * w**2 / (omega**2 - w**2)
        expected += signal.amplitude * unit @ (participation * tip)
    angle = pitch.angle.amplitude * np.sin(2.0 * np.pi * 30.0 * results.time)
    arm = results.frame("beam.tip").position - results.frame("table.top").position
    deflection = np.sin(angle) * arm[:, 0] + np.cos(angle) * arm[:, 2]
    assert np.abs(deflection - expected).max() < tolerance * np.abs(expected).max()


def cantilever(modes=5):
    """Of each mode: frequency [rad/s], participation in a shift of its base and in a turn about it,
    and tip value.

    phi = cosh - cos - sigma (sinh - sin) has the mean square 1, int phi = 2 sigma L / k and int x
    phi = 2 L^2 / k^2.
    """
    k = np.array(
        [
            brentq(lambda k: np.cos(k) + 1 / np.cosh(k), np.pi * i, np.pi * (i + 1))
            for i in range(modes)
        ]
    )
    sigma = (np.cosh(k) + np.cos(k)) / (np.sinh(k) + np.sin(k))
    omega = k**2 * np.sqrt(EI / (MASS_PER_LENGTH * L**4))
    return omega, 2 * sigma / k, 2 * L / k**2, 2.0 * (-1.0) ** np.arange(modes)


def test_the_rotor_does_not_ring_before_it_is_pushed():
    results = run("rotor")
    before = results.time < 0.2
    speed = results.body("hub").v[:, 5]
    assert np.ptp(speed[before]) < 1e-9
    assert np.ptp(speed[~before]) > 0.1
    for blade in ("left", "right"):
        height = results.frame(f"{blade}.tip").position[:, 2]
        assert np.ptp(height[before]) < 1e-13
        # Of the stiffening by rotation, 4.1 % of the sag, a floating frame has three quarters.
        assert height[0] == pytest.approx(sag_in_rotation(20.0, 0.05), rel=1.2e-2)
    pull, across, lift = results.joint("right clamp").force[0]
    assert pull == pytest.approx(-MASS * (0.05 + L / 2) * 20.0**2, rel=1e-6)
    assert lift == pytest.approx(MASS * G, rel=1e-10)
    assert abs(across) < 1e-10


def sag_in_rotation(spin, radius):
    """Height of the tip of a beam on a hub of this radius under its weight, stretched by its
    rotation: EI w'''' - (N w')' = -q, N = m Omega^2 ((a + L)^2 - (a + x)^2) / 2.
    """
    pull = MASS_PER_LENGTH * spin**2

    def slopes(x, w):
        N, N_x = 0.5 * pull * ((radius + L) ** 2 - (radius + x) ** 2), -pull * (radius + x)
        return np.vstack([w[1:], (N * w[2] + N_x * w[1] - WEIGHT_PER_LENGTH) / EI])

    def ends(root, tip):
        return np.array([root[0], root[1], tip[2], tip[3]])

    return solve_bvp(slopes, ends, np.linspace(0.0, L, 20), np.zeros((4, 20)), tol=1e-8).y[0, -1]
