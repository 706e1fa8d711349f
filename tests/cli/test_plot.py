"""`duhamel plot`: where the picture goes, what a panel is, and how it fails."""

from dataclasses import replace

import matplotlib.image
import numpy as np
import pytest
from duhamel.cli import app
from duhamel.cli.commands.plot import _with_overlays
from duhamel.results import peaks
from duhamel.solver import (
    FlexibleBody,
    Force,
    Harmonic,
    Model,
    Settings,
    Start,
    simulate,
)
from duhamel.view import curves, draw, panel, panels, runs_of


@pytest.fixture
def results_file(element, tmp_path):
    """A free body made by hand, in steady motion."""
    target = tmp_path / "flight-results.h5"
    simulate(
        Model(
            {"beam": FlexibleBody(element, Start(velocity=[2.0, 0.0, 0.0]))},
            settings=Settings(t_end=0.01),
        ),
        output=target,
    )
    return target


def height(picture):
    return matplotlib.image.imread(picture).shape[0]


def test_the_picture_stands_beside_the_results(runner, results_file):
    result = runner.invoke(app, ["plot", str(results_file)])
    assert result.exit_code == 0, result.output
    target = results_file.with_suffix(".png")
    assert result.stdout.splitlines() == [str(target)]
    assert target.exists()


def test_an_argument_is_a_panel_and_a_comma_joins_curves(runner, results_file):
    target = results_file.with_name("picture.png")
    result = runner.invoke(
        app,
        [
            "plot",
            str(results_file),
            "velocity:beam:x,velocity:beam:y",
            "energy:kinetic",
            "-o",
            str(target),
        ],
    )
    assert result.exit_code == 0, result.output
    figure, _ = panels(2)
    assert height(target) == int(figure.get_figheight() * 110)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["velocity:hub"], "velocity:hub: no body or frame 'hub'; there are: beam"),
        (["velocity:beam,energy:work"], "expected curves of one unit in a panel"),
        (["-o", "picture.xyz"], "picture.xyz: expected a suffix of"),
    ],
)
def test_an_error_is_one_line_on_stderr_and_nothing_is_written(
    runner, results_file, arguments, message
):
    result = runner.invoke(app, ["plot", str(results_file), *arguments])
    assert result.exit_code == 1
    assert result.stderr.startswith("error: ")
    assert message in result.stderr
    assert result.stderr.count("\n") == 1
    assert not list(results_file.parent.glob("*.png"))


def test_commas_within_brackets_join_no_curves(runner, results_file):
    target = results_file.with_name("spectrum.png")
    panel = "srs(acceleration:beam:x, q=5, pseudo-velocity)"
    result = runner.invoke(app, ["plot", str(results_file), panel, "--g", "-o", str(target)])
    assert result.exit_code == 0, result.output
    assert target.exists()


def test_what_cannot_be_made_of_a_quantity_is_one_line_on_stderr(runner, results_file):
    result = runner.invoke(app, ["plot", str(results_file), "cfc(acceleration:beam:x, 1000)"])
    assert result.exit_code == 1
    assert result.stderr.startswith("error: cfc(acceleration:beam:x, 1000): CFC 1000: expected 100")
    assert result.stderr.count("\n") == 1


def test_peaks_are_a_table(runner, results_file):
    result = runner.invoke(app, ["peaks", str(results_file), "velocity:*", "--g"])
    assert result.exit_code == 0, result.output
    rows = [line.split() for line in result.stdout.splitlines()]
    assert ["velocity:beam:x", "m/s", "2", "0", "s", "2", "0", "s"] in rows
    assert ["|velocity:beam|", "m/s", "2", "0", "s", "2", "0", "s"] in rows
    failed = runner.invoke(app, ["peaks", str(results_file), "velocity:hub"])
    assert failed.exit_code == 1
    assert failed.stderr.startswith("error: velocity:hub: no body or frame 'hub'")


def test_a_file_without_results_is_one_line_on_stderr(runner, element_file):
    result = runner.invoke(app, ["plot", str(element_file)])
    assert result.exit_code == 1
    expected = "expected results of a run, found a superelement"
    assert expected in result.stderr
    assert result.stderr.count("\n") == 1


def test_a_title_in_words_takes_the_place_of_the_name_of_the_file(runner, results_file):
    pictures = {}
    for name, title in {"named": [], "titled": ["--title", "A body in flight"]}.items():
        target = results_file.with_name(f"{name}.svg")
        result = runner.invoke(
            app, ["plot", str(results_file), "velocity:beam:x", *title, "-o", str(target)]
        )
        assert result.exit_code == 0, result.output
        pictures[name] = target.read_text()
    assert "<!-- flight-results -->" in pictures["named"]
    assert "<!-- A body in flight -->" in pictures["titled"]
    assert "flight-results" not in pictures["titled"]


@pytest.fixture
def others(results_file):
    """The same run by other names."""
    copies = [results_file.with_name(f"flight-{name}-results.h5") for name in ("light", "heavy")]
    for copy in copies:
        copy.write_bytes(results_file.read_bytes())
    return copies


def svg(runner, target, *arguments):
    result = runner.invoke(app, ["plot", *map(str, arguments), "-o", str(target)])
    assert result.exit_code == 0, result.output
    return target.read_text(), result.stderr


def test_several_files_are_drawn_in_one_picture(runner, others, tmp_path):
    one, two = others
    text, _ = svg(runner, tmp_path / "both.svg", one, "velocity:beam:x", two)
    assert "<!-- light -->" in text
    assert "<!-- heavy -->" in text
    text, _ = svg(runner, tmp_path / "named.svg", one, two, "velocity:beam:x", "--names", "A 1,B")
    assert "<!-- A 1 -->" in text
    assert "light" not in text


def test_of_several_files_the_picture_has_its_own_name(runner, others):
    result = runner.invoke(app, ["plot", *map(str, others), "velocity:*:x"])
    assert result.exit_code == 0, result.output
    assert result.stdout.strip() == str(others[0].with_name("flight-light-results-compared.png"))


def test_the_default_picture_is_of_several_files_too(runner, others, tmp_path):
    text, warnings = svg(runner, tmp_path / "both.svg", *others)
    assert "<!-- energy balance -->" in text
    assert warnings == ""


@pytest.mark.parametrize("to", ["--to", "--until"])
def test_a_window_and_one_quantity_against_another(runner, results_file, tmp_path, to):
    panel = "position:beam:y against position:beam:x"
    window = ["--from", "0.002", to, "0.004"]
    text, _ = svg(runner, tmp_path / "way.svg", results_file, panel, *window)
    assert "<!-- beam, position along x [mm] -->" in text


def test_the_size_is_in_inches(runner, results_file, tmp_path):
    text, _ = svg(runner, tmp_path / "wide.svg", results_file, "--size", "10x9")
    assert 'width="720pt" height="648pt"' in text


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--from", "3", "--to", "2"], "expected --from below --to, found 3.0 and 2.0"),
        (["--from", "nan"], "expected --from below --to"),
        (["--size", "8"], "expected WIDTHxHEIGHT from 1 to 100 inches"),
        (["--size", "nanx3"], "expected WIDTHxHEIGHT"),
        (["--at", "0.1"], "--at goes with --field"),
        (["--field", "von_mises:beam", "--at", "nan"], "expected a time [s] or worst"),
        (["--field", "von_mises:beam", "velocity:beam"], "expected one file, no quantities"),
        (["--field", "von_mises:beam", "--size", "8x5"], "no quantities and no --size"),
        (["summary.csv"], "drawn alone, without other files"),
    ],
)
def test_options_that_cannot_be(runner, results_file, arguments, message):
    result = runner.invoke(app, ["plot", str(results_file), *arguments])
    assert result.exit_code == 2
    words = " ".join(result.stderr.replace("│", " ").split())
    assert message in words


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--from", "3"], "nothing was recorded from 3 s, expected times from 0 to 0.01 s"),
        (["--size", "3x1"], "3x1 inches are too small for its panels and legends"),
        (["--field", "von_mises:beam"], "body 'beam': "),
        (["--field", "von_mises:hub"], "von_mises:hub: no flexible body 'hub'; there are: beam"),
        (["absent.h5", "velocity:beam"], "absent.h5: no such file"),
        (["velocity:*.x"], "velocity:*.x: found no velocity:*.x"),
    ],
)
def test_what_cannot_be_drawn_is_one_line(runner, results_file, arguments, message):
    result = runner.invoke(app, ["plot", str(results_file), *arguments])
    assert result.exit_code == 1, result.output
    assert message in result.stderr
    assert result.stderr.count("\n") == 1
    assert not list(results_file.parent.glob("*.png"))


def panels_with(run, quantities, overlays, window=None):
    panels = [panel([run], text, window=window) for text in quantities]
    return _with_overlays(panels, overlays, window)


def test_measured_columns_are_drawn_beside_the_run(results_file, tmp_path):
    """As they are in the file, cut by the window, under their names."""
    rows = "t,speed,drift\n0,1.5,2\n0.004,2.5,2\n0.02,9,9\n"
    (tmp_path / "rig.csv").write_text(rows)
    (run,) = runs_of([results_file])
    curves = panels_with(run, ["velocity:beam:x"], [str(tmp_path / "rig.csv")], (0.0, 0.01))
    assert [curve.run for curve in curves[0]] == ["simulated", "rig.csv"]
    measured = curves[0][1]
    np.testing.assert_array_equal(measured.abscissa, [0.0, 0.004])
    np.testing.assert_array_equal(measured.values, [1.5, 2.5])
    assert (measured.unit, measured.words) == (curves[0][0].unit, curves[0][0].words)
    both = [f"{tmp_path / 'rig.csv'}:drift", f"{tmp_path / 'rig.csv'}:2"]
    two = panels_with(run, ["velocity:beam:x", "velocity:beam"], both)
    assert [panel[-1].run for panel in two] == ["rig.csv, drift", "rig.csv, 2"]
    assert [panel[-1].values[0] for panel in two] == [2.0, 1.5]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--overlay", "rig.csv"], "--overlay: expected quantities"),
        (
            ["velocity:beam:x", "velocity:beam:y", "--overlay", "rig.csv"],
            "expected one panel, or one for each of 2 panels, found 1",
        ),
        (["velocity:beam:x", "--overlay", "rig.csv:load"], "no column 'load'; there are: 't', 'v'"),
        (["velocity:beam:x", "--overlay", "gone.csv"], "gone.csv: not a readable file"),
        (
            ["position:beam:x against position:beam:y", "--overlay", "rig.csv"],
            "expected a panel over time or frequency",
        ),
    ],
)
def test_what_cannot_be_overlaid_is_refused(
    runner, results_file, tmp_path, monkeypatch, arguments, message
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rig.csv").write_text("t,v\n0,1\n1,2\n")
    result = runner.invoke(app, ["plot", str(results_file), *arguments])
    assert result.exit_code != 0
    assert message in " ".join(result.stderr.replace("│", " ").split())
    assert not results_file.with_suffix(".png").exists()


def test_a_picture_has_the_measured_curve(runner, results_file, tmp_path):
    (tmp_path / "rig.csv").write_text("0 1\n0.005 2\n")
    result = runner.invoke(
        app, ["plot", str(results_file), "velocity:beam:x", "--overlay", str(tmp_path / "rig.csv")]
    )
    assert result.exit_code == 0, result.output
    assert results_file.with_suffix(".png").exists()


def test_spectra_beyond_the_band_of_a_superelement_are_marked(runner, element, tmp_path):
    """In the table of peaks, and in the picture from the band on."""
    banded = replace(element, kernel=replace(element.kernel, band=40.0))
    push = Force("beam.tip", [1, 2, 3], Harmonic(1.0, 300.0))
    model = Model({"beam": FlexibleBody(banded)}, loads=[push], settings=Settings(t_end=0.05))
    file = tmp_path / "shaken.h5"
    results = simulate(model, output=file)
    assert results.bands == {"beam": 40.0}
    asked = "srs(acceleration:beam.tip:z, from=10, to=200)"
    (peak,) = peaks(results, [asked])
    assert peak.at_largest > 40.0
    told = runner.invoke(app, ["peaks", str(file), asked, "acceleration:beam.tip:z"])
    assert f"{peak.at_largest:.5g} Hz*" in told.stdout
    assert "* beyond the band of the superelement, 40 Hz" in told.stdout
    assert told.stdout.count("*") == 2
    (axes,) = draw(results.time, [curves(results, asked)]).axes
    (shade,) = axes.patches
    assert shade.get_x() == 40.0
    (curve,) = curves(results, asked.replace("to=200", "to=40"))
    (axes,) = draw(results.time, [[replace(curve, band=39.6)]]).axes
    assert curve.abscissa[-1] < 39.6 < axes.get_xlim()[1]
    assert not axes.patches
    assert not axes.texts
