"""What is found before impulse responses are computed: frequencies against the mesh's own, shares,
wavelengths.
"""

import numpy as np
import pytest
from duhamel.preprocess import assemble
from duhamel.preprocess.estimate import SPLINES_PER_COMPONENT, first_frequencies, ritz_frequencies
from duhamel.preprocess.responses.damping import Damping
from duhamel.preprocess.responses.modal import elastic_shapes
from duhamel.preprocess.survey import survey


def frequencies(structure):
    """Of the mesh, from all of its modes."""
    modes, _ = elastic_shapes(structure, Damping())
    return np.sort(modes.frequencies)


BODIES = {
    "bar": (((1.0, 0.05, 0.04), (16, 1, 1)), {}, 1e-3),
    "plate": (((0.5, 0.4, 0.02), (6, 5, 1)), {}, 1e-2),
    "block": (((0.3, 0.2, 0.2), (5, 3, 3)), {}, 3e-3),
    "bar with rigid ends": (((1.0, 0.05, 0.04), (16, 1, 1)), {"kind": "rigid"}, 1e-3),
}


@pytest.mark.parametrize("name", BODIES)
def test_ritz_frequencies_are_close_upper_bounds(solid_body, box, name):
    """Of the mesh's; the first six within the fraction given."""
    (size, divisions), change, within = BODIES[name]
    interfaces = {end: {"group": end, **change} for end in ("root", "tip")}
    structure = assemble(
        solid_body(box("hexahedron20", size=size, divisions=divisions), interfaces=interfaces)
    )
    true = frequencies(structure)
    error = ritz_frequencies(structure, SPLINES_PER_COMPONENT)[:6] / true[:6] - 1.0
    assert error.min() > -1e-6  # the mesh's own frequencies carry rounding
    assert error.max() < within


def test_more_splines_lower_the_bounds(solid_body, box):
    """Along the bar the grids are nested: 2, 4 and 8 cells by one by one, nine splines across."""
    structure = assemble(
        solid_body(box("hexahedron", size=(1.0, 0.05, 0.04), divisions=(32, 2, 2)))
    )
    bounds = np.array([ritz_frequencies(structure, 9 * (cells + 2))[:6] for cells in (2, 4, 8)])
    assert (np.diff(bounds, axis=0) < 0.0).all()


def test_frequencies_of_beams_and_of_small_solids_are_those_of_the_mesh(
    beam_body, solid_body, beam, box
):
    for structure in (
        assemble(beam_body(beam(12))),
        assemble(solid_body(box("hexahedron20", divisions=(3, 2, 2)))),
    ):
        found = first_frequencies(structure, 8)
        assert found.exact
        np.testing.assert_allclose(found.values, frequencies(structure)[:8], rtol=1e-6)


def test_two_nodes_have_as_many_frequencies_as_there_are(beam_body, beam):
    structure = assemble(beam_body(beam(1)))
    np.testing.assert_allclose(
        first_frequencies(structure, 10).values, frequencies(structure)[:5], rtol=1e-6
    )


def test_shares_add_up_to_the_mass(solid_body, box, kind):
    found = survey(
        solid_body(
            box(kind, size=(2.0, 1.0, 0.5)), masses={"lump": {"interface": "tip", "mass": 5.0}}
        )
    )
    (share,) = found.shares
    assert share.elements == found.mesh.n_elements
    assert share.extent == pytest.approx(1.0, rel=1e-12)
    assert share.mass + 5.0 == pytest.approx(found.structure.rigid.mass, rel=1e-12)
    assert found.masses["lump"] is found.interfaces["tip"]
    assert found.interfaces["tip"].area == pytest.approx(0.5, rel=1e-12)


def test_shares_by_group(beam_body, lines, section):
    mesh = lines([[0, 0, 0], [1, 0, 0], [3, 0, 0]])
    found = survey(beam_body(mesh, section=None, sections={"beam": section}))
    assert [(share.group, share.elements, share.extent) for share in found.shares] == [
        ("beam", 2, 3.0)
    ]
    assert found.shares[0].mass == pytest.approx(3.0 * 0.0858, rel=1e-12)


@pytest.mark.parametrize(
    ("kind", "between", "needed"), [("hexahedron", 0.5, 6), ("hexahedron20", 0.25, 4)]
)
def test_resolution_of_shear_waves(solid_body, box, kind, between, needed):
    """c = sqrt(E / 2 (1 + nu) rho) at 1 / (4 h); the longest edge of the box is 0.5 m."""
    found = survey(solid_body(box(kind, size=(1.0, 0.5, 0.5))))
    speed = np.sqrt(2.1e11 / 2.6 / 7800.0)
    assert found.band == 2500.0
    assert found.resolution.wavelength == pytest.approx(speed / 2500.0, rel=1e-12)
    assert found.resolution.spacing == pytest.approx(between, rel=1e-12)
    assert found.resolution.needed == needed


def test_resolution_of_bending_waves(beam_body, beam):
    """omega = sqrt(EI / mass) k^2"""
    found = survey(beam_body(beam(5)))
    k = 2.0 * np.pi / found.resolution.wavelength
    assert np.sqrt(5.5 / 0.0858) * k**2 == pytest.approx(2.0 * np.pi * 2500.0, rel=1e-12)
    assert found.resolution.spacing == pytest.approx(0.1, rel=1e-12)


def test_the_boundary_is_closed_and_turned_outwards(solid_body, box, kind):
    """Its area vectors add up to nothing, and 1/3 of the sum of x . n dA is the volume; the ends
    are marked.
    """
    found = survey(solid_body(box(kind, size=(2.0, 1.0, 0.5))))
    total, volume, ends = np.zeros(3), 0.0, np.zeros(2)
    for polygons, owners in found.boundary():
        areas = 0.5 * np.cross(polygons, np.roll(polygons, -1, axis=1)).sum(axis=1)
        total += areas.sum(axis=0)
        volume += (areas * polygons.mean(axis=1)).sum() / 3.0
        ends += [areas[owners == number, 0].sum() for number in (0, 1)]
    np.testing.assert_allclose(total, 0.0, atol=1e-13)
    assert volume == pytest.approx(1.0, rel=1e-12)
    np.testing.assert_allclose(ends, [-0.5, 0.5], rtol=1e-12)


def test_truncated_modes_cost_what_they_are_measured_by(solid_body, box):
    body = solid_body(box("hexahedron20", divisions=(6, 4, 3)))
    assert survey(body).structure.n_u > 1000
    cost = survey(body).cost
    assert survey(body.with_modes("rubin", 8)).cost == cost
    march = body.impulse.model_copy(update={"method": "march"})
    assert survey(body.model_copy(update={"impulse": march})).cost is None
