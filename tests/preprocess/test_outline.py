"""Outlines of bodies: the boundary of solids, lines swept by sections."""

import numpy as np
import pytest
from duhamel.preprocess import assemble, build
from duhamel.preprocess.outline import outline_of
from duhamel.preprocess.sources.reading import read_source
from duhamel.superelement import read, write


def outline(body):
    return outline_of(read_source(body), assemble(body).rigid.center)


def test_the_outline_of_solids_encloses_them(solid_body, box, kind):
    found = outline(solid_body(box(kind)))
    extent = np.prod(np.ptp(found.points, axis=0))
    assert found.volume == pytest.approx(extent, rel=1e-12)


def test_it_is_about_the_center_of_mass(solid_body, box):
    points = outline(solid_body(box("hexahedron"))).points
    np.testing.assert_allclose(points.min(axis=0), -points.max(axis=0), atol=1e-12)


def test_a_beam_is_swept_by_the_rectangle_of_its_stiffnesses(beam_body, beam, section):
    EA = 0.5
    stiffnesses = {"EA": EA, "EI_y": EA * 0.02**2 / 12.0, "EI_z": EA * 0.03**2 / 12.0}
    found = outline(beam_body(beam(5), section | stiffnesses))
    np.testing.assert_allclose(np.ptp(found.points, axis=0), [0.5, 0.03, 0.02], rtol=1e-12)
    assert found.volume == pytest.approx(0.5 * 0.03 * 0.02, rel=1e-12)
    assert len(found.points) == 4 * 6
    assert np.bincount(found.node).tolist() == [4] * 6


def test_a_beam_of_one_bending_stiffness_is_round(beam_body, beam, section):
    EA = 0.5
    EI = EA * 0.01**2 / 4.0
    found = outline(beam_body(beam(5), section | {"EA": EA, "EI_y": EI, "EI_z": EI}))
    away = np.linalg.norm(found.points[:, 1:], axis=1)
    np.testing.assert_allclose(away, 0.01, rtol=1e-12)
    assert found.volume == pytest.approx(0.5 * np.pi * 0.01**2, rel=0.05)


def test_branches_are_closed_each(beam_body, lines, section):
    """Three bars that meet in a node."""
    points = [[0, 0, 0], [0.2, 0, 0], [0.4, 0, 0], [0.2, 0.3, 0]]
    EA = 0.5
    stiffnesses = {"EA": EA, "EI_y": EA * 0.02**2 / 12.0, "EI_z": EA * 0.03**2 / 12.0}
    body = beam_body(lines(points, [[0, 1], [1, 2], [1, 3]]), section | stiffnesses)
    found = outline(body)
    assert found.volume == pytest.approx(0.7 * 0.03 * 0.02, rel=1e-12)


def test_sections_out_of_all_proportion_are_drawn_to_be_seen(beam_body, beam, section):
    found = outline(beam_body(beam(2), section | {"EA": 1.0, "EI_y": 1e6, "EI_z": 1e-12}))
    _, y, z = np.ptp(found.points, axis=0)
    assert y == pytest.approx(0.5e-3)
    assert z == pytest.approx(0.25)


def test_the_middle_of_a_section_is_its_node(beam_body, beam):
    body = beam_body(beam(3), recovery={})
    element = build(body)
    found, recovery = element.outline, element.recovery
    np.testing.assert_allclose(found.anchors, recovery.points[found.node], atol=1e-15)
    assert found.fits(recovery)


def test_rotations_of_nodes_are_the_slopes_of_their_deflections(beam_body, beam, tmp_path):
    """Of the first modes of a fine mesh, by differences of the deflection."""
    write(tmp_path / "beam.h5", build(beam_body(beam(40), recovery={})))
    recovery = read(tmp_path / "beam.h5").recovery
    x, first = recovery.points[:, 0], recovery.phi[..., :4]
    slopes = np.gradient(first, x, axis=0)
    turns = recovery.phi_rotation[..., :4]
    expected = np.stack([-slopes[:, 2], slopes[:, 1]], axis=1)
    difference = np.abs(turns[2:-2, 1:] - expected[2:-2]).max()
    assert difference < 0.01 * np.abs(turns).max()


def test_a_solid_has_no_rotations(solid_body, box):
    assert build(solid_body(box("hexahedron"), recovery={})).recovery.phi_rotation is None
