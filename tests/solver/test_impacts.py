"""Impacts of superelements through the contacts of models, beside exact answers.

Rods: d'Alembert's waves. 160 elements to 1 m, steps of the time that a wave takes for one, contact
stiffness Z / 3 h with the impedance Z that the contact meets. Sphere on beam: the integral equation
of Timoshenko, converged in the digits shown.
"""

import numpy as np
import pytest
from duhamel.preprocess import build
from impact import models
from impact.bodies import beam_body, rod_body
from impact.exact import Rod, rod_on_rod, rod_on_wall, timoshenko

ROD = Rod(1.0, 2.1e11 * 1e-4, 7800.0 * 1e-4)
LONG = Rod(2.0, ROD.EA, ROD.mass_per_length)
ELEMENTS, SPEED = 160, 2.0
H = models.rod_step(ROD, ELEMENTS)


@pytest.fixture(scope="module")
def elements():
    return {rod: build(rod_body(rod, round(ELEMENTS * rod.length))) for rod in (ROD, LONG)}


@pytest.fixture(params=[0.5, 0.9])
def rho_inf(request):
    return request.param


def energy_change(results):
    """Of motion and deformation together, over that of the start (n,)."""
    energy = results.energy
    total = energy.kinetic + energy.elastic + energy.springs
    return total / total[0] - 1.0


def check_blow(struck, exact):
    """The exact force and impulse, and no energy won."""
    blow = struck.blows[0]
    assert blow.peak == pytest.approx(exact.force, rel=0.01)
    assert blow.impulse == pytest.approx(exact.impulse, rel=0.01)
    assert struck.velocity[-1] == pytest.approx(exact.velocities[0], abs=0.01 * SPEED)
    assert energy_change(struck.results).max() < 1e-3
    assert energy_change(struck.results)[-1] > -5e-3


def test_a_rod_on_a_wall(elements, rho_inf):
    exact = rod_on_wall(ROD, SPEED)
    struck = models.rod_on_wall(ROD, elements[ROD], exact, SPEED, H, rho_inf).strike()
    check_blow(struck, exact)
    assert len(struck.blows) == 1


@pytest.mark.parametrize("other", [ROD, LONG], ids=["equal", "1:2"])
def test_a_rod_on_another(elements, rho_inf, other):
    """Restitution comes out of the waves: 1, and 1/2 where the struck rod is twice as long."""
    exact = rod_on_rod(ROD, other, SPEED)
    pair = (elements[ROD], elements[other])
    struck = models.rod_on_rod(ROD, pair, exact, SPEED, H, rho_inf).strike()
    check_blow(struck, exact)
    # Rods of 1:2 go on side by side without a force: with little damping they brush again.
    brushes = struck.blows[1:]
    assert not brushes or (other is LONG and rho_inf == 0.9)
    assert sum(blow.impulse for blow in brushes) < 1e-3 * exact.impulse
    after = struck.results.body("struck").v[-1, 0]
    assert after == pytest.approx(exact.velocities[1], abs=0.01 * SPEED)
    momentum = struck.results.momentum.linear
    np.testing.assert_allclose(momentum[:, 0], ROD.mass * SPEED, rtol=1e-13)


def test_timoshenkos_first_case():
    impact = timoshenko(1)
    element = build(beam_body(impact, 40))
    struck = models.sphere_on_beam(impact, element, 2e-4, 1e-6).strike()
    (blow,) = struck.blows
    assert blow.peak == pytest.approx(4.97714, rel=1e-3)
    assert struck.time[struck.force.argmax()] == pytest.approx(72.6e-6, abs=1e-6)
    assert blow.end == pytest.approx(156.4e-6, rel=1e-3, abs=1e-6)
    assert blow.impulse == pytest.approx(4.3423e-4, rel=1e-3)
    assert struck.velocity[-1] / impact.speed == pytest.approx(-0.302324, rel=1e-3)
    assert energy_change(struck.results).max() < 1e-3
