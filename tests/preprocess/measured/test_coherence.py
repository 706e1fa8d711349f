"""Coherences of a test, in all files: what is noise is named, or refused."""

import h5py
import numpy as np
import pytest
import scipy.io
from duhamel import preprocess
from duhamel.preprocess import MeasurementError
from duhamel.preprocess.measured.doubts import doubts_of_test
from duhamel.preprocess.measured.part_test import measurement_of, read_part_test

from .hammer_bench import ALL, HITS, measure, replace
from .test_part import NAMES, write_uff


def coherences(bench, **least):
    """About 0.95, and about the given values at channels or hits."""
    rng = np.random.default_rng(0)
    found = 0.95 + 0.04 * rng.uniform(-1.0, 1.0, bench.H.shape)
    for name, value in least.items():
        kind, _, label = name.partition("_")
        if kind == "channel":
            found[:, NAMES.index(label)] += value - 0.95
        elif kind == "hit":
            found[:, :, list(HITS).index(label)] += value - 0.95
        else:
            found += value - 0.95
    return found


@pytest.fixture(scope="module")
def bench():
    whole = measure(ALL)
    return replace(whole, f=whole.f[::4], H=whole.H[::4])


def read_with(bench, folder, coherence, **more):
    path = bench.write(folder)
    np.savez(
        folder / "angle.npz",
        f=bench.f, H=bench.H, quantity="accelerance", coherence=coherence, **more,
    )  # fmt: skip
    return read_part_test(preprocess.read_body(path))


@pytest.mark.parametrize(
    ("least", "messages"),
    [
        ({}, []),
        (
            {"channel_3:y": 0.7},
            ["channel 3:y has a median coherence of 0.70, expected 0.8 or more"],
        ),
        ({"hit_105": 0.6}, ["hit 105 has a median coherence of 0.60, expected 0.8 or more"]),
        ({"all": 0.7}, ["24 of 24 channels have a median coherence below 0.8: 0.70"]),
    ],
)
def test_low_coherences_are_one_message(least, messages, bench, tmp_path):
    test = read_with(bench, tmp_path, coherences(bench, **least))
    assert list(doubts_of_test(test, measurement_of(test))) == messages


def test_a_test_that_is_mostly_noise_is_refused(bench, tmp_path):
    with pytest.raises(
        MeasurementError, match=r"angle.npz: coherence: expected a median of 0.5 .*, found 0\.40"
    ):
        read_with(bench, tmp_path, coherences(bench, all=0.4))


def test_coherences_outside_the_band_do_not_count(bench, tmp_path):
    given = coherences(bench)
    given[bench.f > 4000.0] = 0.1
    path = bench.write(tmp_path)
    np.savez(tmp_path / "angle.npz", f=bench.f, H=bench.H, quantity="accelerance", coherence=given)
    path.write_text(path.read_text().replace("band = [20, 5000]", "band = [20, 4000]"))
    test = read_part_test(preprocess.read_body(path))
    assert test.data.coherence.shape == test.data.H.shape
    assert list(doubts_of_test(test, measurement_of(test))) == []


def test_coherences_follow_the_names_of_channels_and_hits(bench, tmp_path):
    given = coherences(bench, **{"channel_8:z": 0.6})
    order = np.random.default_rng(1).permutation(len(NAMES))
    turned = replace(bench, H=bench.H[:, order])
    names = [NAMES[k] for k in order]
    test = read_with(turned, tmp_path, given[:, order], outputs=names)
    np.testing.assert_array_equal(test.data.coherence, given)


def test_hdf5_matlab_and_uff_files_have_them_too(bench, tmp_path):
    given = coherences(bench)
    arrays = {"f": bench.f, "H": bench.H, "coherence": given}
    with h5py.File(tmp_path / "angle.h5", "w") as file:
        for key, values in arrays.items():
            file[key] = values
        file["quantity"] = "accelerance"
    scipy.io.savemat(tmp_path / "angle.mat", {**arrays, "quantity": "accelerance"})
    few = replace(bench, f=bench.f[:60], H=bench.H[:60])
    write_uff(tmp_path / "angle.uff", few)
    sets = (tmp_path / "angle.uff").read_text()
    write_uff(tmp_path / "angle.uff", replace(few, H=given[:60].astype(complex)), function=6)
    (tmp_path / "angle.uff").write_text(sets + (tmp_path / "angle.uff").read_text())
    for name, expected in (("angle.h5", given), ("angle.mat", given), ("angle.uff", given[:60])):
        test = read_part_test(preprocess.read_body(bench.write(tmp_path, frf=name)))
        np.testing.assert_allclose(test.data.coherence, expected, rtol=1e-5)


@pytest.mark.parametrize(
    ("coherence", "message"),
    [
        (np.ones((3, 2, 1)), "angle.npz: coherence: expected frequencies, channels and hits"),
        ("nan", "angle.npz: coherence: expected numbers from 0 to 1, found nan at 20 Hz"),
        ("percent", r"coherence: expected numbers from 0 to 1, found \d\d\.?\d* at 20 Hz"),
    ],
)
def test_coherences_that_are_none_are_refused(coherence, message, bench, tmp_path):
    if isinstance(coherence, str):
        coherence = coherences(bench) * (np.nan if coherence == "nan" else 100.0)
    with pytest.raises(MeasurementError, match=message):
        read_with(bench, tmp_path, coherence)
