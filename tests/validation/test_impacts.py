"""Long impacts through the contacts of models, beside exact answers and an independent loop."""

import numpy as np
import pytest
from duhamel.preprocess import build
from impact import models
from impact.bodies import arm_body, beam_body, rod_body
from impact.exact import Rod, point_impact, rod_on_wall, steel_arm, timoshenko
from impact.line import Side, collide

pytestmark = pytest.mark.validation

CASE_2 = [
    (0.0, 434.4, 9.0079, 1.4740e-3),
    (1336.9, 1782.1, 10.2980, 2.127e-3),
    (2798.3, 3221.7, 5.6044, 1.6571e-3),
]
"""start, end [us], peak [N], impulse [N s] of Timoshenko's second case, all digits converged"""


@pytest.fixture(scope="module")
def arm():
    return build(arm_body(steel_arm(), 80))


def test_timoshenkos_second_case():
    impact = timoshenko(2)
    element = build(beam_body(impact, 80))
    struck = models.sphere_on_beam(impact, element, 3.4e-3, 5e-7).strike()
    for blow, (start, end, peak, impulse) in zip(struck.blows, CASE_2, strict=True):
        assert blow.start == pytest.approx(1e-6 * start, abs=1e-6)
        assert blow.end == pytest.approx(1e-6 * end, abs=1e-6)
        assert blow.impulse == pytest.approx(impulse, rel=1e-3)
        assert blow.peak == pytest.approx(peak, rel=1e-3)
    assert struck.velocity[-1] / impact.speed == pytest.approx(-0.971258, rel=1e-3)


def test_an_arm_on_its_stop(arm):
    """The first blow of several, beside the integral equation of a hinged beam."""
    impact = steel_arm()
    struck = models.arm_on_stop(impact, arm, 1.2e-3, 1e-6).strike()
    exact = point_impact(impact, 1.2e-3, 2e-7)
    first, expected = struck.blows[0], exact.blows[0]
    assert expected.peak == pytest.approx(528.6, abs=0.1)
    assert first.peak == pytest.approx(expected.peak, rel=1e-3)
    assert first.end == pytest.approx(expected.end, rel=1e-3)
    assert first.impulse == pytest.approx(expected.impulse, rel=1e-3)
    assert len(struck.blows) == len(exact.blows)
    assert struck.velocity[-1] == pytest.approx(exact.velocity[-1], abs=2e-3)


def test_the_balance_of_an_arm_on_its_stop_is_of_second_order(arm):
    balances = []
    for h in (4e-6, 2e-6, 1e-6):
        energy = models.arm_on_stop(steel_arm(), arm, 1e-3, h).strike().results.energy
        balances.append(np.abs(energy.balance).max() / energy.kinetic[0])
    ratios = np.array(balances[:-1]) / balances[1:]
    np.testing.assert_allclose(ratios, 4.0, atol=0.4)


def test_the_loop_along_a_line_finds_the_same_force():
    """Modes alone, small motions, no multibody solver: rods move straight on."""
    rod, speed = Rod(1.0, 2.1e11 * 1e-4, 7800.0 * 1e-4), 1.0
    h, exact = models.rod_step(rod, 160), rod_on_wall(rod, speed)
    element = build(rod_body(rod, 160))
    struck = models.rod_on_wall(rod, element, exact, speed, h, 0.9).strike()
    side = Side.body(element, np.eye(3)[0], "touch", speed=speed)
    K = models.rod_contact(rod.impedance, h).stiffness
    other = collide(side, Side.wall(), K, 1.0, struck.time[-1], h)
    np.testing.assert_allclose(struck.force, other.force, atol=1e-6 * exact.force)
