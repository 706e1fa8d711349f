"""Loss factors of materials: their fit, and the same chain by every method."""

import numpy as np
import pytest
from duhamel.preprocess import Body, assemble, build, mesh_of
from duhamel.preprocess.assembly.losses import lossy_parts
from duhamel.preprocess.body.damping import Damping
from duhamel.preprocess.body.loss import fits_of, scaled
from duhamel.preprocess.responses.damping import damping_ratios
from duhamel.preprocess.sources.reading import read_source
from duhamel.superelement import GeneralizedAlpha, check
from duhamel.superelement.transfer import transfer

from ..blocks import named

LOSS = {"loss_factor": 0.05, "band": (10.0, 4000.0)}
SHORT = {"step": 6e-5, "steps": 300, "rho_inf": 0.8}


def difference(a, b):
    scale = np.sqrt(np.abs(np.diagonal(b, axis1=1, axis2=2)).max(axis=0))
    return (np.abs(a - b) / np.outer(scale, scale)).max()


@pytest.mark.parametrize("loss", [1e-4, 0.02, 0.3])
@pytest.mark.parametrize("band", [(10.0, 4000.0), (1.0, 3.0), (1.0, 1e5)])
def test_the_loss_factor_is_constant_over_the_band_to_the_stated_ripple(loss, band):
    chain = Damping.model_validate({"loss_factor": loss, "band": band}).chain
    c = chain.factor(2 * np.pi * np.geomspace(*band, 2000), 1)[:, 0]
    found = np.abs(c.imag / c.real / loss - 1.0).max()
    assert found <= 0.02
    assert found == pytest.approx(chain.ripple, rel=0.05)
    assert len(chain.tau) <= 3 + 2 * np.log10(band[1] / band[0])


def test_the_modulus_of_the_file_is_that_at_rest_unless_a_frequency_is_given(beam_body, beam):
    plain, lossy = assemble(beam_body(beam(3))), assemble(beam_body(beam(3), damping=LOSS))
    np.testing.assert_array_equal(lossy.K.toarray(), plain.K.toarray())


@pytest.mark.parametrize("reference", [200.0, 10.0, 0.0])
def test_the_modulus_is_that_of_the_file_at_the_reference_frequency(beam_body, beam, reference):
    damping = {**LOSS, "reference_frequency": reference}
    plain, lossy = beam_body(beam(3)), beam_body(beam(3), damping=damping)
    c = lossy.damping.chain.factor(np.array([2 * np.pi * reference]), 1)[0, 0].real
    K, expected = assemble(lossy).K.toarray(), assemble(plain).K.toarray()
    np.testing.assert_allclose(c * K, expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max())


def test_march_and_modes_agree_on_a_lossy_beam(beam_body, beam):
    marched, modal = (
        build(beam_body(beam(4), damping=LOSS, impulse={**SHORT, "method": method}))
        for method in ("march", "modal")
    )
    assert difference(marched.kernel.g, modal.kernel.g) < 1e-9
    assert difference(marched.kernel.g_initial, modal.kernel.g_initial) < 1e-9


def test_krylov_keeps_to_its_error_on_a_lossy_solid(solid_body, box):
    mesh = box("hexahedron", size=(0.5, 0.1, 0.1), divisions=(16, 2, 2))
    impulse = {"step": 2e-5, "steps": 300, "tolerance": 1e-4}
    krylov, modal = (
        build(solid_body(mesh, damping=LOSS, impulse={**impulse, "method": method}))
        if method == "krylov"
        else build(solid_body(mesh, damping=LOSS, impulse={"step": 2e-5, "steps": 300}))
        for method in ("krylov", "auto")
    )
    assert 0 < len(krylov.modes.omega) < len(modal.modes.omega)
    delay = np.exp(-1 / 300 - 2j * np.pi * 2e-5 * np.linspace(0.0, 12.5e3, 60))
    found, expected = (
        transfer(body.modes, 2e-5, GeneralizedAlpha(0.9), delay) for body in (krylov, modal)
    )
    assert difference(found, expected) < krylov.kernel.error <= 1e-4
    assert all(fact.holds for fact in check(krylov))


@pytest.mark.parametrize("method", ["rubin", "craig-bampton"])
def test_truncated_modes_have_the_chain(beam_body, beam, method):
    body = beam_body(beam(8), damping=LOSS, impulse={**SHORT, "method": method, "modes": 6})
    element = build(body)
    np.testing.assert_array_equal(element.modes.chain.tau, body.damping.chain.tau)
    inside = element.modes.frequencies < 2000.0
    assert inside.sum() >= 4
    np.testing.assert_allclose(element.modes.loss_factors[inside], 0.05, rtol=0.02)


def test_one_material_may_say_its_loss_itself(beam_body, beam, section):
    own = beam_body(beam(3), {**section, "loss_factor": 0.05}, damping={"band": LOSS["band"]})
    common = beam_body(beam(3), damping=LOSS)
    np.testing.assert_array_equal(build(own).kernel.g, build(common).kernel.g)


def two_sections(beam_body, lines, section, inner, outer):
    """Half of the beam of one section, half of another, with the same stiffness."""
    mesh = lines(np.linspace(0.0, 0.5, 7)[:, None] * [1.0, 0.0, 0.0])
    halves = [
        ("inner", "line", [[0, 1], [1, 2], [2, 3]]),
        ("outer", "line", [[3, 4], [4, 5], [5, 6]]),
    ]
    ends = [("root", "vertex", [[0]]), ("tip", "vertex", [[6]])]
    sections = {
        "inner": {**section, "loss_factor": inner},
        "outer": {**section, "loss_factor": outer},
    }
    return beam_body(
        named(mesh.points, [*ends, *halves]),
        None,
        sections=sections,
        damping={"band": LOSS["band"], "reference_frequency": 0.0},
    )


def test_materials_of_different_loss_damp_modes_by_their_strain_energy(beam_body, lines, section):
    """Against the complex frequencies of the whole mesh, K_1 c_1 + K_2 c_2, to the second order in
    the losses.
    """
    body = two_sections(beam_body, lines, section, 0.005, 0.02)
    element, K = build(body), assemble(body).K.toarray()
    M = assemble(body).M.toarray()
    stiffer = assemble(scaled(body, {"outer": 2.0})).K.toarray() - K
    modes, fits = element.modes, fits_of(body)
    found = modes.loss_factors
    for i in range(8):
        omega = modes.resonances[i]
        c = [_factor(fits[name], omega) for name in ("inner", "outer")]
        square = np.linalg.eigvals(np.linalg.solve(M, (K - stiffer) * c[0] + stiffer * c[1]))
        nearest = square[np.argmin(np.abs(np.sqrt(square).real - omega))]
        assert found[i] == pytest.approx(nearest.imag / nearest.real, rel=0.04)
        assert 0.006 < found[i] < 0.018
    assert element.modes.chain.amplitude.shape == (len(fits["outer"].tau), len(modes.omega))


def test_parts_of_one_material_each_are_what_twice_its_modulus_adds(beam_body, lines, section):
    body = two_sections(beam_body, lines, section, 0.005, 0.02)
    K, parts = assemble(body).K, lossy_parts(body, read_source(body))
    assert set(parts) == {"inner", "outer"}
    for name, part in parts.items():
        added = assemble(scaled(body, {name: 2.0})).K - K
        assert abs(part - added).max() < 1e-11 * abs(K).max()


def test_parts_of_a_sandwich_add_up_to_its_stiffness():
    """By Euler's theorem: its shear is in series, of the first degree in all moduli together."""
    faces, core = (
        {"thickness": 0.005, "material": "steel"},
        {"thickness": 0.01, "material": "resin"},
    )
    square = [[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0], [0, 0.1, 0]]
    body = Body.model_validate(
        {
            "name": "sandwich",
            "mesh": mesh_of((square, {"quad": [[0, 1, 2, 3]]})),
            "shell": {"plies": [faces, core, faces], "orientation": [1, 0, 0]},
            "materials": {
                "steel": {"E": 210e9, "nu": 0.3, "rho": 7850.0, "loss_factor": 1e-3},
                "resin": {"E": 2e10, "nu": 0.3, "rho": 1800.0, "loss_factor": 0.3},
            },
            "interfaces": {"corner": {"node": [0, 0, 0]}},
            "impulse": SHORT,
            "damping": {"band": LOSS["band"]},
        }
    )
    K, parts = assemble(body).K.toarray(), lossy_parts(body, read_source(body))
    total = sum(part.toarray() for part in parts.values())
    # Deflections alone, which shear resists.
    across = np.ix_([2, 8, 14, 20], [2, 8, 14, 20])
    assert np.abs(total - K)[across].max() < 1e-6 * np.abs(K[across]).max()


def _factor(found, omega):
    x = 1j * omega * found.tau
    return 1.0 + (x / (1.0 + x)) @ found.amplitude


def test_materials_of_the_same_loss_have_a_common_chain(beam_body, lines, section):
    element = build(two_sections(beam_body, lines, section, 0.05, 0.05))
    whole = build(two_sections(beam_body, lines, section, 0.05, 0.05 * (1 + 1e-9)))
    assert element.modes.chain.amplitude.ndim == 1
    assert whole.modes.chain.amplitude.ndim == 2
    np.testing.assert_allclose(
        whole.modes.chain.amplitude, np.outer(element.modes.chain.amplitude, np.ones(36)), rtol=1e-6
    )
    assert difference(whole.kernel.g, element.kernel.g) < 1e-6


def test_march_takes_one_loss_factor(beam_body, lines, section):
    body = two_sections(beam_body, lines, section, 0.005, 0.02)
    march = {"impulse": {**SHORT, "method": "march"}}
    with pytest.raises(ValueError, match="march takes one loss factor for all materials, found 2"):
        Body.model_validate({**body.model_dump(exclude_unset=True), **march})


def rayleigh(frequencies, ratios):
    return Damping.model_validate(
        {"rayleigh": {"frequencies": tuple(frequencies), "ratios": tuple(ratios)}}
    )


def test_rayleigh_has_the_ratios_at_two_frequencies():
    damping = rayleigh([50.0, 400.0], [0.01, 0.02])
    omega = 2 * np.pi * np.array([50.0, 400.0])
    np.testing.assert_allclose(damping_ratios(damping, omega), [0.01, 0.02], rtol=1e-13)
    only_mass = rayleigh([50.0, 100.0], [0.02, 0.01])
    assert only_mass.rayleigh.coefficients[1] == pytest.approx(0.0, abs=1e-18)
