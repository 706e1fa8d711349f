"""Outputs of studies over their parameters: what is drawn, and where."""

import numpy as np
import pytest
from duhamel.view import PictureError, draw_variation
from duhamel.view.variation import rank_correlation
from scipy.stats import spearmanr


def lines(axes):
    return [np.array(line.get_data()) for line in axes.lines]


def test_one_parameter_is_a_line_in_the_order_of_its_values():
    figure = draw_variation({"m": [3, 1, 2], "k": [5, 5, 5]}, {"peak": np.array([9.0, 1.0, 4.0])})
    (axes,) = figure.axes
    assert lines(axes)[0].tolist() == [[1, 2, 3], [1, 4, 9]]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("m", "peak")


def test_a_case_without_a_number_is_left_out():
    figure = draw_variation({"m": [1, 2, 3]}, {"peak": np.array([1.0, np.nan, 4.0])})
    assert lines(figure.axes[0])[0].tolist() == [[1, 3], [1, 4]]


def test_of_two_parameters_the_one_with_fewer_values_tells_lines_apart():
    x, y = np.meshgrid([1, 2, 3], [10, 20], indexing="ij")
    figure = draw_variation({"x": list(x.flat), "y": list(y.flat)}, {"sum": (x + y).ravel()})
    drawn = lines(figure.axes[0])
    assert [line.tolist() for line in drawn] == [
        [[1, 2, 3], [11, 12, 13]],
        [[1, 2, 3], [21, 22, 23]],
    ]


def test_two_scattered_parameters_are_contours():
    x, y = np.random.default_rng(0).random((2, 40))
    figure = draw_variation({"x": list(x), "y": list(y)}, {"f": x * y})
    panel, bar = figure.axes
    assert (panel.get_xlabel(), panel.get_ylabel(), panel.get_title("left")) == ("x", "y", "f")
    low, high = bar.get_ylim()
    assert low <= (x * y).min()
    assert (x * y).max() <= high


def test_cases_on_one_line_are_points_for_want_of_a_plane():
    x = list(np.linspace(0, 1, 9))
    figure = draw_variation({"x": x, "y": x}, {"f": np.arange(9.0)})
    assert len(figure.axes[0].collections[0].get_offsets()) == 9


def test_of_many_parameters_the_strongest_stand_first():
    a = np.random.default_rng(0).random((50, 4))
    parameters = {f"p{i}": list(a[:, i]) for i in range(4)}
    figure = draw_variation(parameters, {"f": -3.0 * a[:, 2] ** 3 + 0.1 * a[:, 0]})
    assert figure.axes[0].get_xlabel() == "p2"
    assert len(figure.axes) == 4
    assert "rank correlation -" in figure.axes[0].get_title("left")


def test_of_arrays_the_element_that_varies_most_is_the_abscissa():
    inertia = [[1, 1, 2], [2, 2, 4], [3, 3, 6]]
    figure = draw_variation({"inertia": inertia}, {"f": np.arange(3.0)})
    assert figure.axes[0].get_xlabel() == "inertia[2]"
    assert lines(figure.axes[0])[0][0].tolist() == [2, 4, 6]


def test_text_is_named_at_the_axis():
    figure = draw_variation({"mesh": ["a.h5", "b.h5"]}, {"f": np.arange(2.0)})
    assert [text.get_text() for text in figure.axes[0].get_xticklabels()] == ["a.h5", "b.h5"]


@pytest.mark.parametrize(("values", "scale"), [([1, 10, 100], "log"), ([1, 50, 100], "linear")])
def test_values_that_grow_by_factors_have_a_logarithmic_axis(values, scale):
    figure = draw_variation({"k": values}, {"f": np.arange(3.0)})
    assert figure.axes[0].get_xscale() == scale


def test_rank_correlations_are_those_of_scipy():
    x, y = np.random.default_rng(1).integers(0, 6, (2, 30)).astype(float)
    assert rank_correlation(x, y) == pytest.approx(spearmanr(x, y).statistic, rel=1e-12)
    assert rank_correlation(np.ones(30), y) == 0.0


def test_nothing_that_varies_is_refused():
    with pytest.raises(PictureError, match="expected parameters that vary and outputs"):
        draw_variation({"m": [1, 1]}, {"f": np.arange(2.0)})


def test_cases_that_failed_are_crosses_and_units_stand_on_the_axis():
    figure = draw_variation(
        {"m": [3, 1, 2]}, {"peak": np.array([9.0, 1.0, 4.0])}, "", {"peak": "m/s²"}, {"m": [5, 4]}
    )
    (axes,) = figure.axes
    assert axes.get_ylabel() == "peak [m/s²]"
    line, crosses = axes.lines
    assert np.array(line.get_data()).tolist() == [[1, 2, 3], [1, 4, 9]]
    assert crosses.get_marker() == "x"
    assert list(crosses.get_xdata()) == [5, 4]
    assert [text.get_text() for text in axes.texts] == ["2 failed: x"]


def test_in_a_plane_of_two_parameters_crosses_are_at_their_place():
    x, y = np.random.default_rng(0).random((2, 40))
    failed = {"x": [0.5], "y": [0.25]}
    figure = draw_variation({"x": list(x), "y": list(y)}, {"f": x * y}, failed=failed)
    crosses = next(line for line in figure.axes[0].lines if line.get_marker() == "x")
    assert [list(crosses.get_xdata()), list(crosses.get_ydata())] == [[0.5], [0.25]]
