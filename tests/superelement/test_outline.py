"""Outlines: figures enclose what they should, and files keep them."""

from dataclasses import replace

import h5py
import numpy as np
import pytest
from duhamel.superelement import Outline, SuperelementError, check, read, write
from duhamel.superelement.figures import box, cylinder, sphere

TILTED = np.array([0.0, 0.6, 0.8])


def test_figures_enclose_their_volumes():
    assert box([1.0, 2.0, 3.0], center=[5.0, 0.0, 0.0]).volume == pytest.approx(6.0)
    assert cylinder(0.5, 2.0, TILTED).volume == pytest.approx(0.5 * np.pi, rel=0.01)
    assert sphere(0.5, center=[1.0, 2.0, 3.0]).volume == pytest.approx(np.pi / 6.0, rel=0.02)


@pytest.mark.parametrize("figure", [box([1, 2, 3]), cylinder(0.5, 2.0, TILTED), sphere(1.0)])
def test_every_edge_of_a_figure_has_a_facet_on_each_side(figure):
    a, b, c = figure.triangles.T
    edges = np.concatenate([np.stack(pair, axis=1) for pair in ((a, b), (b, c), (c, a))])
    there, back = ({tuple(edge) for edge in way.tolist()} for way in (edges, edges[:, ::-1]))
    assert there == back
    assert len(there) == len(edges)


@pytest.mark.parametrize("corners", [3, 4, 6, 8, 9])
def test_a_facet_of_any_type_is_cut_into_triangles_of_its_area(corners):
    triangle = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.5, 0, 0], [0.5, 0.5, 0], [0, 0.5, 0]]
    square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0, 0], [1, 0.5, 0], [0.5, 1, 0]]
    square += [[0, 0.5, 0], [0.5, 0.5, 0]]
    points = np.array((triangle if corners in (3, 6) else square)[:corners], dtype=float)
    a, b, c = points[Outline(points, [range(corners)]).triangles].transpose(1, 0, 2)
    areas = 0.5 * np.cross(b - a, c - a)[:, 2]
    assert (areas > 0.0).all()
    assert areas.sum() == pytest.approx(0.5 if corners in (3, 6) else 1.0)


def test_a_cell_of_another_number_of_points_is_refused():
    with pytest.raises(SuperelementError, match="expected 2, 3, 4, 6, 8 or 9 points each, found 5"):
        Outline(np.zeros((5, 3)), [[0, 1, 2, 3, 4]])


def test_a_file_keeps_an_outline_of_beams(make_element, tmp_path):
    points = np.random.default_rng(1).normal(size=(8, 3))
    outline = Outline(points, [[0, 1, 5, 4], [0, 1, 2, -1]], [0, 0, 0, 0, 1, 1, 1, 1])
    write(tmp_path / "body.h5", replace(make_element(), outline=outline))
    again = read(tmp_path / "body.h5", recovery=False).outline
    for name in ("points", "cells", "node"):
        np.testing.assert_array_equal(getattr(again, name), getattr(outline, name))


def test_points_that_are_those_of_the_recovery_are_written_once(make_element, tmp_path):
    element = make_element()
    outline = Outline(element.recovery.points, element.recovery.cells)
    write(tmp_path / "body.h5", replace(element, outline=outline))
    with h5py.File(tmp_path / "body.h5") as file:
        assert file["outline/points"] == file["recovery/points"]
        assert file["outline/cells"] == file["recovery/cells"]
    np.testing.assert_array_equal(read(tmp_path / "body.h5").outline.points, outline.points)


def test_files_before_version_5_have_no_outline(make_element, tmp_path):
    write(tmp_path / "body.h5", replace(make_element(), outline=box([1.0, 1.0, 1.0])))
    with h5py.File(tmp_path / "body.h5", "a") as file:
        file.attrs["version"] = 4
    assert read(tmp_path / "body.h5").outline is None


def test_an_open_surface_fails_its_check(make_element):
    whole = box([1.0, 1.0, 1.0])
    for outline, closed in ((whole, True), (Outline(whole.points, whole.cells[1:]), False)):
        checks = check(replace(make_element(), outline=outline))
        assert [c.holds for c in checks if c.where == "outline/cells"] == [closed]
