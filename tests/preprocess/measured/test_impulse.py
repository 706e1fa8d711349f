"""Impulse responses over time in place of frequency responses."""

import h5py
import numpy as np
import pytest
import scipy.io
from duhamel import preprocess
from duhamel.preprocess import MeasurementError
from duhamel.preprocess.measured.part_test import read_part_test

from .hammer_bench import FASTEST, Errors, measure

STEP = 0.5 / FASTEST


def responses(seconds, window=0.0):
    """Of the exact part, recorded for a time in which they may not have come to rest."""
    whole = np.fft.irfft(measure(Errors(), 0.5).H, axis=0) / STEP
    count = round(seconds / STEP)
    # What the rate of a record cuts off makes it begin before the hit, which an FFT has at its end.
    before = count // 50
    record = np.concatenate([whole[: count - before], whole[-before:]])
    times = STEP * np.concatenate([np.arange(count - before), np.arange(-before, 0)])
    return record * np.exp(-window * times)[:, None, None]


def written(folder, arrays, frf="angle.npz", **keys):
    path = measure(Errors()).write(folder, frf=frf, **keys)
    if frf.endswith(".npz"):
        np.savez(folder / frf, **arrays)
    return preprocess.read_body(path)


@pytest.fixture(scope="module")
def of_accelerances(tmp_path_factory):
    bench = measure(Errors(), 0.5)
    arrays = {"f": bench.f[::4], "H": bench.H[::4], "quantity": "accelerance"}
    return preprocess.build(written(tmp_path_factory.mktemp("frf"), arrays))


@pytest.mark.parametrize(("seconds", "window"), [(0.8, 0.0), (0.25, 20.0)])
def test_impulse_responses_are_the_part_of_their_accelerances(
    seconds, window, of_accelerances, tmp_path
):
    arrays = {"response": responses(seconds, window), "step": STEP}
    element = preprocess.build(written(tmp_path, arrays, window=window))
    one, other = element.modes, of_accelerances.modes
    nearest = np.abs(one.omega[:, None] - other.omega[:9]).argmin(axis=0)
    np.testing.assert_allclose(one.omega[nearest], other.omega[:9], rtol=1e-5)
    np.testing.assert_allclose(one.zeta[nearest], other.zeta[:9], rtol=2e-3)
    np.testing.assert_allclose(
        element.compliance,
        of_accelerances.compliance,
        atol=0.02 * np.abs(of_accelerances.compliance).max(),
    )


def test_all_arrays_have_them(tmp_path):
    response = responses(1.0)
    arrays = {"response": response, "step": STEP, "quantity": "impulse"}
    with h5py.File(tmp_path / "angle.h5", "w") as file:
        for key, value in arrays.items():
            file[key] = value
    scipy.io.savemat(tmp_path / "angle.mat", arrays)
    for name in ("angle.npz", "angle.h5", "angle.mat"):
        data = read_part_test(written(tmp_path, arrays, frf=name, quantity='"impulse"')).data
        assert data.f[0] == 20.0
        assert data.f[-1] == 5000.0
        expected = STEP * np.fft.rfft(response, axis=0)[20:5001]
        np.testing.assert_allclose(data.H, expected, rtol=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"response": 0.1}, r"its ninth tenth has \d+\.\d% of some line, expected at most 1%"),
        ({"step": None}, "expected step, the time between responses"),
        ({"step": -1.0}, "expected step, the time between responses"),
        ({"quantity": "mobility"}, "response: expected the quantity impulse, found 'mobility'"),
        ({"response": np.ones((100, 2))}, r"response: expected 40 times or more, .* \(100, 2\)"),
        ({"response": None, "H": 1.0, "f": 1.0, "quantity": "impulse"}, "expected the arrays resp"),
        ({"response": np.zeros((100, 3, 2))}, "H: expected frequencies, channels and hits"),
    ],
)
def test_responses_that_are_none_are_refused(change, message, tmp_path):
    arrays = {"response": 1.0, "step": STEP} | change
    if isinstance(arrays["response"], float):
        arrays["response"] = responses(arrays["response"])
    arrays = {key: value for key, value in arrays.items() if value is not None}
    with pytest.raises(MeasurementError, match=message):
        read_part_test(written(tmp_path, arrays))


def test_frequency_responses_are_no_impulse_responses(tmp_path):
    bench = measure(Errors())
    body = written(tmp_path, {"f": bench.f, "H": bench.H}, quantity='"impulse"')
    with pytest.raises(MeasurementError, match='quantity = "impulse": expected the arrays resp'):
        read_part_test(body)
