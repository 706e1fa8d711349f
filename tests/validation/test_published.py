"""References of examples/benchmarks that come from Exudyn, computed anew.

Its beams have two nodes and err with the square of their length, so that two meshes, one twice as
fine, give the limit: f + (f - c) / 3 of the fine and the coarse value. What is left is of fourth
order.
"""

import numpy as np
import pytest

pytest.importorskip("exudyn")

import published
from peer.lateral_buckling import lateral_buckling
from peer.published import beam_section, princeton_tip
from peer.rotating_shaft import rotating_shaft

pytestmark = [
    pytest.mark.validation,
    pytest.mark.filterwarnings("ignore:ObjectJointGeneric.*rotationMarker:DeprecationWarning"),
]


def limit(coarse, fine):
    return fine + (fine - coarse) / 3.0


def test_the_tip_of_the_princeton_beam():
    import princeton

    of = princeton.SECTION
    stiffnesses = [of.EA, of.GA_y, of.GA_z, of.GJ, of.EI_y, of.EI_z]
    section = beam_section(stiffnesses, of.mass_per_length, [1e-6] * 3)
    force = 8.896 * np.sqrt(0.5) * np.array([0.0, 1.0, 1.0])
    tips = [princeton_tip(princeton.L, section, force, n)[[2, 1]] for n in (16, 32)]
    np.testing.assert_allclose(limit(*tips), princeton.CONVERGED, rtol=2e-5)


def test_a_skew_four_bar_linkage():
    import misaligned_four_bar as model

    rows = np.round(model.TIMES / published.SKEW_STEP).astype(int)
    (coarse, coarse_torque), (fine, fine_torque) = (
        published.exudyn_skew_four_bar(n) for n in (8, 16)
    )
    deflections = limit(coarse.tip[rows, 2], fine.tip[rows, 2])
    torques = limit(coarse_torque[rows], fine_torque[rows])
    assert model.error(deflections, model.DEFLECTIONS) < 2e-5
    assert model.error(torques, model.TORQUES) < 2e-4


def test_a_beam_that_buckles_sideways():
    import lateral_buckling as model

    coarse, fine = (lateral_buckling(n, 5e-4, model.AT).tip[-1] for n in (32, 64))
    assert limit(coarse[1], fine[1]) == pytest.approx(model.SIDEWAYS, rel=1e-3)
    assert limit(coarse[2], fine[2]) == pytest.approx(model.UPWARDS, rel=1e-3)


def test_a_shaft_runs_through_its_critical_speed():
    """Steps of 1 and 0.5 ms give the limit of small steps, too."""
    import rotating_shaft as model

    def places(elements, step):
        rows = np.round(model.TIMES / step).astype(int)
        return rotating_shaft(elements, step, model.TIMES[-1]).tip[rows, 1:]

    coarse = places(32, 1e-3)
    fine = limit(coarse, places(64, 1e-3)) + 4.0 / 3.0 * (places(32, 5e-4) - coarse)
    largest = np.linalg.norm(model.REFERENCE, axis=1).max()
    assert np.linalg.norm(fine - model.REFERENCE, axis=1).max() / largest < 5e-4
