"""Several runs in one picture, windows, stars, and one quantity against another."""

import shutil
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from duhamel import view
from duhamel.results import Results
from duhamel.results.transforms import series

from ..results.disc import TIME, TRAVEL


@pytest.fixture
def results(results_file):
    return Results.read(results_file)


@pytest.fixture
def runs(results_file):
    """The disc, and the same without its joint that ends at half the time."""
    short = results_file.with_name("short-results.h5")
    shutil.copy(results_file, short)
    with h5py.File(short, "a") as file:
        for name in list(file):
            if name.startswith("joint"):
                del file[name]
        for name, data in list(file.items()):
            if isinstance(data, h5py.Dataset) and data.shape[:1] == (len(TIME),):
                kept = data[:91]
                del file[name]
                file[name] = kept
        file["solver"].attrs["written"] = 91
    return view.runs_of([results_file, short])


def legend(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


@pytest.mark.parametrize(
    ("paths", "names"),
    [
        (["a/case1-results.h5", "a/case2-results.h5"], ["case1", "case2"]),
        (["a/case1-paper.h5", "a/case1-consistent.h5"], ["paper", "consistent"]),
        (["paper/results.h5", "trapezoidal/results.h5"], ["paper", "trapezoidal"]),
        (["s/case-0001/r.h5", "s/case-0012/r.h5"], ["case-0001", "case-0012"]),
        (["case1-results.h5", "case1-stiff-results.h5"], ["case1", "case1-stiff"]),
        (["a/run.h5", "a/run.nc"], ["run.h5", "run.nc"]),
        (["a/run.h5"], [""]),
    ],
)
def test_files_are_named_by_what_tells_them_apart(paths, names):
    assert view.names_of(list(map(Path, paths))) == names


def test_runs_of_other_lengths_are_drawn_over_their_own_times(runs):
    found = view.panel(runs, "elastic_displacement:beam.tip:x")
    (axes,) = view.draw(runs[0].results.time, [found]).axes
    assert legend(axes) == ["disc", "short"]
    for line, n in zip(axes.lines, (181, 91), strict=True):
        np.testing.assert_array_equal(line.get_xdata(), TIME[:n])
        np.testing.assert_allclose(line.get_ydata(), 1e3 * TRAVEL[:n, 0], rtol=1e-12)


def test_a_run_that_lacks_a_quantity_is_named_and_the_others_are_drawn(runs):
    with pytest.warns(view.PictureWarning, match=r"short-results.h5: force:clamp:x: no joint"):
        (curve,) = view.panel(runs, "force:clamp:x")
    assert curve.run == "disc"
    with pytest.raises(view.QuantityError, match=r"disc-results.h5: angle:hub:z: no body"):
        view.panel(runs, "angle:hub:z")


def test_names_are_one_for_each_file(results_file):
    with pytest.raises(view.PictureError, match="a name for each of 1 files, found 2"):
        view.runs_of([results_file], ["a", "b"])


def test_a_window_is_cut_before_anything_is_made_of_the_series(results):
    """The spectrum of a part is that of a run of that part alone."""
    text, rows = "fourier(acceleration:beam.tip:x)", slice(20, 121)
    whole = results.frame("beam.tip").acceleration[rows, 0]
    found = series(results, text, (TIME[20], TIME[120]))
    expected = np.abs(np.fft.rfft(whole))[1:]
    ratio = np.abs(found.values) / expected[: len(found.values)]
    np.testing.assert_allclose(ratio[:-1], ratio[0], rtol=1e-9)
    assert len(found.values) == len(expected)
    assert found.abscissa[0] == pytest.approx(1.0 / (101 * (TIME[1] - TIME[0])))


def test_both_ends_of_a_window_are_in_it(results):
    (curve,) = view.curves(results, "angle:disc:z", window=(0.1, 0.3))
    np.testing.assert_array_equal(curve.abscissa, TIME[20:61])
    whole = view.curves(results, "angle:disc:z")[0].values
    np.testing.assert_array_equal(curve.values, whole[20:61])


def test_a_window_outside_the_run(results):
    with pytest.raises(
        view.SeriesError, match=r"nothing was recorded from 2 to 3 s, expected times from 0 to 0.9"
    ):
        view.curves(results, "angle:disc:z", window=(2.0, 3.0))


def test_places_against_each_other_have_one_scale(results):
    text = "position:beam.tip:y against position:beam.tip:x"
    (curve,) = view.panel([view.Run("", results, "")], text)
    figure = view.draw(results.time, [[curve]])
    figure.draw_without_rendering()
    (axes,) = figure.axes
    assert axes.get_xlabel() == "beam tip, position along x [m]"
    assert axes.get_ylabel() == "beam tip, position along y [m]"
    corners = axes.transData.transform([[0.0, 0.0], [1.0, 1.0]])
    across, up = corners[1] - corners[0]
    assert up == pytest.approx(across)
    np.testing.assert_array_equal(
        axes.lines[0].get_ydata(), results.frame("beam.tip").position[:, 1]
    )


def test_a_phase_plane_has_a_unit_for_each_axis(results):
    (curve,) = view.curves(results, "angular_velocity:disc:z against angle:disc:z")
    (axes,) = view.draw(results.time, [[curve]]).axes
    assert axes.get_aspect() == "auto"
    assert axes.get_ylabel() == "disc, angular velocity about z [rad/s]"
    assert axes.get_xlabel() == "disc, angle about z [rad]"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("angle:disc against angle:disc:z", r"angle:disc: expected one number, with an axis: x\|y"),
        ("psd(angle:disc:z) against angle:disc:z", "expected a quantity over time, found a spec"),
        ("position:*:y against position:disc*:x", "stars that stand for the same on both sides"),
    ],
)
def test_what_cannot_be_drawn_against_another(results, text, message):
    with pytest.raises(view.QuantityError, match=message):
        view.panel([view.Run("", results, "")], text)


def test_stars_of_both_sides_stand_for_the_same(results):
    found = view.panel([view.Run("", results, "")], "position:*.*:y against position:*.*:x")
    assert [curve.words[1] for curve in found] == ["beam tip", "disc rim"]
    for curve, name in zip(found, ("beam.tip", "disc.rim"), strict=True):
        np.testing.assert_array_equal(curve.abscissa, results.frame(name).position[:, 0])


def test_a_star_for_too_many_draws_the_largest_and_says_so(results, monkeypatch):
    monkeypatch.setattr("duhamel.view.runs.MAX_STAR_CURVES", 2)
    with pytest.warns(view.PictureWarning, match=r"velocity:\*:x: stands for 4 curves, of which t"):
        found = view.panel([view.Run("", results, "")], "velocity:*:x")
    assert len(found) == 2
    assert "beam tip" in [curve.words[1] for curve in found]


def test_more_curves_than_colors_are_dashed(results):
    (curve,) = view.curves(results, "angle:disc:z")
    many = [replace(curve, words=("angle", f"body {n}", "z")) for n in range(8)]
    (axes,) = view.draw(results.time, [many]).axes
    looks = [(line.get_color(), line.get_linestyle()) for line in axes.lines]
    assert len(set(looks)) == 8


def test_of_several_runs_colors_are_quantities_and_dashes_are_runs(runs):
    found = view.panel(runs, "velocity:beam.tip:x,velocity:beam.tip:y")
    (axes,) = view.draw(runs[0].results.time, [found]).axes
    colors = [line.get_color() for line in axes.lines]
    dashes = [line.get_linestyle() for line in axes.lines]
    assert colors[0] == colors[1] != colors[2] == colors[3]
    assert dashes[0] == dashes[2] != dashes[1] == dashes[3]


def test_legends_are_within_the_picture(results):
    """However long their names."""
    (curve,) = view.curves(results, "angle:disc:z")
    panel = [replace(curve, words=("angle", f"{'a long name ' * n}{n}", "z")) for n in range(9)]
    figure = view.draw(results.time, [panel], "many")
    figure.draw_without_rendering()
    box = figure.axes[0].get_legend().get_window_extent()
    assert box.x1 <= figure.bbox.x1
    assert box.y0 >= figure.bbox.y0
