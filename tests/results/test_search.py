"""Extremes over all points and steps, found without most of the values."""

import numpy as np
import pytest
from duhamel.results.search import FIRST_INTERVAL_STEPS, LENGTH_OF_FIELD, Field, extremes
from duhamel.superelement import von_mises

POINTS, MODES = 40, 12


def trajectory(kind, n, rng):
    """Modal coordinates (n, m): of vibration, of impacts, without any rule, or at rest at first."""
    t = np.arange(n)[:, None]
    omega = 2.0 * np.pi / np.geomspace(2000.0, 15.0, MODES)
    x = np.sin(omega * t + rng.uniform(0, 6, MODES)) / (1.0 + np.arange(MODES)) ** 2
    if kind == "impacts":
        x[rng.integers(0, n, 5)] += 0.3 * rng.normal(size=(5, MODES))
    if kind == "noise":
        x = rng.normal(size=(n, MODES))
    if kind == "rest":
        x[: n // 3] = 0.0
    return x


@pytest.mark.parametrize("name", LENGTH_OF_FIELD)
@pytest.mark.parametrize("kind", ["vibration", "impacts", "noise", "rest"])
@pytest.mark.parametrize("n", [1, 2, FIRST_INTERVAL_STEPS + 1, 1000])
def test_they_are_those_of_all_values(name, kind, n):
    rng = np.random.default_rng(n)
    shapes = rng.normal(size=(POINTS, 6 if name == "von_mises" else 3, MODES))
    x = trajectory(kind, n, rng)
    every = LENGTH_OF_FIELD[name](np.einsum("pcm,km->kpc", shapes, x))
    over_time = every.max(axis=1)
    blocks = [(5 + k, x[k : k + 300]) for k in range(0, n, 300)]
    found = extremes(Field(shapes, LENGTH_OF_FIELD[name]), blocks)
    assert found.largest == pytest.approx(every.max(), rel=1e-12)
    assert found.smallest == pytest.approx(over_time.min(), rel=1e-12)
    assert found.at_largest - 5 == over_time.argmax()
    assert found.point == every[over_time.argmax()].argmax()
    assert found.at_smallest - 5 == over_time.argmin()


def test_of_smooth_motion_few_steps_need_all_points():
    rng = np.random.default_rng(0)
    field = _Counting(rng.normal(size=(POINTS, 6, MODES)), von_mises)
    n = 20_000
    extremes(field, [(0, trajectory("vibration", n, rng))])
    assert field.evaluated < n / 8


class _Counting(Field):
    evaluated = 0

    def values(self, x, points=None):
        self.evaluated += len(x) if points is None else 0
        return super().values(x, points)
