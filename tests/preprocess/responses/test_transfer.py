"""Transfer functions of modes in closed form against the sums over lags that define them."""

import numpy as np
import pytest
from duhamel.superelement import GeneralizedAlpha, Modes, sample_kernel
from duhamel.superelement.transfer import dynamic_stiffness, transfer

DELAYS = np.exp(-0.1 - 1j * np.array([0.0, 0.05, 0.7, 2.0, np.pi]))


@pytest.fixture
def modes():
    rng = np.random.default_rng(3)
    omega, zeta = np.sort(rng.uniform(50.0, 5000.0, 9)), rng.uniform(0.0, 0.1, 9)
    return Modes(omega, zeta, rng.normal(size=(4, 9)))


@pytest.mark.parametrize("rho_inf", [0.0, 0.5, 0.9, 1.0])
def test_the_transfer_function_is_the_sum_of_the_kernel(rho_inf, modes):
    """G(d) = sum_k g[k] d^k: 400 lags at |d| = e^-0.1 leave e^-40."""
    h, scheme = 1e-3, GeneralizedAlpha(rho_inf)
    g = sample_kernel(modes, h, scheme, 400).g
    expected = np.tensordot(DELAYS[:, None] ** np.arange(401), g, axes=1)
    np.testing.assert_allclose(
        transfer(modes, h, scheme, DELAYS), expected, rtol=0, atol=1e-12 * np.abs(g).max()
    )


@pytest.mark.parametrize("rho_inf", [0.0, 0.5, 0.9, 1.0])
def test_without_delay_it_is_the_first_lag(rho_inf, modes):
    h, scheme = 1e-3, GeneralizedAlpha(rho_inf)
    first = sample_kernel(modes, h, scheme, 1).g[0]
    found = transfer(modes, h, scheme, np.zeros(1, dtype=complex))[0]
    np.testing.assert_allclose(found, first, rtol=0, atol=1e-14 * np.abs(first).max())
    sigma, chi = scheme.symbols(h, np.zeros(1))
    np.testing.assert_allclose(
        [sigma[0], chi[0]], [scheme.beta_prime(h), scheme.gamma_prime(h)], rtol=1e-14
    )


def test_a_mode_without_damping_resonates_where_its_dynamic_stiffness_vanishes():
    """rho_inf = 1 is the trapezoidal rule: omega = 2 / h tan(theta / 2) on the unit circle."""
    h, theta = 1e-3, np.array([0.1, 1.0, 2.0])
    omega = 2.0 / h * np.tan(theta / 2.0)
    modes = Modes(omega, np.zeros(3), np.ones((1, 3)))
    stiffness = dynamic_stiffness(modes, h, GeneralizedAlpha(1.0), np.exp(-1j * theta))
    np.testing.assert_allclose(np.abs(np.diagonal(stiffness)) / omega**2, 0.0, atol=1e-12)
