"""Pictures of spectra: what stands on their axes, and the four coordinates of shock."""

import numpy as np
import pytest
from duhamel import view
from duhamel.results import Results

TIP = "acceleration:beam.tip:x"


@pytest.fixture
def results(results_file):
    return Results.read(results_file)


def panel(results, *quantities, gravities=False):
    made = [curve for text in quantities for curve in view.curves(results, text, gravities)]
    (axes,) = view.draw(results.time, [made]).axes
    return axes


def test_a_shock_spectrum_has_its_words_on_the_axes(results):
    axes = panel(results, f"srs({TIP}, q=25)", f"srs({TIP}, q=5)")
    assert axes.get_xlabel() == "natural frequency [Hz]"
    assert axes.get_ylabel() == "absolute acceleration [m/s²]"
    assert axes.get_title("left") == ("beam tip, acceleration along x, shock response spectrum")
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["Q = 25", "Q = 5"]
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")


def test_accelerations_in_g_take_no_prefix(results):
    """kg would be a mass."""
    axes = panel(results, TIP, gravities=True)
    assert axes.get_ylabel() == "[g]"
    (curve,) = view.curves(results, TIP)
    np.testing.assert_allclose(axes.lines[0].get_ydata(), curve.values / 9.80665, rtol=1e-12)


def test_a_filtered_series_is_drawn_over_its_time_beside_the_series(results):
    axes = panel(results, TIP, f"lowpass({TIP}, 20)")
    assert axes.get_xlabel() == "time [s]"
    assert [text.get_text() for text in axes.get_legend().get_texts()] == [
        "unfiltered",
        "below 20 Hz",
    ]


def test_four_coordinate_paper_is_ruled_in_accelerations_and_displacements(results):
    """v = a / (2 pi f) falls by a decade in a decade, v = 2 pi f d rises."""
    axes = panel(results, f"srs({TIP}, pseudo-velocity)")
    assert axes.get_ylabel() == "pseudo-velocity [m/s]"
    slopes = []
    for line in axes.lines[1:]:
        f, v = np.log10(line.get_xdata()), np.log10(line.get_ydata())
        slopes.append((v[-1] - v[0]) / (f[-1] - f[0]))
    assert {round(slope, 9) for slope in slopes} == {-1.0, 1.0}
    for text in axes.texts:
        number, unit = text.get_text().split()
        f, v = text.get_position()
        found = v * 2 * np.pi * f / 9.80665 if unit == "g" else v / (2 * np.pi * f) * 1e3
        assert found == pytest.approx(float(number), rel=1e-9)
    assert {text.get_text().split()[1] for text in axes.texts} == {"g", "mm"}


def test_bands_are_levels_from_edge_to_edge(results):
    axes = panel(results, f"octaves({TIP}, 3)")
    assert axes.get_ylabel() == "RMS in the band [m/s²]"
    (stairs,) = axes.patches
    edges = stairs.get_data().edges
    np.testing.assert_allclose(edges[1:] / edges[:-1], 10**0.1, rtol=1e-9)
    (curve,) = view.curves(results, f"octaves({TIP}, 3)")
    np.testing.assert_array_equal(stairs.get_data().values, curve.values)


def test_spectra_stand_below_series_each_with_its_abscissa(results):
    contents = [view.curves(results, text) for text in (TIP, f"psd({TIP})", TIP)]
    first, second, third = view.draw(results.time, contents).axes
    labels = [axes.get_xlabel() for axes in (first, second, third)]
    assert labels == ["time [s]", "frequency [Hz]", "time [s]"]
    assert second.get_ylabel() == "[(m/s²)²/Hz]"
    assert first.get_xlim() != second.get_xlim()


def test_a_spectrum_of_nothing_is_drawn(results):
    axes = panel(results, "srs(acceleration:disc:x)")
    assert axes.get_yscale() == "linear"


def test_a_panel_has_one_paper(results):
    with pytest.raises(view.PictureError, match="expected curves over time or of one kind of spec"):
        panel(results, TIP, f"srs({TIP})")
