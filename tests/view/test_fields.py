"""Pictures of fields: facets of every type are covered by their triangles, and values find their
places.
"""

import numpy as np
import pytest
from duhamel import view
from duhamel.view.field_kinds import COLOR_MAP
from duhamel.view.fields import TRIANGLES_OF_FACET, _triangles

SQUARE = np.array(
    [(0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0), (1, 0.5), (0.5, 1), (0, 0.5), (0.5, 0.5)]
)
TRIANGLE = np.array([(0, 0), (1, 0), (0, 1), (0.5, 0), (0.5, 0.5), (0, 0.5)])


@pytest.mark.parametrize("n", TRIANGLES_OF_FACET)
def test_triangles_cover_a_facet_once_and_turn_as_it_does(n):
    """Areas are positive and add up; a linear field has its integral, and each triangle the value
    at its centroid.
    """
    flat = (TRIANGLE if n in (3, 6) else SQUARE)[:n]
    points = np.column_stack([flat, np.zeros(n)])
    cells = np.array([[*range(n), *[-1] * (9 - n)]])
    triangles, values = _triangles(
        view.Field(points, cells, 1.0 + 2.0 * flat[:, 0] + 3.0 * flat[:, 1])
    )
    a, b, c = triangles.transpose(1, 0, 2)
    areas = 0.5 * np.cross(b - a, c - a)[:, 2]
    middles = triangles.mean(axis=1)
    assert areas.min() > 0.0
    assert areas.sum() == pytest.approx(0.5 if n in (3, 6) else 1.0)
    np.testing.assert_allclose(values, 1.0 + 2.0 * middles[:, 0] + 3.0 * middles[:, 1], rtol=1e-12)


def test_facets_of_several_types_in_one_table():
    points = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0)], float)
    field = view.Field(
        points, np.array([[0, 1, 2, 3], [1, 4, 2, -1]]), np.array([0.0, 0.0, 0.0, 0.0, 6.0])
    )
    triangles, values = _triangles(field)
    a, b, c = triangles.transpose(1, 0, 2)
    areas = 0.5 * np.cross(b - a, c - a)[:, 2]
    assert areas.sum() == pytest.approx(1.5)
    assert (areas * values).sum() == pytest.approx(
        0.5 * 2.0
    )  # of the triangle alone: its area times 6 / 3


def test_largest_values_are_hot_and_the_bar_is_labelled():
    """The two ends of the scale of colors show on the two facets, and the bar ends at the largest
    value.
    """
    points = np.array(
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0), (2, 1, 0), (3, 0, 0), (3, 1, 0)],
        float,
    )
    cells = np.array([[0, 1, 2, 3], [4, 6, 7, 5]])
    field = view.Field(points, cells, np.repeat([0.0, 5e6], 4))
    figure = view.draw_fields([field], "stress [MPa]", 1e-6)
    *_, bar = figure.axes
    assert bar.get_xlim() == (0.0, 5.0)
    assert bar.get_title(loc="left") == "stress [MPa]"
    faces = figure.axes[0].collections[0].get_facecolors()[:, :3]
    hues = np.unique(np.round(faces / faces.max(axis=1, keepdims=True), 6), axis=0)
    ends = np.array([COLOR_MAP(end)[:3] for end in (0.0, 1.0)])
    np.testing.assert_allclose(hues, ends / ends.max(axis=1, keepdims=True), atol=1e-6)
