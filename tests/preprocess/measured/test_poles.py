"""Poles of another program in place of the search."""

import re

import numpy as np
import pytest
from duhamel import preprocess
from duhamel.preprocess import BodyError
from duhamel.preprocess.measured.part import identified
from duhamel.preprocess.progress import Stages

from .hammer_bench import ALL, measure, replace, truth


def found(folder, **keys):
    bench = measure(ALL)
    path = replace(bench, f=bench.f[::4], H=bench.H[::4]).write(folder, **keys)
    return identified(preprocess.read_body(path), Stages())


def rough(count):
    """Poles of the first modes as another program may have them, 0.2 % and 30 % off."""
    part = truth()
    frequencies = part.element.modes.omega[:count] / (2.0 * np.pi)
    signs = np.where(np.arange(count) % 2, 1.0, -1.0)
    pairs = np.column_stack([frequencies * (1.0 + 2e-3 * signs), part.zeta[:count] * 1.3])
    return pairs.tolist()


def test_given_poles_are_refined_to_those_of_the_search(tmp_path):
    sought, given = found(tmp_path), found(tmp_path, poles=rough(10))
    assert given.doubts == ()
    one, other = sought.found.fit, given.found.fit
    assert len(other.omega) == 10
    np.testing.assert_allclose(other.omega, one.omega[:10], rtol=1e-4)
    np.testing.assert_allclose(other.zeta[:9], one.zeta[:9], rtol=0.01)
    # The search has one more, beyond the band.
    assert other.misfit < 1.05 * one.misfit


def test_poles_without_a_mode_and_modes_without_a_pole_are_told(tmp_path):
    poles = rough(10)
    missing = poles.pop(4)
    doubts = found(tmp_path, poles=[*poles, [3500.0, 0.01]]).doubts
    first, second = doubts
    assert first == "measured.poles: no mode is found at 3500 Hz"
    told = re.fullmatch(r"measured.poles: the mode at ([\d.]+) Hz has none, and is added", second)
    assert float(told[1]) == pytest.approx(missing[0], rel=0.01)


@pytest.mark.parametrize(
    ("poles", "message"),
    [
        ("[[6000.0, 0.01]]", r"poles: expected frequencies from 20 to 5600 Hz .* found \[6000, "),
        ("[[100.0, 2.0]]", r"poles: expected .* damping ratios below 1, found \[100, 2\]"),
        ("[100.0, 0.01]", r"poles: expected pairs of a frequency \[Hz\] and a damping ratio"),
    ],
)
def test_poles_beyond_the_band_are_refused(poles, message, tmp_path):
    with pytest.raises(BodyError, match=message):
        found(tmp_path, poles=poles)
