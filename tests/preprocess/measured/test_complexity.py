"""Modes that are out of phase: of dampers at one place, not of noise, delays and wrong wires."""

import re

import numpy as np
import pytest
from duhamel import preprocess
from duhamel.preprocess import MeasurementError
from duhamel.preprocess.measured.part import identified
from duhamel.preprocess.progress import Stages

from .hammer_bench import ALL, Errors, measure, replace, with_fault


def fewer(bench):
    return replace(bench, f=bench.f[::4], H=bench.H[::4])


def found(bench, folder):
    path = fewer(bench).write(folder, accept=1.0)
    return identified(preprocess.read_body(path), Stages())


def in_band(part):
    return part.phases.shares[part.found.fit.frequencies < 4500.0]


@pytest.mark.parametrize(
    "errors", [Errors(), ALL, replace(ALL, noise=0.05, floor=1e-2), replace(ALL, window=9.2)]
)
def test_modal_damping_makes_real_shapes(errors, tmp_path):
    part = found(measure(errors), tmp_path)
    assert in_band(part).max() < 0.01
    assert part.doubts == ()


def test_a_damper_turns_shapes_in_proportion(tmp_path):
    weak, strong = (found(measure(replace(ALL, dashpot=c)), tmp_path) for c in (20.0, 40.0))
    assert weak.doubts == strong.doubts == ()
    first, second = in_band(weak), in_band(strong)
    assert second.max() > 0.05
    largest = second > 0.02
    np.testing.assert_allclose(second[largest], 2.0 * first[largest], rtol=0.2)


def test_a_strong_damper_is_one_message(tmp_path):
    part = found(measure(replace(ALL, dashpot=100.0)), tmp_path)
    (said,) = part.doubts
    assert re.match(r"the mode at 131\d\.?\d* Hz is out of phase by 1[78] % of its shape", said)


def test_modes_that_are_not_real_are_refused(tmp_path):
    path = fewer(measure(replace(ALL, dashpot=250.0))).write(tmp_path)
    with pytest.raises(
        MeasurementError, match=r"is out of phase by [34]\d % of its shape.*expected at most 30 %"
    ):
        preprocess.build(preprocess.read_body(path))


@pytest.mark.parametrize("what", ["late", "reversed"])
def test_other_faults_are_not_told_as_phases(what, tmp_path):
    def change(H):
        omega = 2.0 * np.pi * measure(ALL).f[:, None]
        H[:, 7] *= np.exp(-1j * omega * 40e-6) if what == "late" else -1.0

    doubts = found(with_fault(measure(ALL), change), tmp_path).doubts
    assert doubts
    assert not [doubt for doubt in doubts if "out of phase" in doubt]
