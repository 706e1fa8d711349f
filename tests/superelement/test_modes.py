"""The finest step of modes and the band of kernels; symbols of the scheme; static and initial
responses as sums over modes.
"""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.superelement import (
    GeneralizedAlpha,
    Modes,
    StepWarning,
    SuperelementError,
    read,
    sample_kernel,
    write,
)


@pytest.mark.parametrize("rho_inf", [0.0, 0.5, 0.9, 1.0])
def test_symbols_are_those_of_the_continuum_to_second_order(rho_inf):
    """sigma -> s^2 and chi -> s at d = e^{-s h}; displacement, velocity and acceleration of one
    scheme agree.
    """
    scheme, s = GeneralizedAlpha(rho_inf), np.array([3.0 + 40.0j])
    errors = []
    for h in (2e-3, 1e-3, 5e-4):
        sigma, chi = scheme.symbols(h, np.exp(-s * h))
        errors.append([abs(sigma[0] / s[0] ** 2 - 1), abs(chi[0] / s[0] - 1)])
    errors = np.array(errors)
    np.testing.assert_allclose(np.log2(errors[:-1] / errors[1:]), 2.0, atol=0.05)


@pytest.fixture
def fine(make_element):
    """Its kernel has h = 1e-4 s and modes that hold for steps down to that."""
    element = make_element()
    kernel = sample_kernel(element.modes, 1e-4, GeneralizedAlpha(0.8), 7, error=1e-7, band=2500.0)
    return replace(element, modes=replace(element.modes, h_min=1e-4), kernel=kernel)


@pytest.mark.parametrize("h", [1e-4, 1e-4 * (1 - 1e-12), 3e-4])
def test_steps_that_the_modes_hold_for_are_not_spoken_of(fine, h):
    assert fine.modes_for(h) is fine.modes
    kernel = fine.kernel_for(h, GeneralizedAlpha(0.5), 20)
    assert (kernel.error, kernel.band) == (1e-7, 2500.0)


def test_a_finer_step_is_told_with_what_it_would_resolve(fine):
    message = (
        "body 0: modes for steps down to 0.0001 s, right up to 2500 Hz; "
        "asked for steps of 2e-05 s, which resolve 12500 Hz"
    )
    with pytest.warns(StepWarning, match=message):
        assert fine.modes_for(2e-5) is fine.modes
    with pytest.warns(StepWarning, match=message):
        fine.kernel_for(2e-5, GeneralizedAlpha(0.8), 7)


def test_modes_that_a_body_does_not_have_cannot_be_asked_for(make_element):
    with pytest.raises(SuperelementError, match="body 0: no modes"):
        replace(make_element(), modes=None, recovery=None).modes_for(1e-4)


def test_the_file_keeps_band_and_finest_step(fine, tmp_path):
    write(tmp_path / "fine.h5", fine)
    again = read(tmp_path / "fine.h5")
    assert (again.modes.h_min, again.kernel.band, again.kernel.error) == (1e-4, 2500.0, 1e-7)


def test_band_and_finest_step_must_make_sense(fine):
    with pytest.raises(
        SuperelementError, match=r"kernel: band: expected a positive number, found 0\.0"
    ):
        replace(fine.kernel, band=0.0)
    with pytest.raises(
        SuperelementError, match=r"modes: h_min: expected a step >= 0 s, found -1\.0"
    ):
        replace(fine.modes, h_min=-1.0)


def test_what_rests_and_what_starts_is_what_the_modes_add_up_to(make_modes):
    """The compliance is G for a load that lasts, the accelerance the acceleration that a small step
    sees.
    """
    modes, scheme = make_modes(2, 3, 6), GeneralizedAlpha(1.0)
    damped = Modes(modes.omega, np.full(6, 0.3), modes.phi)
    g = sample_kernel(damped, 1e-3, scheme, 5000).g
    np.testing.assert_allclose(
        modes.compliance, g.sum(axis=0), rtol=0, atol=1e-10 * np.abs(modes.compliance).max()
    )
    h = 1e-9
    first = sample_kernel(replace(modes, zeta=np.zeros(6)), h, scheme, 1).g[0] * 4.0 / h**2
    np.testing.assert_allclose(modes.accelerance, first, rtol=0, atol=1e-9 * np.abs(first).max())
