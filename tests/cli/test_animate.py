"""`duhamel animate`: where the film goes, what is told, and how it fails."""

from dataclasses import replace

import pytest
from duhamel.cli import app
from duhamel.cli.arguments import beside, size_of
from duhamel.cli.commands.animate import told
from duhamel.results import Results
from duhamel.solver import FlexibleBody, Model, Settings, Start, simulate
from duhamel.view import Film, animate
from PIL import Image

TINY = ["--size", "160x90"]


@pytest.fixture
def results_file(element, tmp_path):
    """A free body made by hand, in steady motion."""
    target = tmp_path / "flight results.h5"
    simulate(
        Model(
            {"beam": FlexibleBody(element, Start(velocity=[2.0, 0.0, 0.0]))},
            settings=Settings(t_end=0.01),
        ),
        output=target,
    )
    return target


def test_the_film_stands_beside_the_results(runner, results_file):
    result = runner.invoke(app, ["animate", str(results_file), *TINY, "--frames", "3"])
    assert result.exit_code == 0, result.output
    target = results_file.with_suffix(".mp4")
    assert result.stdout.startswith(f"{target}: 3 frames, 0.12 s long, ")
    assert target.stat().st_size > 0


def test_the_end_of_the_scale_is_told_with_what_it_is_the_largest_of():
    many = Film(3, 0.1, 1.0, "von_mises", 3.494e6, 3.494e6)
    assert told(many).endswith("colors up to 3.49 MPa, the largest of all frames")
    assert told(replace(many, frames=1)).endswith("3.49 MPa, the largest of this time")
    assert "colors" not in told(replace(many, field=""))
    for limit, shown in ((2e6, "2 MPa"), (5e6, "5 MPa")):
        assert told(replace(many, limit=limit)).endswith(f"colors up to {shown}, a given limit")


def test_at_a_time_it_is_a_picture(runner, results_file):
    result = runner.invoke(app, ["animate", str(results_file), *TINY, "--at", "worst"])
    assert result.exit_code == 0, result.output
    with Image.open(beside(results_file, ".png", "frame")) as picture:
        assert picture.size == (160, 90)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--at", "worst", "--frames", "3"], "--frames, --fps and --seconds"),
        (["--at", "worst", "--fps", "25"], "--frames, --fps and --seconds"),
        (["--at", "0.01", "--from", "0"], "--from and --to go with --at worst"),
    ],
)
def test_what_a_picture_would_pass_over_is_refused(runner, results_file, options, message):
    result = runner.invoke(app, ["animate", str(results_file), *options])
    assert result.exit_code == 2
    assert message in " ".join(result.stderr.split())


def test_a_field_that_is_unknown_is_an_error_of_one_line(runner, results_file):
    result = runner.invoke(app, ["animate", str(results_file), "--field", "von_mises"])
    assert result.exit_code == 1
    assert result.stderr.startswith("error: --field von_mises: body 'beam'")
    assert len(result.stderr.splitlines()) == 1


def test_the_results_are_not_overwritten(runner, results_file):
    named = results_file.rename(results_file.with_suffix(".mp4"))
    before = named.read_bytes()
    result = runner.invoke(app, ["animate", str(named)])
    assert result.exit_code == 1
    assert "is the results file, which the film would replace" in result.stderr
    assert named.read_bytes() == before


@pytest.mark.parametrize("to", ["--to", "--until"])
def test_a_part_of_the_time_that_is_not_there_is_refused(runner, results_file, to):
    answer = runner.invoke(app, ["animate", str(results_file), "--from", "2", to, "1"])
    assert answer.exit_code == 1
    assert "No such option" not in answer.stderr


def test_sizes_are_numbers():
    assert size_of("1280x720", int, 1, 2000, "pixels") == (1280, 720)


def test_a_picture_of_a_time_leaves_the_plot_beside_the_results(runner, results_file):
    plotted = runner.invoke(app, ["plot", str(results_file)])
    before = results_file.with_suffix(".png").read_bytes()
    shot = runner.invoke(app, ["animate", str(results_file), *TINY, "--at", "worst"])
    assert (plotted.exit_code, shot.exit_code) == (0, 0)
    assert results_file.with_suffix(".png").read_bytes() == before


@pytest.mark.parametrize("size", ["1280", "x", "1280x-2", "axb"])
def test_other_sizes_are_refused(runner, results_file, size):
    result = runner.invoke(app, ["animate", str(results_file), "--size", size])
    assert result.exit_code == 2
    assert "expected WIDTHxHEIGHT" in result.stderr


def test_what_a_film_leaves_out_is_told_before_its_first_frame(results_file, tmp_path, monkeypatch):
    told_at = []
    monkeypatch.setattr("duhamel.view.space.film._shoot", lambda *_: 1 / 0)
    monkeypatch.setattr(
        "duhamel.view.space.stage.unknown", lambda *_: {"beam": "body 'beam': no stress modes"}
    )
    with pytest.raises(ZeroDivisionError):
        animate(Results.read(results_file), tmp_path / "a.png", at=0.0, on_warning=told_at.append)
    assert "drawn without colors: body 'beam': no stress modes" in told_at
