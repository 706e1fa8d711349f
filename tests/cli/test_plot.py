"""`duhamel plot`: where the picture goes, what a panel is, and how it fails."""

import matplotlib.image
import pytest
from duhamel.cli import app
from duhamel.solver import FlexibleBody, Model, Settings, Start, simulate
from duhamel.view import panels


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
    expected = "attribute format: expected 'duhamel-results', found 'duhamel-superelement'"
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
