"""Chains of Maxwell elements: in time steps, in closed form, in files, and in their motions."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.superelement import (
    Chain,
    GeneralizedAlpha,
    Modes,
    SuperelementError,
    check,
    read,
    respond,
    sample_kernel,
    stressed,
    write,
)
from duhamel.superelement.checks import powers_of_two
from duhamel.superelement.poles import motions
from duhamel.superelement.transfer import summed, transfer

TAU = (1e-5, 1e-3, 1e-1)
COMMON = Chain(np.array(TAU), np.array([0.3, 0.02, 0.1]))


def chained(chain=COMMON, zeta=0.01, m=4):
    rng = np.random.default_rng(0)
    return Modes(np.geomspace(50.0, 4e4, m), np.full(m, zeta), rng.normal(size=(3, m)), chain=chain)


OF_EACH = Chain(np.array(TAU), np.random.default_rng(1).random((3, 4)))


@pytest.mark.parametrize("chain", [COMMON, OF_EACH], ids=["common", "of each mode"])
@pytest.mark.parametrize("rho_inf", [0.0, 0.9, 1.0])
def test_stepping_squaring_and_the_closed_form_give_the_same_kernel(chain, rho_inf):
    modes, scheme, h, steps = chained(chain), GeneralizedAlpha(rho_inf), 1e-3, 3000
    kernel = sample_kernel(modes, h, scheme, steps)
    lags, impulse, initial = powers_of_two(modes, h, scheme, steps)
    for found, coefficients in ((kernel.g, impulse), (kernel.g_initial, initial)):
        expected = np.einsum("im,km,jm->kij", modes.phi, coefficients, modes.phi)
        assert np.abs(found[lags] - expected).max() < 1e-12 * np.abs(expected).max()
    delay = np.exp(-28 / steps - 1j * np.linspace(0, 3, 40))
    difference = summed(kernel, delay) - transfer(modes, h, scheme, delay)
    assert np.abs(difference).max() < 1e-12 * modes.compliance.max()


def test_a_step_is_of_second_order():
    """Of the response to a load that begins, which is a sum of known motions."""
    modes, t = chained(zeta=0.0, m=1), 0.05
    s, r = motions(modes)
    exact = float((r / s * (np.exp(s * t) - 1.0)).sum().real)
    errors = []
    for n in (400, 800, 1600):
        h, scheme = t / n, GeneralizedAlpha(0.8)
        etas = list(respond(modes, h, scheme, [1.0] * n, eta=0.0, acceleration=1.0))
        errors.append(abs(etas[-1][0] - exact))
    assert 1.8 < np.log2(errors[0] / errors[1]) < 2.2
    assert 1.8 < np.log2(errors[1] / errors[2]) < 2.2


def test_a_load_that_lasts_meets_the_relaxed_stiffness():
    modes = chained(zeta=0.1)
    h, n = 2e-3, 4000
    eta, stress = list(stressed(modes, h, GeneralizedAlpha(0.5), [1.0] * n))[-1]
    np.testing.assert_allclose(eta, 1.0 / modes.omega**2, rtol=1e-9)
    np.testing.assert_allclose(stress, eta, rtol=1e-9)


def test_a_fast_load_meets_the_stiffness_with_all_springs():
    """Stresses follow loads whatever the time, where inertia is none."""
    chain = Chain(np.array([1.0, 100.0]), np.array([0.5, 1.0]))
    modes = Modes(np.array([1e5]), np.array([0.5]), np.ones((1, 1)), chain=chain)
    eta, stress = list(stressed(modes, 1e-4, GeneralizedAlpha(0.0), [1.0] * 40))[-1]
    np.testing.assert_allclose(1e10 * stress, 1.0, rtol=1e-3)
    np.testing.assert_allclose(1e10 * eta, 1.0 / 2.5, rtol=2e-3)


@pytest.mark.parametrize("rho_inf", [0.0, 0.5, 0.9, 1.0])
@pytest.mark.parametrize("h_over_tau", [1e-3, 1.0, 1e4])
def test_no_step_creates_energy(rho_inf, h_over_tau):
    """The real part of velocity per load is positive wherever the delay is inside the circle."""
    chain = Chain(np.array([1.0 / h_over_tau, 2.0 / h_over_tau]), np.array([2.0, 0.5]))
    modes = Modes(np.array([0.01, 1.0, 100.0]), np.zeros(3), np.ones((1, 3)), chain=chain)
    scheme = GeneralizedAlpha(rho_inf)
    delay = 0.999 * np.exp(1j * np.linspace(0.0, np.pi, 400))
    _, chi = scheme.symbols(1.0, delay)
    velocity = chi * transfer(modes, 1.0, scheme, delay)[:, 0, 0]
    assert velocity.real.min() > 0.0


def test_motions_make_the_stiffness_vanish():
    modes = chained(OF_EACH)
    s, residues = motions(modes)
    a = OF_EACH.amplitudes(4)
    c = 1.0 + sum(a[k][:, None] * s * tau / (1.0 + s * tau) for k, tau in enumerate(TAU))
    damping, stiffness = 2.0 * modes.zeta * modes.omega, modes.omega**2
    left = s**2 + damping[:, None] * s + stiffness[:, None] * c
    # What Newton's method would change, with the residue as the inverse of the slope.
    assert np.abs(left * residues / s).max() < 1e-9
    assert (s.real < 0.0).all()


def test_a_chain_in_a_file(make_element, tmp_path):
    element = make_element(0)
    m = len(element.modes.omega)
    for amplitude in (np.array([0.1, 0.2]), np.full((2, m), 0.1)):
        chain = Chain(np.array([1e-3, 1e-2]), amplitude, 0.02, (10.0, 4e3), 200.0, 0.01)
        modes = replace(element.modes, chain=chain)
        old = element.kernel
        kernel = sample_kernel(modes, old.h, old.scheme, old.steps)
        write(tmp_path / "body.h5", replace(element, modes=modes, kernel=kernel))
        found = read(tmp_path / "body.h5")
        assert all(fact.holds for fact in check(found))
        np.testing.assert_array_equal(found.modes.chain.tau, chain.tau)
        np.testing.assert_array_equal(found.modes.chain.amplitude, chain.amplitude)
        assert (found.modes.chain.band, found.modes.chain.reference) == ((10.0, 4e3), 200.0)


@pytest.mark.parametrize(
    ("tau", "amplitude", "message"),
    [
        ([1e-3, 1e-3], [0.1, 0.1], r"chain: tau: expected positive times that increase"),
        ([], [], r"chain: tau: expected positive times that increase, found \[\]"),
        ([1e-3], [-0.1], r"chain: amplitude: expected numbers >= 0 .* found -0.1"),
        ([1e-3], [0.1, 0.1], r"chain: amplitude: expected shape \(1,\), found \(2,\)"),
    ],
)
def test_a_chain_that_is_none(tau, amplitude, message):
    with pytest.raises(SuperelementError, match=message):
        Chain(np.array(tau), np.array(amplitude))


def test_amplitudes_of_other_modes_are_refused():
    with pytest.raises(SuperelementError, match=r"modes: chain: expected amplitudes of 3 modes"):
        Modes(np.ones(3), np.zeros(3), np.ones((1, 3)), chain=OF_EACH)
