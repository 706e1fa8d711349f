"""Scaled superelements beside rebuilds with other moduli, densities and losses."""

from dataclasses import replace
from types import SimpleNamespace

import duhamel as du
import numpy as np
import pytest
import skfem
from duhamel.superelement import MeasuredModes, SuperelementError, scaled, write
from duhamel.superelement.checks import require_sound
from duhamel.superelement.other_modes import ratios_at

from .observables import observables

E, RHO, STEP = 2e11, 7800.0, 1e-5
STIFFER, LIGHTER = 1.2, 0.9
HIGHER = np.sqrt(STIFFER / LIGHTER)
ROUNDING = 1e-8
"""of statics of slender bodies, relative to the largest entry of each array"""


def part(e=1.0, r=1.0):
    """A short cantilever of 12 hexahedra."""
    x, y, z = np.linspace(0, 0.4, 4), np.linspace(0, 0.05, 3), np.linspace(0, 0.07, 3)
    mesh = skfem.MeshHex.init_tensor(x, y, z)
    made = du.Part(mesh, du.Material(E=e * E, nu=0.3, rho=r * RHO), name="block")
    made.interface("root", du.plane(x=0.0))
    made.interface("tip", du.plane(x=0.4))
    return made


def beam(e=1.0, r=1.0):
    section = du.Section.rectangle(
        du.Material(E=e * E, nu=0.3, rho=r * RHO), 0.02, 0.01, orientation=(0.0, 1.0, 0.0)
    )
    made = du.Beam(np.linspace([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], 5), section=section, name="beam")
    made.interface("root", (0.0, 0.0, 0.0))
    made.interface("tip", (1.0, 0.0, 0.0))
    return made


def assert_same(found, expected, rtol=ROUNDING):
    found, expected = observables(found), observables(expected)
    assert found.keys() == expected.keys()
    for key, value in expected.items():
        size = np.abs(value).max(initial=0.0)
        np.testing.assert_allclose(found[key], value, rtol=rtol, atol=rtol * size, err_msg=key)


def rich(e, r):
    made = part(e, r)
    made.sensor("motion", (0.2, 0.0, 0.0))
    made.sensor("gauge", (0.2, 0.0, 0.0), direction=(1.0, 0.0, 0.0))
    made.sensor("stress", (0.2, 0.0, 0.0), stress=True)
    made.load("pressure", du.plane(z=0.07), pressure=1.0)
    made.rotation(modes=3, level=2)
    made.recover(stress=True)
    return made.superelement(step=STEP, duration=100 * STEP, method="modal")


def test_every_array_of_a_scaled_solid_is_that_of_a_rebuild():
    found = scaled(rich(1.0, 1.0), stiffness=STIFFER, density=LIGHTER)
    assert_same(found, rich(STIFFER, LIGHTER))


def test_loads_on_surfaces_bend_a_scaled_body_as_a_rebuild():
    def made(e, r):
        one = part(e, r)
        one.surface("top", du.plane(z=0.07))
        one.recover(stress=True)
        return one.superelement(step=STEP, duration=100 * STEP, band=3e3)

    def fields(element):
        """At rest: by the modes, and what they leave, however many they are."""
        surfaces, recovery = element.surfaces, element.recovery
        load = np.random.default_rng(0).normal(size=len(surfaces.H))
        eta = surfaces.phi.T @ load / element.modes.omega**2
        yield surfaces.H
        yield recovery.phi @ eta + recovery.rest.displacement @ load
        yield recovery.stress @ eta + recovery.rest.stress @ load

    found = scaled(made(1.0, 1.0), stiffness=STIFFER, density=LIGHTER)
    expected = made(STIFFER, LIGHTER)
    # Recovered rests are rounded to multiples of 1e-5 of their largest value.
    for one, other, rtol in zip(fields(found), fields(expected), (1e-9, 3e-5, 3e-5), strict=True):
        np.testing.assert_allclose(one, other, rtol=0.0, atol=rtol * np.abs(other).max())


def test_modes_of_a_band_are_those_of_a_rebuild_with_a_band_that_moves():
    def made(e, r, higher):
        return part(e, r).superelement(step=STEP / higher, duration=1e-3, method="krylov")

    found = scaled(made(1.0, 1.0, 1.0), stiffness=STIFFER, density=LIGHTER)
    expected = made(STIFFER, LIGHTER, HIGHER)
    assert len(found.modes.omega) == len(expected.modes.omega)
    np.testing.assert_allclose(found.modes.h_min, expected.modes.h_min, rtol=1e-12)
    np.testing.assert_allclose(found.band, expected.band, rtol=1e-12)
    # Beyond the band Ritz values are what rounding makes of them.
    within = found.modes.frequencies < found.band
    assert within.sum() > 10
    np.testing.assert_allclose(found.modes.omega[within], expected.modes.omega[within], rtol=1e-9)


DAMPINGS = {
    "modal": {"modal": 0.02},
    "rayleigh": {"rayleigh": {"mass": 3.0, "stiffness": 1e-6}},
    "stiffness": {"rayleigh": {"stiffness": 1e-6}},
    "two ratios": {"rayleigh": {"frequencies": (100.0, 1e3), "ratios": (0.01, 0.02)}},
    "loss": {"loss_factor": 0.1, "band": (50.0, 5e3)},
    "reference": {"loss_factor": 0.1, "band": (50.0, 5e3), "reference_frequency": 500.0},
}


def times(damping, d):
    """A damping, d times as strong."""
    if "rayleigh" in damping:
        given = damping["rayleigh"]
        return {
            "rayleigh": {
                k: v if k == "frequencies" else (d * np.array(v)).tolist() for k, v in given.items()
            }
        }
    return {key: d * x if key in ("modal", "loss_factor") else x for key, x in damping.items()}


@pytest.mark.parametrize("damping", DAMPINGS.values(), ids=DAMPINGS)
def test_damping_is_that_of_a_rebuild(damping):
    def made(e, r, d):
        one = beam(e, r)
        one.damping(**times(damping, d))
        return one.superelement(step=STEP, duration=1e-2)

    found = scaled(made(1.0, 1.0, 1.0), stiffness=STIFFER, density=LIGHTER, damping=1.1)
    assert_same(found, made(STIFFER, LIGHTER, 1.1))


def test_a_single_mode_with_rayleigh_damping_is_not_taken_for_one_ratio():
    made = beam()
    made.damping(rayleigh={"mass": 3.0, "stiffness": 1e-6})
    element = made.superelement(step=STEP, duration=1e-2)
    omega, zeta = element.modes.omega, element.modes.zeta
    first = SimpleNamespace(omega=omega[:1], zeta=zeta[:1])
    one = SimpleNamespace(modes=first, provenance=element.provenance, name="one")
    expected = 0.5 * (3.0 / (2.0 * omega[:1]) + 1e-6 * 2.0 * omega[:1])
    np.testing.assert_allclose(ratios_at(one, 2.0 * omega[:1]), expected, rtol=1e-12)


def test_ratios_over_frequency_are_read_at_the_new_frequencies(tmp_path):
    def made(e, r):
        body = beam(e, r).body(step=STEP, duration=1e-2)
        table = {"frequencies": [10.0, 1e4], "ratios": [0.01, 0.1]}
        damping = type(body.damping).model_validate({"modal": table})
        return du.preprocess.build(body.model_copy(update={"damping": damping}))

    assert_same(scaled(made(1.0, 1.0), stiffness=STIFFER), made(STIFFER, 1.0))
    unknown = made(1.0, 1.0)
    unknown = replace(unknown, provenance=replace(unknown.provenance, body="lost"))
    with pytest.raises(SuperelementError, match="beam differ from mode to mode"):
        scaled(unknown, stiffness=STIFFER)
    # Nothing moves, and nothing needs to be known.
    assert scaled(unknown, stiffness=2.0, density=2.0).modes.zeta.max() == unknown.modes.zeta.max()


def test_a_kernel_without_modes_scales_where_frequencies_stay():
    def made(e, r):
        one = part(e, r)
        one.sensor("stress", (0.2, 0.0, 0.0), stress=True)
        one.damping(rayleigh={"mass": 3.0, "stiffness": 1e-6})
        return one.superelement(step=STEP, duration=100 * STEP, method="march")

    assert_same(scaled(made(1.0, 1.0), stiffness=1.2, density=1.2), made(1.2, 1.2))
    with pytest.raises(SuperelementError, match="stiffness: block has no modes"):
        scaled(made(1.0, 1.0), stiffness=1.2)
    with pytest.raises(SuperelementError, match="damping: block has no modes"):
        scaled(made(1.0, 1.0), damping=1.2)


def test_a_scaled_superelement_has_a_whole_kernel_for_runs():
    base = beam().superelement(step=STEP, duration=1e-2)
    expected = beam(STIFFER, LIGHTER).superelement(step=STEP, duration=1e-2).kernel
    kernel = scaled(base, stiffness=STIFFER, density=LIGHTER).kernel_for(
        expected.h, expected.scheme, expected.steps
    )
    np.testing.assert_allclose(kernel.g, expected.g, atol=1e-9 * np.abs(expected.g).max())


def test_factors_multiply_and_give_the_base_back():
    base = beam().superelement(step=STEP, duration=1e-2)
    twice = scaled(scaled(base, stiffness=2.0), stiffness=3.0, damping=2.0)
    assert twice.variation.scale == {"stiffness": 6.0, "density": 1.0, "damping": 2.0}
    assert twice.base is base
    assert scaled(scaled(base, density=2.0), density=0.5) is base


def test_a_scaled_superelement_is_sound():
    one = scaled(rich(1.0, 1.0), stiffness=STIFFER, density=LIGHTER)
    assert "scale.stiffness = 1.2, scale.density = 0.9" in one.provenance.method
    require_sound(one)


def test_only_the_base_is_written(tmp_path):
    one = scaled(beam().superelement(step=STEP, duration=1e-2), stiffness=2.0)
    with pytest.raises(SuperelementError, match=r"by scale\.stiffness = 2, .*write its base"):
        write(one, tmp_path / "scaled.h5")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("factor", [0.0, -1.0, np.nan, np.inf])
def test_factors_are_positive(factor):
    base = beam().superelement(step=STEP, duration=1e-2)
    with pytest.raises(SuperelementError, match="scale: density: expected a positive number"):
        scaled(base, density=factor)


def test_point_masses_have_no_density():
    one = beam()
    one.mass("nut", 0.1, interface="tip")
    base = one.superelement(step=STEP, duration=1e-2)
    with pytest.raises(SuperelementError, match=r"scale: density: beam has point masses \(nut\)"):
        scaled(base, density=2.0)
    assert scaled(base, stiffness=4.0).modes.omega[0] == pytest.approx(2.0 * base.modes.omega[0])


def test_parts_of_a_test_are_refused():
    base = beam().superelement(step=STEP, duration=1e-2)
    one = np.ones(1)
    updated = replace(base, measured=MeasuredModes(one, one, one, one, one))
    with pytest.raises(SuperelementError, match="beam has modes of a test"):
        scaled(updated, stiffness=2.0)
    tested = replace(base, provenance=replace(base.provenance, method="measured with 3 hits"))
    with pytest.raises(SuperelementError, match="beam has modes of a test"):
        scaled(tested, damping=2.0)


def test_loss_factors_of_several_materials_are_refused_and_those_above_one():
    one = beam()
    one.damping(loss_factor=0.5, band=(50.0, 5e3))
    base = one.superelement(step=STEP, duration=1e-2)
    with pytest.raises(SuperelementError, match=r"expected a loss factor up to 1, found 1\.5"):
        scaled(base, damping=3.0)
    several = replace(base.modes, chain=replace(base.modes.chain, loss_factor=0.0))
    with pytest.raises(SuperelementError, match="damping: materials of different loss factors"):
        scaled(replace(base, modes=several), damping=1.1)
    # All else scales: a chain keeps its times.
    stiffer = scaled(replace(base, modes=several), stiffness=2.0)
    assert stiffer.modes.chain is several.chain
