"""The parameters of generalized-alpha and what follows from them."""

import numpy as np
import pytest
from duhamel.superelement import GeneralizedAlpha

RHO_INF = (0.0, 0.3, 0.5, 0.9, 1.0)


def spectral_radius(scheme: GeneralizedAlpha, inertia: float, stiffness: float) -> float:
    """Of one step h = 1 of inertia u'' + stiffness u = 0, as a matrix on (u, v, v_dot, a)."""
    alpha_m, alpha_f, beta, gamma = scheme.alpha_m, scheme.alpha_f, scheme.beta, scheme.gamma
    new = np.array(
        [
            [1, 0, 0, -beta],
            [0, 1, 0, -gamma],
            [stiffness, 0, inertia, 0],
            [0, 0, 1 - alpha_f, alpha_m - 1],
        ]
    )
    old = np.array(
        [[1, 1, 0, 0.5 - beta], [0, 1, 0, 1 - gamma], [0, 0, 0, 0], [0, 0, -alpha_f, alpha_m]]
    )
    return float(np.abs(np.linalg.eigvals(np.linalg.solve(new, old))).max())


def test_the_parameters_for_rho_inf_one_half():
    scheme = GeneralizedAlpha(0.5)
    found = (scheme.alpha_m, scheme.alpha_f, scheme.gamma, scheme.beta)
    assert found == pytest.approx((0.0, 1 / 3, 5 / 6, 4 / 9), rel=1e-15)


@pytest.mark.parametrize("rho_inf", RHO_INF)
def test_high_frequencies_shrink_by_rho_inf_a_step(rho_inf):
    # The roots without inertia are multiple, so rounding moves them by its square root.
    found = spectral_radius(GeneralizedAlpha(rho_inf), inertia=0.0, stiffness=1.0)
    assert found == pytest.approx(rho_inf, abs=1e-7)


@pytest.mark.parametrize("rho_inf", RHO_INF)
def test_no_frequency_grows(rho_inf):
    radii = [
        spectral_radius(GeneralizedAlpha(rho_inf), 1.0, omega**2)
        for omega in np.geomspace(1e-2, 1e3, 200)
    ]
    assert max(radii) <= 1.0 + 1e-12


@pytest.mark.parametrize("rho_inf", RHO_INF)
def test_tangent_factors_are_the_derivatives_of_a_step(rho_inf):
    scheme, h = GeneralizedAlpha(rho_inf), 1e-3
    # From q = beta h^2 a, v = gamma h a and (1 - alpha_m) a = (1 - alpha_f) v_dot, per unit of a.
    q, v, v_dot = scheme.beta * h * h, scheme.gamma * h, (1 - scheme.alpha_m) / (1 - scheme.alpha_f)
    assert scheme.beta_prime(h) == pytest.approx(v_dot / q, rel=1e-14)
    assert scheme.gamma_prime(h) == pytest.approx(v / q, rel=1e-14)


@pytest.mark.parametrize("rho_inf", [-0.1, 1.1, float("nan")])
def test_rho_inf_outside_the_unit_interval_is_refused(rho_inf):
    with pytest.raises(ValueError, match=r"rho_inf must lie in \[0, 1\], got"):
        GeneralizedAlpha(rho_inf)
