"""Tested parts beside a test of both together, and what is read of other programs' tests."""

import hashlib
import pickle

import numpy as np
import pytest


@pytest.fixture(scope="module")
def script(example):
    return example("coupled_tests")


@pytest.mark.validation
def test_a_stand_in_is_found_again_and_coupled(script, tmp_path, capsys):
    found = script.main(tmp_path, stand_in=True)
    assert [row.what for row in found] == [*["a"] * 3, *["b"] * 3, *["a and b"] * 3]
    assert [row.band for row in found[:3]] == [row.band for row in found[6:]]
    # What is left of each part is its noise, of 2 %.
    for row in found[:6]:
        assert 0.019 < row.relative < 0.035
        assert row.decibels < 0.25
    # Peaks of 1 % damping that are 1 % off are wrong by half; in dB they count as what they are.
    for row in found[6:]:
        assert row.relative < 0.55
        assert row.decibels < 0.7
    assert (tmp_path / "coupled-tests.png").exists()
    assert capsys.readouterr().out.count(" dB\n") == len(found)
    # The same files, without writing them anew.
    assert script.main(tmp_path) == found


def write_lab(folder, Y, f, count):
    with (folder / "Y_B.p").open("wb") as file:
        pickle.dump((f, Y), file)
    head = "Name,Description,Quantity,Grouping,Position_1,Position_2,Position_3,"
    head += "Direction_1,Direction_2,Direction_3\n"
    for sheet, names in (
        ("Channels", ["S1 X", "S1 Y", "S1 Z"]),
        ("Impacts", ["H1", "H2"]),
    ):
        lines = [f"{name},,,1,{0.1 * k},0.2,0.3,0,0,-1\n" for k, name in enumerate(names)]
        (folder / f"{sheet}_B.csv").write_text(head + "".join(lines[:count]))


def test_the_testbench_of_pyfbs_becomes_arrays_and_tables(script, tmp_path, capsys):
    rng = np.random.default_rng(0)
    f, Y = np.arange(0.0, 50.0, 2.5), rng.standard_normal((3, 2, 20)) + 1j
    write_lab(tmp_path, Y, f, 3)
    digest = hashlib.sha256((tmp_path / "Y_B.p").read_bytes()).hexdigest()
    assert script.main(tmp_path / "out", lab=tmp_path, digests={"Y_B.p": digest}) == []
    assert f"{digest}  Y_B.p: as expected" in capsys.readouterr().out
    with np.load(tmp_path / "out/b.npz") as arrays:
        np.testing.assert_array_equal(arrays["f"], f[1:])
        np.testing.assert_array_equal(arrays["H"][:, 2, 1], Y[2, 1, 1:])
    lines = (tmp_path / "out/b_channels.csv").read_text().splitlines()
    assert lines[0] == "label,x,y,z,dx,dy,dz"
    assert lines[2] == "S1,0.1,0.2,0.3,0,0,-1"
    with pytest.raises(SystemExit, match=rf"Y_B.p: expected the SHA-256 other, found {digest}"):
        script.main(tmp_path / "out", lab=tmp_path, digests={"Y_B.p": "other"})
    write_lab(tmp_path, Y, f, 2)
    with pytest.raises(SystemExit, match=r"expected lines, channels and hits \(20, 2, 2\)"):
        script.main(tmp_path / "out", lab=tmp_path)


def test_only_arrays_are_read_from_files_that_may_run_what_they_like(script, tmp_path):
    with (tmp_path / "Y_B.p").open("wb") as file:
        pickle.dump((np.zeros(2), print), file)
    with pytest.raises(pickle.UnpicklingError, match=r"expected arrays, found builtins\.print"):
        script.main(tmp_path / "out", lab=tmp_path)


def test_tables_without_a_known_interface_are_refused(script, tmp_path):
    (tmp_path / "channels.csv").write_text("label,x,y,z,dx,dy,dz,interface\n1,0,0,0,1,0,0,a.x\n")
    paths = tmp_path / "ab.npz", tmp_path / "channels.csv", tmp_path / "channels.csv"
    with pytest.raises(SystemExit, match=r"channels.csv: expected a line at one of a.end, found"):
        script.read_test(paths, {"a.end": np.zeros(3)}, lambda line, _: line["interface"])
