"""Sampled designs: where their points lie, and what seeds and numbers of samples change."""

import numpy as np
import pytest
from duhamel.study import StudyError
from duhamel.study.samples import Design, sampled

PARAMETERS = {
    "bodies": {"hub": {"mass": {"uniform": [2, 4]}}},
    "k": {"log_uniform": [1e2, 1e6]},
    "x": {"normal": [5, 0.5]},
}
TYPES = ["latin-hypercube", "sobol", "random"]


def points(type, samples, seed=0, parameters=PARAMETERS):
    rows = list(sampled(parameters, Design(type=type, samples=samples, seed=seed)))
    return np.array([list(row.values()) for row in rows])


def test_a_latin_hypercube_has_one_point_in_each_layer_of_each_range():
    mass, k, _ = points("latin-hypercube", 50).T
    layers = np.arange(50)
    assert np.array_equal(np.sort(np.floor((mass - 2) / 2 * 50)), layers)
    assert np.array_equal(np.sort(np.floor(np.log(k / 1e2) / np.log(1e4) * 50)), layers)


def test_sobol_points_have_one_in_each_box_of_a_balanced_division():
    """Two dimensions, 64 points: one in each of 8 by 8 boxes. Source: a (0, m, 2)-net."""
    mass, k = points("sobol", 64)[:, :2].T
    x, y = (mass - 2) / 2, np.log(k / 1e2) / np.log(1e4)
    boxes = set(zip(np.floor(8 * x).astype(int), np.floor(8 * y).astype(int), strict=True))
    assert len(boxes) == 64


@pytest.mark.parametrize("type", TYPES)
def test_values_have_their_distributions(type):
    mass, k, x = points(type, 4096).T
    assert mass.mean() == pytest.approx(3.0, abs=4 * 2 / np.sqrt(12 * 4096))
    assert np.log10(k).mean() == pytest.approx(4.0, abs=4 * 4 / np.sqrt(12 * 4096))
    assert x.mean() == pytest.approx(5.0, abs=4 * 0.5 / np.sqrt(4096))
    assert x.std() == pytest.approx(0.5, rel=4 / np.sqrt(2 * 4096))
    assert (mass.min() >= 2, mass.max() <= 4, k.min() >= 1e2, k.max() <= 1e6) == (True,) * 4


@pytest.mark.parametrize("type", TYPES)
def test_the_seed_decides(type):
    assert np.array_equal(points(type, 8, seed=3), points(type, 8, seed=3))
    assert not np.array_equal(points(type, 8, seed=3), points(type, 8, seed=4))


@pytest.mark.parametrize("type", ["sobol", "random"])
def test_more_points_leave_those_before_as_they_are(type):
    assert np.array_equal(points(type, 20)[:8], points(type, 8))


def test_a_list_is_a_choice_of_equal_probability():
    rows = sampled({"type": ["a", "b"]}, Design(samples=10))
    assert sorted(row["type"] for row in rows) == ["a"] * 5 + ["b"] * 5


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({}, "parameters: expected distributions"),
        ({"m": 3}, "parameters.m: expected one of uniform, log_uniform, normal, or a list"),
        ({"m": {"uniform": [2, 1]}}, "parameters.m.uniform: expected two numbers that rise"),
        ({"m": {"log_uniform": [0, 1]}}, "parameters.m.log_uniform: expected two positive"),
        ({"m": {"normal": [0, 0]}}, "parameters.m.normal: expected a mean and a positive"),
        ({"m": {"uniform": [0, float("inf")]}}, "parameters.m.uniform: expected two"),
        ({"m": {"uniform": [0, 1], "normal": [0, 1]}}, "parameters.m: expected one distribution"),
    ],
)
def test_what_makes_no_sense_is_refused(parameters, message):
    with pytest.raises(StudyError) as error:
        list(sampled(parameters, Design(samples=2)))
    assert str(error.value).startswith(message)
