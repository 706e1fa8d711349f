"""The exact impacts that benchmarks/impact has, beside each other and beside superelements.

Rods: a superelement of 160 elements, steps of the time that a wave takes for one, K = Z / 3.3 h.
Timoshenko's sphere on a beam: values converged in all digits shown, computed elsewhere with 100 to
400 modes and steps down to 5e-8 s.
"""

import numpy as np
import pytest
from duhamel.preprocess import build
from impact.bodies import beam_body, reducible_rod, rod_body
from impact.exact import (
    Rod,
    contact_force,
    contacts,
    point_impact,
    rod_on_rod,
    rod_on_wall,
    timoshenko,
)
from impact.line import Side, collide
from scipy.integrate import solve_ivp

pytestmark = pytest.mark.validation

ROD = Rod(1.0, 2.1e11 * 1e-4, 7800.0 * 1e-4)
LONG = Rod(2.0, ROD.EA, ROD.mass_per_length)
ELEMENTS = 160
H = ROD.length / ELEMENTS / ROD.wave_speed
K = ROD.impedance / (3.3 * H)
X, Z = np.eye(3)[0], np.eye(3)[2]

CASE_2 = [
    (0.0, 434.4, 9.0079, 1.4740e-3),
    (1336.9, 1782.1, 10.2980, 2.127e-3),
    (2798.3, 3221.7, 5.6044, 1.6571e-3),
]
"""start, end [us], peak [N], impulse [N s]"""


@pytest.fixture(scope="module")
def rod():
    return build(rod_body(ROD, ELEMENTS))


@pytest.fixture(scope="module")
def long_rod():
    return build(rod_body(LONG, 2 * ELEMENTS))


def side(element, speed=0.0):
    return Side.body(element, X, "touch", speed=speed)


def test_momentum_and_energy_of_exact_rods():
    wall, equal, unequal = (
        rod_on_wall(ROD, 2.0),
        rod_on_rod(ROD, ROD, 2.0),
        rod_on_rod(ROD, LONG, 2.0),
    )
    assert wall.impulse == pytest.approx(2.0 * ROD.mass * 2.0, rel=1e-14)
    assert equal.velocities == pytest.approx((0.0, 2.0), abs=1e-14)
    assert unequal.velocities == pytest.approx((0.0, 1.0), abs=1e-14)
    assert rod_on_rod(LONG, ROD, 2.0).velocities == pytest.approx((1.0, 2.0), abs=1e-14)
    with pytest.raises(ValueError, match="one impedance"):
        rod_on_rod(ROD, Rod(1.0, 2.0 * ROD.EA, ROD.mass_per_length), 1.0)


def test_a_superelement_on_a_wall(rod):
    exact = rod_on_wall(ROD, 1.0)
    run = collide(side(rod, 1.0), Side.wall(), K, 1.0, 1.3 * exact.duration, H)
    (found,) = contacts(run.time, run.force)
    assert found.peak == pytest.approx(exact.force, rel=0.003)
    assert found.impulse == pytest.approx(exact.impulse, rel=0.001)
    assert run.velocity[-1] == pytest.approx(-1.0, abs=0.001)


@pytest.mark.parametrize("struck", ["rod", "long_rod"])
def test_a_superelement_on_another(rod, struck, request):
    other = request.getfixturevalue(struck)
    exact = rod_on_rod(ROD, LONG if struck == "long_rod" else ROD, 1.0)
    run = collide(side(rod, 1.0), side(other), K, 1.0, 1.3 * exact.duration, H)
    assert len(contacts(run.time, run.force)) == 1
    assert run.force.max() == pytest.approx(exact.force, rel=0.011)
    assert run.velocity[-1] == pytest.approx(exact.velocities[0], abs=0.007)
    assert run.struck[-1] == pytest.approx(exact.velocities[1], abs=0.007)
    momentum = rod.mass * run.velocity + other.mass * run.struck
    np.testing.assert_allclose(momentum, rod.mass, rtol=1e-12)


@pytest.mark.parametrize("method", ["craig-bampton", "rubin"])
def test_few_modes_of_a_rod_are_far_too_stiff(method):
    """16 modes miss the peak by a fifth or more, 4 by a factor."""
    exact, body = rod_on_wall(ROD, 1.0), reducible_rod(ROD, ELEMENTS)
    peaks = [
        collide(
            side(body.with_modes(method, count), 1.0), Side.wall(), K, 1.0, 1.3 * exact.duration, H
        ).force.max()
        / exact.force
        for count in (4, 16, 64)
    ]
    assert peaks[0] > 1.9
    assert 1.2 < peaks[1] < 1.5
    assert 1.01 < peaks[2] < 1.04


def test_timoshenkos_first_case():
    impact = timoshenko(1)
    run = point_impact(impact, 2e-4, 1e-7)
    (found,) = contacts(run.time, run.force)
    assert found.peak == pytest.approx(4.97714, abs=1e-5)
    assert found.end == pytest.approx(156.4e-6, abs=1.1e-7)
    assert found.impulse == pytest.approx(4.3423e-4, rel=1e-5)
    assert run.velocity[-1] / impact.speed == pytest.approx(-0.302324, abs=1e-6)
    assert run.time[run.force.argmax()] == pytest.approx(72.6e-6, abs=1.1e-7)


def test_timoshenkos_second_case():
    impact = timoshenko(2)
    run = point_impact(impact, 3.4e-3, 5e-7)
    found = contacts(run.time, run.force)
    for contact, (start, end, peak, impulse) in zip(found, CASE_2, strict=True):
        assert contact.start == pytest.approx(1e-6 * start, abs=1e-6)
        assert contact.end == pytest.approx(1e-6 * end, abs=1.1e-6)
        assert contact.peak == pytest.approx(peak, rel=5e-5)
        assert contact.impulse == pytest.approx(impulse, rel=1e-4)
    assert run.velocity[-1] / impact.speed == pytest.approx(-0.971258, abs=1e-5)


def test_the_integral_equation_is_of_second_order():
    speeds = [
        point_impact(timoshenko(1), 1e-4, h, modes=20).velocity[-1] for h in (2e-6, 1e-6, 5e-7)
    ]
    assert (speeds[0] - speeds[1]) / (speeds[1] - speeds[2]) == pytest.approx(4.0, abs=0.1)


def test_the_integral_equation_is_that_of_its_modes():
    """Beside the differential equations of five modes, by a solver of order 8."""
    impact, modes = timoshenko(1), 5
    omega = impact.frequencies(modes)
    weight = 2.0 / (impact.mass_per_length * impact.length)

    def motion(t, y):
        q, rate = y[:modes], y[modes : 2 * modes]
        force = impact.K * max(y[-2] - weight * q.sum(), 0.0) ** 1.5
        return np.concatenate([rate, force - omega**2 * q, [y[-1], -force / impact.m]])

    start = np.zeros(2 * modes + 2)
    start[-1] = impact.speed
    expected = solve_ivp(motion, (0.0, 2e-4), start, "DOP853", rtol=1e-11, atol=1e-18)
    found = point_impact(impact, 2e-4, 2e-8, modes)
    assert found.velocity[-1] == pytest.approx(expected.y[-1, -1], rel=1e-6)


@pytest.mark.parametrize("case", [1, 2])
def test_a_superelement_under_the_sphere(case):
    impact = timoshenko(case)
    beam = Side.body(build(beam_body(impact, 40)), Z, "middle", ("left", "right"))
    ball = Side.particle(impact.m, impact.speed)
    t_end = {1: 2e-4, 2: 3.4e-3}[case]
    run = collide(ball, beam, impact.K, 1.5, t_end, 1e-6)
    exact = point_impact(impact, t_end, 1e-6)
    found, expected = (contacts(h.time, h.force) for h in (run, exact))
    # The last of three contacts is the softest, and follows from both before it.
    for one, other in zip(found, expected, strict=True):
        assert one.peak == pytest.approx(other.peak, rel=4e-3)
    largest = max(c.peak for c in expected)
    assert max(c.peak for c in found) == pytest.approx(largest, rel=1e-3)
    assert run.velocity[-1] == pytest.approx(exact.velocity[-1], abs=1e-3 * impact.speed)


def test_the_force_of_a_contact():
    force = contact_force(1e-5, 1e-9, 1e10)
    assert force == pytest.approx(1e10 * (1e-5 - 1e-9 * force) ** 1.5, rel=1e-12)
    assert contact_force(1e-5, 1e-3, 1e10, 1.0) == pytest.approx(1e5 / (1.0 + 1e7), rel=1e-12)
    assert contact_force(-1e-9, 1e-9, 1e10) == 0.0
