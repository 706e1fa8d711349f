"""The examples of fast rotation, which check their own numbers, and what the pages say of them."""

import numpy as np
import pytest
from rotating_theory import RotatingBeam, peak_frequency


def test_frequencies_of_a_rotating_beam():
    """A. D. Wright et al. (1982), table 1: no hub, speeds of 0, 3 and 6 sqrt(EI / m L^4)."""
    beam = RotatingBeam(1.0, 1.0, 1.0)
    published = {0.0: (3.5160, 22.0345), 3.0: (4.7973, 23.3203), 6.0: (7.3604, 26.8091)}
    for spin, expected in published.items():
        np.testing.assert_allclose(beam.flap(spin)[:2], expected, rtol=0, atol=6e-5)
        np.testing.assert_allclose(beam.lag(spin) ** 2, beam.flap(spin) ** 2 - spin**2)


def test_a_rigid_blade_flaps_by_the_formula():
    beam = RotatingBeam(0.95, 1e4, 1.0, hub=0.05, hinged=True)
    expected = np.sqrt(1.0 + 1.5 * 0.05 / 0.95)
    assert beam.flap(1.0)[0] == pytest.approx(expected, rel=1e-6)
    # the moments of weight, and of the centrifugal force at an angle, about the hinge
    coning = -1.5 * 9.81 / (0.95 * expected**2)
    assert beam.coning(1.0, -9.81) == pytest.approx(coning, rel=1e-4)


def test_a_frequency_is_read_off():
    time = 1e-3 * np.arange(3000)
    signal = np.exp(-time) * np.cos(40.0 * time) + 0.3 * np.cos(90.0 * time) + 5.0
    assert peak_frequency(signal, 1e-3, 44.0) == pytest.approx(40.0, rel=1e-3)


def pictures(folder):
    return {path.name for path in folder.glob("*.png")}


@pytest.mark.validation
def test_run_up(example, tmp_path):
    diagram, found = example("run_up").main(tmp_path)
    assert pictures(tmp_path) == {"campbell.png", "run-up.png"}
    # without second order lag and the second flap fall; with it all rise
    assert (np.diff(diagram.found, axis=0) > 0.0).all()
    assert (np.diff(diagram.without[:, 1:], axis=0) < 0.0).all()
    assert np.abs(found.without - found.expected).max() > np.abs(found.expected).max()


@pytest.mark.validation
def test_unbalance(example, tmp_path):
    found = example("unbalance").main(tmp_path)
    assert pictures(tmp_path) == {"unbalance.png"}
    assert np.abs(found.without - found.expected).max() > 0.5 * np.abs(found.expected).max()


@pytest.mark.validation
def test_flapping_blade(example, tmp_path):
    example("flapping_blade").main(tmp_path)
    assert pictures(tmp_path) == {"flapping-blade.png"}


@pytest.mark.validation
def test_bladed_disk(example, tmp_path):
    script = example("bladed_disk")
    found, _ = script.main(tmp_path)
    assert pictures(tmp_path) == {"bladed-disk.png", "bladed-disk-stress.png"}
    assert len(set(np.round(found.radii, 6))) > 5


@pytest.mark.validation
def test_soft_pendulum(example, tmp_path):
    example("soft_pendulum").main(tmp_path)
    assert pictures(tmp_path) == {"soft-pendulum.png"}
