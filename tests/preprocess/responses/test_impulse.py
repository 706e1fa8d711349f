"""Impulse responses: two methods against each other, their limits, and damping."""

import numpy as np
import pytest
from duhamel.preprocess import MethodError, assemble, build
from duhamel.preprocess.body.body import Damping
from duhamel.preprocess.responses.damping import damping_ratios
from duhamel.preprocess.responses.march import march_kernel
from duhamel.preprocess.responses.modal import elastic_shapes
from duhamel.preprocess.responses.static import accelerance, compliance
from duhamel.superelement import GeneralizedAlpha, sample_kernel

PAPER = {"step": 6e-5, "steps": 5000, "rho_inf": 0.9}


def difference(a, b):
    """Largest difference over all lags, relative to sqrt(max |g_ii| max |g_jj|)."""
    scale = np.sqrt(np.abs(np.diagonal(b, axis1=1, axis2=2)).max(axis=0))
    return (np.abs(a - b) / np.outer(scale, scale)).max()


def assert_methods_agree(body, h, scheme, steps):
    structure = assemble(body)
    marched = march_kernel(structure, body.damping, h, scheme, steps)
    sampled = sample_kernel(elastic_shapes(structure, body.damping)[0], h, scheme, steps)
    assert difference(marched.g, sampled.g) < 1e-9
    assert difference(marched.g_initial, sampled.g_initial) < 1e-9


def test_march_and_modes_agree_on_the_papers_beam(beam_body, beam):
    assert_methods_agree(beam_body(beam(10)), 6e-5, GeneralizedAlpha(0.9), 5000)


@pytest.mark.parametrize("rho_inf", [0.0, 0.5, 1.0])
def test_march_and_modes_agree_with_rayleigh_damping(beam_body, beam, rho_inf):
    body = beam_body(beam(6), damping={"rayleigh": {"mass": 20.0, "stiffness": 1e-6}})
    assert_methods_agree(body, 6e-5, GeneralizedAlpha(rho_inf), 1000)


def test_march_and_modes_agree_on_solids(solid_body, box, kind):
    interfaces = {
        "root": {"group": "root", "kind": "rigid"},
        "tip": {"group": "tip"},
        "edge": {"node": [0.5, 0.2, 0]},
    }
    body = solid_body(box(kind, size=(0.5, 0.2, 0.1), divisions=(2, 1, 1)), interfaces=interfaces)
    assert_methods_agree(body, 2e-5, GeneralizedAlpha(0.8), 300)


def test_the_first_lag_is_the_compliance_of_one_step(beam_body, beam):
    """g[0] = beta h^2 P_C S^-1 P^T P_C^T, and g_initial starts from zero."""
    structure, h, scheme = assemble(beam_body(beam(4))), 1e-4, GeneralizedAlpha(0.7)
    kernel = march_kernel(structure, Damping(), h, scheme, 1)
    M, K = structure.M.toarray(), structure.K.toarray()
    S = (1 - scheme.alpha_m) / (1 - scheme.alpha_f) * M + scheme.beta * h**2 * K
    P = np.eye(len(M)) - structure.U @ structure.U.T @ M
    P_C = structure.P_C.toarray()
    expected = scheme.beta * h**2 * P_C @ np.linalg.solve(S, P.T @ P_C.T)
    assert difference(kernel.g[:1], expected[None]) < 1e-10
    assert np.abs(kernel.g_initial[0]).max() == 0.0
    # half the acceleration of the initial triangle remains after one step of a vanishing length
    tiny = march_kernel(structure, Damping(), 1e-10, scheme, 1)
    share = (
        0.5 - scheme.beta + scheme.beta * (scheme.alpha_f - scheme.alpha_m) / (1 - scheme.alpha_m)
    )
    assert difference(tiny.g_initial[1:], (share * 1e-20 * accelerance(structure))[None]) < 1e-8


def test_a_damped_kernel_adds_up_to_the_static_compliance(beam_body, beam):
    """lim z -> 1 of G(z) is the response to a load that lasts."""
    body = beam_body(beam(6), impulse=PAPER | {"rho_inf": 0.5}, damping={"modal": 0.2})
    element = build(body)
    assert difference(element.kernel.g.sum(axis=0)[None], element.compliance[None]) < 1e-8


def test_ratios_over_frequency_are_linear_between_and_constant_outside():
    damping = Damping.model_validate(
        {"modal": {"frequencies": [100.0, 200.0], "ratios": [0.01, 0.03]}}
    )
    omega = 2 * np.pi * np.array([10.0, 100.0, 150.0, 200.0, 1e5])
    np.testing.assert_allclose(
        damping_ratios(damping, omega), [0.01, 0.01, 0.02, 0.03, 0.03], rtol=1e-14
    )
    assert (damping_ratios(Damping.model_validate({"modal": 0.02}), omega) == 0.02).all()
    assert (damping_ratios(Damping(), omega) == 0.0).all()
    rayleigh = Damping.model_validate({"rayleigh": {"mass": 3.0, "stiffness": 1e-5}})
    np.testing.assert_allclose(
        damping_ratios(rayleigh, omega), 1.5 / omega + 5e-6 * omega, rtol=1e-14
    )


def test_modes_are_complete(solid_body, box, kind):
    """As many as unknowns less six, mass-normalized: phi phi^T is the accelerance, phi omega^-2
    phi^T the compliance.
    """
    structure = assemble(solid_body(box(kind, divisions=(2, 1, 1))))
    modes = elastic_shapes(structure, Damping())[0]
    assert modes.phi.shape == (12, structure.n_u - 6)
    assert difference((modes.phi @ modes.phi.T)[None], accelerance(structure)[None]) < 1e-10
    assert (
        difference(((modes.phi / modes.omega**2) @ modes.phi.T)[None], compliance(structure)[None])
        < 1e-9
    )


def test_auto_takes_all_modes_of_small_bodies_and_krylov_for_others(beam_body, beam, monkeypatch):
    body = beam_body(beam(3))
    by_modes = build(body)
    monkeypatch.setattr("duhamel.preprocess.responses.impulse.FULL_MODAL_UNKNOWNS", 23)
    by_krylov = build(body)
    assert (by_modes.provenance.method, by_krylov.provenance.method) == ("modal", "krylov")
    assert (by_modes.kernel.band, by_krylov.kernel.band) == (None, 2500.0)
    assert (by_modes.modes.h_min, by_krylov.modes.h_min) == (0.0, 1e-4)
    assert difference(by_krylov.kernel.g, by_modes.kernel.g) < 1e-9


def test_methods_say_what_they_cannot_do(beam_body, beam, monkeypatch):
    with pytest.raises(MethodError, match=r"march takes no modal damping.*damping.rayleigh"):
        build(beam_body(beam(3), impulse=PAPER | {"method": "march"}, damping={"modal": 0.01}))
    monkeypatch.setattr("duhamel.preprocess.responses.modal.MODAL_LIMIT", 23)
    with pytest.raises(
        MethodError, match="modal takes up to 23 unknowns, found 24: use method krylov"
    ):
        build(beam_body(beam(3), impulse=PAPER | {"method": "modal"}))
