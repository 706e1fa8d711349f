"""Impulse responses over time in place of frequency responses."""

import h5py
import numpy as np
import pytest
import pyuff
import scipy.io
from duhamel import preprocess
from duhamel.preprocess import MeasurementError
from duhamel.preprocess.measured.part import identified
from duhamel.preprocess.measured.part_test import read_part_test
from duhamel.preprocess.progress import Stages

from .hammer_bench import ALL, FASTEST, HITS, SENSORS, Errors, measure, replace, truth

STEP = 0.5 / FASTEST


NO_ERRORS = Errors()


def responses(seconds, window=0.0, errors=NO_ERRORS):
    """Of a part, recorded for a time in which they may not have come to rest."""
    whole = np.fft.irfft(measure(errors, 0.5).H, axis=0) / STEP
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


@pytest.mark.parametrize(
    ("seconds", "window"), [pytest.param(0.8, 0.0, marks=pytest.mark.validation), (0.25, 20.0)]
)
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


def of_modes(part):
    """Largest errors of the frequencies and damping ratios of nine modes."""
    fit, omega = part.found.fit, truth().element.modes.omega[:9]
    nearest = np.abs(fit.omega[:, None] - omega).argmin(axis=0)
    frequency = np.abs(fit.omega[nearest] / omega - 1.0).max()
    return frequency, np.abs(fit.zeta[nearest] / truth().zeta[:9] - 1.0).max()


@pytest.mark.validation
@pytest.mark.parametrize(("seconds", "window"), [(0.4, 15.0)])
def test_noise_over_time_is_as_harmless_as_noise_of_lines(seconds, window, tmp_path):
    """White noise, of 2 % of the median line of each response; bounds of frequency responses."""
    errors = replace(ALL, noise=0.0, floor=0.0)
    record = responses(seconds, window, errors)
    level = np.median(np.abs(measure(errors, 0.5).H), axis=0)
    white = np.random.default_rng(5).standard_normal(record.shape)
    noise = 0.02 * level / (STEP * np.sqrt(len(record))) * white
    part = identified(
        written(tmp_path, {"response": record + noise, "step": STEP}, window=window), Stages()
    )
    assert part.doubts == ()
    assert part.found.fit.misfit < 0.07
    frequency, damping = of_modes(part)
    assert frequency < 1e-4
    assert damping < 1e-2


KEYS = {"abscissa_spec_data_type": 17, "ordinate_spec_data_type": 12, "orddenom_spec_data_type": 13}
"""of UFF: acceleration per force over time"""


def write_records(path, record, before=0, **keys):
    """Sets 58 of all pairs over time, `before` of whose times are those before the hit."""
    data = np.roll(record, before, axis=0)
    names = [(label, axis) for label in SENSORS for axis in (1, 2, 3)]
    sets = [
        {
            "type": 58,
            "binary": 1,
            "func_type": 1,
            "id1": "record",
            "rsp_node": int(label),
            "rsp_dir": axis,
            "ref_node": int(hit),
            "ref_dir": 0,
            "x": STEP * np.arange(-before, len(record) - before),
            "data": data[:, o, i],
            **KEYS,
            **keys,
        }
        for i, hit in enumerate(HITS)
        for o, (label, axis) in enumerate(names)
    ]
    pyuff.UFF(str(path)).write_sets(sets, mode="add")


SHORT = 400
"""times of records that are only read"""


def decayed():
    times = np.arange(SHORT)[:, None, None]
    return np.ones((1, 3 * len(SENSORS), len(HITS))) * np.exp(-0.1 * times) * np.sin(0.3 * times)


@pytest.mark.parametrize("before", [0, 20])
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # of pyuff's writer
def test_records_of_uff_files_are_impulse_responses(before, tmp_path):
    record = decayed() * np.arange(1, len(HITS) + 1)
    write_records(tmp_path / "angle.uff", record, before)
    data = read_part_test(written(tmp_path, {}, frf="angle.uff")).data
    expected = STEP * np.fft.rfft(record, axis=0)
    used = slice(int(np.ceil(20.0 * SHORT * STEP)), None)
    np.testing.assert_allclose(
        data.H, expected[used][: len(data.f)], atol=1e-6 * np.abs(expected).max()
    )


@pytest.mark.parametrize(
    ("keys", "quantity", "message"),
    [
        ({"orddenom_spec_data_type": 0}, "", "a time response that is not per force: expected imp"),
        ({"orddenom_spec_data_type": 0}, '"impulse"', None),
        ({"orddenom_spec_data_type": 12}, '"impulse"', "not per force: .* found the type 12"),
        ({"ordinate_spec_data_type": 11}, "", r"of acceleration \(12\), found the type 11"),
        (
            {"ordinate_spec_data_type": 13, "orddenom_spec_data_type": 0},
            '"impulse"',
            r"of acceleration \(12\), found the type 13",
        ),
        ({"func_type": 2}, "", "a function of type 2 over time is no impulse response"),
        ({"x": STEP * np.arange(3, SHORT + 3)}, "", "the hit at t = 0 among them, found 0.00023"),
    ],
)
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # of pyuff's writer
def test_records_that_are_no_impulse_responses_are_refused(keys, quantity, message, tmp_path):
    write_records(tmp_path / "angle.uff", decayed(), **keys)
    body = written(tmp_path, {}, frf="angle.uff", quantity=quantity)
    if message is None:
        assert np.isfinite(read_part_test(body).data.H).all()
        return
    with pytest.raises(MeasurementError, match=message):
        read_part_test(body)
