"""Outputs of what is made of quantities: parts, values at a time or frequency, spectra."""

import numpy as np
import pytest
from duhamel.results import SeriesError
from duhamel.solver import read_model, simulate
from duhamel.study import StudyError, read_study, sweep
from duhamel.study.outputs import check, values

from .conftest import STUDY


@pytest.fixture
def results(folder):
    """The hub turns by C t^2 / (2 J) = t^2 [rad] for 0.05 s."""
    return simulate(read_model(folder / "model" / "hub.toml"))


TRANSFORMED = {
    "filtered": ("max lowpass(angle:hub:z, 200)", 0.0025),
    "part": ("max angle:hub:z from 0 to 0.025 s", 0.25 * 0.0025),
    "value": ("value angle:hub:z at 0.025", 0.25 * 0.0025),
    "when": ("argmax |angle:hub|", 0.05),
    "rms": ("rms acceleration:hub:x", 0.0),
    "level": ("max srs(angular_acceleration:hub:z, q=10) from 100 to 180 Hz", None),
    "at": ("value srs(angular_acceleration:hub:z, q=10) at 120 Hz", None),
}


def test_what_is_made_of_quantities_is_an_output(results):
    """The hub turns by C t^2 / (2 J) = t^2 rad from t = 0 on, which is a step of 2 rad/s^2."""
    found = values(results, {name: text for name, (text, _) in TRANSFORMED.items()})
    for name, (_, expected) in TRANSFORMED.items():
        if expected is not None:
            assert found[name] == pytest.approx(expected, rel=2e-2, abs=1e-12)
    # a step of acceleration: 1 + exp(-pi zeta / sqrt(1 - zeta^2)) of it, zeta = 0.05
    over = 2.0 * (1.0 + np.exp(-np.pi * 0.05 / np.sqrt(1 - 0.05**2)))
    assert found["level"] == pytest.approx(over, rel=2e-2)
    assert found["at"] == pytest.approx(over, rel=2e-2)


def test_names_may_have_blanks(folder):
    """Also before the part of the time, and within what is made of quantities."""
    text = (folder / "model" / "hub.toml").read_text().replace("bodies.hub", 'bodies."left hub"')
    path = folder / "model" / "blank.toml"
    path.write_text(text.replace('"hub"', '"left hub"'))
    outputs = {
        "all": "max |angle:left hub|",
        "part": "max angle:left hub:z from 0 to 0.025 s",
        "filtered": "value lowpass(angle:left hub:z, 200) at 0.05",
    }
    found = values(simulate(read_model(path)), outputs)
    assert found["all"] == pytest.approx(0.0025, rel=1e-3)
    assert found["part"] == pytest.approx(0.25 * 0.0025, rel=1e-3)
    assert found["filtered"] == pytest.approx(0.0025, rel=2e-2)


@pytest.mark.parametrize(
    ("output", "message"),
    [
        ("final srs(acceleration:hub:x)", "is of a spectrum: expected one of max, min, argmax"),
        ("max srs(acceleration:hub)", "is of a vector: expected an axis, acceleration:hub:x$"),
        ("max |srs(acceleration:hub)|", "is of a vector: expected an axis, acceleration:hub:x$"),
        ("max cfc(acceleration:hub, 60)", r"acceleration:hub:x, or its length, .cfc\("),
        ("max angle:hub:z from 0 to 10 Hz", "expected s, found Hz"),
        ("value angle:hub:z", "expected value QUANTITY at X"),
        ("max angle:hub:z at 1", "expected value QUANTITY at X"),
        ("max angle:hub:z from 2 to 1", "expected value QUANTITY at X"),
        ("max angle:hub:z from e to 1", "expected numbers after at, from and to"),
        ("max srs(velocity:hub:x)", "srs: expected an acceleration"),
    ],
)
def test_outputs_that_mean_nothing_are_refused_before_a_run(results, output, message):
    with pytest.raises(StudyError, match=message):
        check(results, {"wrong": output})


def test_a_series_of_which_an_output_cannot_be_made_is_named(results):
    for output, message in (
        ("max cfc(acceleration:hub:x, 1000)", "CFC 1000: expected 10000 samples per second"),
        ("value angle:hub:z at 0.06", "expected between 0 and 0.05"),
        ("max angle:hub:z from 0.06 to 0.07", "nothing there, between 0 and 0.05"),
    ):
        with pytest.raises(SeriesError, match=rf"outputs.late: .*{message}"):
            values(results, {"late": output})


def test_a_case_of_which_an_output_cannot_be_made_fails_alone(study_file):
    text = STUDY.replace("bodies.hub.inertia = [[2, 2, 4], [1, 1, 2]]", "simulation.t_end = [1, 2]")
    text = text.replace("[8, 4, 2]", "[8]").replace("final angle:hub:z", "value angle:hub:z at 1.5")
    first, second = sweep(read_study(study_file(text)), workers=0)
    assert (first.status, second.status) == ("failed", "done")
    assert "outputs.angle: 'value angle:hub:z at 1.5': expected between 0 and 1" in first.message
    assert second.numbers["angle"] == pytest.approx(1.5**2, rel=1e-9)
