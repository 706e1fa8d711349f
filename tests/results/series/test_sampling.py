"""Time bases: equal steps, two sizes of them, and others."""

import numpy as np
import pytest
from duhamel.results import SeriesError
from duhamel.results.series import sampled, shock_spectrum


def two_sizes():
    """Long steps of 1 ms, and between 0.1 and 0.2 s short ones of 0.1 ms."""
    return np.concatenate(
        [np.arange(0, 100) * 1e-3, 0.1 + np.arange(1000) * 1e-4, 0.2 + np.arange(101) * 1e-3]
    )


def test_equal_steps_stay_as_they_are():
    time = 1e-4 * np.arange(100)
    found = sampled(time, np.sin(time))
    np.testing.assert_array_equal(found.values, np.sin(time))
    assert found.step == pytest.approx(1e-4, rel=1e-12)


def test_times_of_few_digits_are_equal_steps():
    time = np.round(np.arange(400) / 3.0, 5)
    assert len(sampled(time, time).time) == 400


def test_two_sizes_of_steps_become_the_shorter_one():
    time = two_sizes()
    values = np.stack([np.sin(30 * time), np.cos(50 * time)], axis=1)
    found = sampled(time, values)
    assert found.step == pytest.approx(1e-4, rel=1e-9)
    assert found.coarsest == pytest.approx(1e-3, rel=1e-9)
    assert len(found.time) == 3001
    kept = np.searchsorted(found.time, time - 5e-5)
    np.testing.assert_allclose(found.time[kept], time, atol=1e-12)
    np.testing.assert_allclose(found.values[kept], values, atol=1e-12)


def test_a_shock_spectrum_is_the_same_on_two_sizes_of_steps():
    """The line between samples is what it takes for granted."""
    time = two_sizes()
    base = np.interp(time, [0, 0.1, 0.15, 0.16, 0.3], [0, 0, 1, 0, 0])
    even = 1e-4 * np.arange(3001)
    expected = shock_spectrum(even, np.interp(even, time, base), [20.0, 90.0])
    found = shock_spectrum(time, base, [20.0, 90.0])
    np.testing.assert_allclose(found.values, expected.values, rtol=1e-9)
    with pytest.raises(SeriesError, match="101 Hz: expected frequencies up to 100 Hz"):
        shock_spectrum(time, base, [101.0])


def test_a_shorter_last_step_is_left_out():
    time = np.append(1e-2 * np.arange(50), 0.4905)
    found = sampled(time, time)
    assert len(found.time) == 50
    assert found.coarsest == pytest.approx(1e-2)


@pytest.mark.parametrize(
    ("time", "values", "message"),
    [
        ([0, 1, 2.5, 3.5], [0, 0, 0, 0], "multiples of the shortest one, found steps from 1 to 1."),
        ([0, 1, 1, 2], [0, 0, 0, 0], "expected times that increase, found a step of 0 s"),
        ([0, 1], [0, 0], "three or more samples, found 2"),
        ([0, 1, 2], [0, np.nan, 0], "expected numbers in a time series"),
        ([0, 1, 2], [0, 0], r"expected time \(n,\) and values"),
        ([0, 1e8, 1e8 + 1, 2e8 + 1], [0, 0, 0, 0], "expected at most 20000000 samples"),
    ],
)
def test_what_has_no_equal_steps_is_refused(time, values, message):
    with pytest.raises(SeriesError, match=message):
        sampled(np.array(time, dtype=float), np.array(values, dtype=float))
