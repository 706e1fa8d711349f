"""Parts with damping ratios up to a half, whose peaks are low, are checked as all others."""

import re

import numpy as np
import pytest
from duhamel import preprocess
from duhamel.preprocess.measured.doubts import doubts_of_test
from duhamel.preprocess.measured.first_resonance import first_resonance
from duhamel.preprocess.measured.part import identified
from duhamel.preprocess.measured.part_test import measurement_of, read_part_test
from duhamel.preprocess.progress import Stages

from .hammer_bench import ALL, HITS, Errors, measure, replace, truth, with_fault

NOISY = replace(ALL, noise=0.05, floor=5e-3, seed=2)
DAMPED = pytest.mark.parametrize("damping", [0.05, 0.2, 0.5])


def doubts(bench, folder, **keys):
    test = read_part_test(preprocess.read_body(bench.write(folder, **keys)))
    return list(doubts_of_test(test, measurement_of(test)))


@DAMPED
@pytest.mark.parametrize("rigid", ["", 'from = "frf"'], ids=["mass given", "mass by responses"])
def test_a_right_test_of_a_damped_part_has_no_doubts(damping, rigid, tmp_path):
    for errors in (Errors(), ALL, NOISY, replace(ALL, cords=3.0)):
        assert doubts(measure(replace(errors, damping=damping)), tmp_path, rigid=rigid) == []


@DAMPED
def test_stiff_cords_of_a_damped_part_are_one_message(damping, tmp_path):
    for errors in (ALL, NOISY):
        (found,) = doubts(measure(replace(errors, damping=damping, cords=8.0)), tmp_path)
        said = re.match(r"the part has (\d+\.?\d*) Hz on its cords", found)
        assert float(said[1]) == pytest.approx(8.0, rel=0.05)


@DAMPED
def test_a_wrong_wire_of_a_damped_part_is_one_message(damping, tmp_path):
    def reversed_hit(H):
        H[:, :, list(HITS).index("105")] *= -1.0

    bench = with_fault(measure(replace(ALL, damping=damping)), reversed_hit)
    (found,) = doubts(bench, tmp_path)
    assert found.startswith("hit 105 has the other direction")


@DAMPED
def test_the_first_resonance_is_that_of_the_part(damping):
    bench = measure(Errors(damping=damping))
    found = first_resonance(bench.f, bench.H)
    expected = truth().element.modes.omega[0] / (2.0 * np.pi)
    # What higher modes do below it is not in its fit, and a peak may lie between two lines.
    assert found.f == pytest.approx(expected, rel=0.01)
    if found.zeta:
        assert found.zeta == pytest.approx(damping, rel=0.01)
    assert 0.5 * expected < found.end < 0.76 * expected


def test_noise_of_the_first_lines_is_no_resonance():
    bench, rng = measure(Errors()), np.random.default_rng(0)
    H = bench.H.copy()
    parts = rng.standard_normal((2, 10, *H.shape[1:]))
    H[:10] += np.abs(H[:10]) * (parts[0] + 1j * parts[1])
    assert first_resonance(bench.f, H) == first_resonance(bench.f, bench.H)


def test_a_heavily_damped_part_is_identified_without_a_doubt(tmp_path):
    """Its modes overlap: at 3 kHz one is as wide as five of them are apart."""
    bench = measure(replace(ALL, damping=0.3))
    few = replace(bench, f=bench.f[::3], H=bench.H[::3])
    part = identified(preprocess.read_body(few.write(tmp_path)), Stages())
    assert part.doubts == ()
    fit, omega = part.found.fit, truth().element.modes.omega[:9]
    assert fit.misfit < 0.055
    nearest = np.abs(fit.omega[:, None] - omega).argmin(axis=0)
    assert len(set(nearest)) == 9
    np.testing.assert_allclose(fit.omega[nearest], omega, rtol=0.01)
    np.testing.assert_allclose(fit.zeta[nearest], 0.3, rtol=0.1)
