"""Channels and hits that are late, by the phases that the fit leaves."""

import re

import numpy as np
import pytest
from duhamel import preprocess
from duhamel.preprocess.measured.delays import delays_of
from duhamel.preprocess.measured.part import identified
from duhamel.preprocess.progress import Stages

from .hammer_bench import ALL, HITS, SENSORS, Errors, measure, replace, with_fault

NAMES = [f"{label}:{axis}" for label in SENSORS for axis in "xyz"]
NOISY = replace(ALL, noise=0.05, floor=1e-2)


def fewer(bench):
    return replace(bench, f=bench.f[::4], H=bench.H[::4])


def found(bench, folder):
    path = fewer(bench).write(folder, accept=1.0)
    return identified(preprocess.read_body(path), Stages())


def late(seconds, channels=(), hits=()):
    """Delays of some channels and hits, by their names."""

    def change(H):
        phase = np.exp(-2j * np.pi * measure(ALL).f * seconds)
        for name in channels:
            H[:, NAMES.index(name)] *= phase[:, None]
        for name in hits:
            H[:, :, list(HITS).index(name)] *= phase[:, None]

    return change


@pytest.mark.parametrize(
    "errors",
    [
        Errors(),
        NOISY,
        replace(ALL, window=9.2),
        replace(ALL, mass=0.008),
        replace(ALL, cords=4.0),
    ],
)
def test_tests_that_are_right_have_no_delays(errors, tmp_path):
    part = found(measure(errors), tmp_path)
    assert part.doubts == ()
    delays = delays_of(part.measurement, part.found.fit)
    every = np.concatenate([delays.channels, delays.hits])
    # Less than half of what is told.
    assert np.abs(every).max() < 0.5 * delays.limit


@pytest.mark.parametrize(
    ("change", "message", "seconds"),
    [
        (late(25e-6, ["3:y"]), r"channel 3:y is ([\d.]+) us late", 25.0),
        (late(-10e-6, ["8:z"]), r"channel 8:z is ([\d.]+) us early", 10.0),
        (late(25e-6, hits=["105"]), r"hit 105 is ([\d.]+) us late", 25.0),
        (late(15e-6, NAMES[:15]), r"15 of 24 channels are about ([\d.]+) us late", 15.0),
    ],
)
def test_a_delay_is_one_message(change, message, seconds, tmp_path):
    doubts = found(with_fault(measure(ALL), change), tmp_path).doubts
    (said,) = [doubt for doubt in doubts if "the responses of" not in doubt]
    assert (matched := re.fullmatch(message, said)), said
    # The fit takes up a part of delays that most channels share.
    assert float(matched[1]) == pytest.approx(seconds, rel=0.05 if "of" not in said else 0.25)


def test_a_delay_of_all_is_one_message(tmp_path):
    doubts = found(with_fault(measure(ALL), late(20e-6, NAMES)), tmp_path).doubts
    (said,) = [doubt for doubt in doubts if "the responses of" not in doubt]
    assert re.fullmatch(r"all channels are about 1[5-9][\d.]* us late", said)


@pytest.mark.parametrize("rows", [[1], [3, 4]], ids=["reversed", "exchanged"])
def test_wrong_wires_are_no_delays(rows, tmp_path):
    def change(H):
        H[:, rows] = H[:, rows[::-1]] * (-1.0 if len(rows) == 1 else 1.0)

    assert not [
        doubt
        for doubt in found(with_fault(measure(ALL), change), tmp_path).doubts
        if doubt.endswith(("late", "early"))
    ]
