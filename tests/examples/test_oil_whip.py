"""A rotor on fluid films and pedestals: the coefficients of its table, and its run-up."""

import numpy as np
import pytest
from scipy.optimize import fsolve

from .conftest import EXAMPLES

DIFFERENCE = 3e-4


def film_force(place, rate):
    """The force on a journal of a short bearing, by pressures above zero alone.

    Reynolds' equation over the width, p ~ q / h^3 (z^2 - L^2 / 4), q = Omega/2 dh/dtheta + dh/dt.
    In mu Omega R L^3 / c^2, by place / c and rate / (c Omega).
    """
    theta = 2.0 * np.pi * (np.arange(200000) + 0.5) / 200000
    normal = np.array([np.cos(theta), np.sin(theta)])
    ahead = np.array([-normal[1], normal[0]])
    h = 1.0 - place @ normal
    q = -0.5 * (place @ ahead) - rate @ normal
    return normal @ (np.minimum(q, 0.0) / h**3) * (theta[1] - theta[0])


@pytest.mark.parametrize("eccentricity", [0.15, 0.27, 0.6])
def test_coefficients_of_a_short_bearing_are_the_slopes_of_its_force(example, eccentricity):
    script, still = example("oil_whip"), np.zeros(2)
    number, expected = script.short_bearing(np.array([eccentricity]))

    def across(angle):
        return film_force(eccentricity * np.array([np.cos(angle[0]), np.sin(angle[0])]), still)[:1]

    # The load is against y: the film carries it where nothing of its force is across.
    angle = float(fsolve(across, [-0.8])[0])
    place = eccentricity * np.array([np.cos(angle), np.sin(angle)])
    load = film_force(place, still)[1]
    ratio = script.DIAMETER / script.WIDTH
    assert number[0] == pytest.approx(ratio**2 / (4.0 * np.pi * load), rel=1e-5)
    found = []
    for at in (lambda d: film_force(place + d, still), lambda d: film_force(place, d)):
        slopes = [
            (at(-DIFFERENCE * axis) - at(DIFFERENCE * axis)) / (2.0 * DIFFERENCE * load)
            for axis in np.eye(2)
        ]
        found.append(np.array(slopes).T.ravel())
    np.testing.assert_allclose(np.concatenate(found), expected[0], rtol=2e-4)


def test_the_table_is_what_the_script_writes(example, tmp_path):
    example("oil_whip").write_table(tmp_path / "oil_whip.csv")
    assert (tmp_path / "oil_whip.csv").read_text() == (EXAMPLES / "oil_whip.csv").read_text()


@pytest.mark.validation
def test_oil_whip(example, tmp_path):
    linear, run = example("oil_whip").main(tmp_path)  # which checks them beside finite elements
    assert {path.name for path in tmp_path.glob("*.png")} == {"oil-whip.png", "oil-whip-linear.png"}
    (critical,) = linear.critical
    # Whip sets in at about twice the first critical speed.
    assert 1.8 < linear.threshold / critical < 2.2
    before, late = (run.disks[run.speed < 250.0][-1000:], run.disks[run.speed > 320.0])
    assert np.abs(late).max() > 3.0 * np.abs(before).max()
    assert np.abs(run.journal).max() < 0.1 * 1e-4  # of the clearance
