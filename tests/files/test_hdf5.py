"""HDF5 files that reach beyond themselves, or declare more than they hold, are refused."""

import os

import h5py
import numpy as np
import pytest
from duhamel.files import FileError, hdf5
from duhamel.files.hdf5 import require_kind


class DamageError(ValueError):
    pass


def read(path, name="a/numbers"):
    with hdf5.opened(path, DamageError) as file:
        return hdf5.whole(file[name])


@pytest.fixture
def path(tmp_path):
    with h5py.File(tmp_path / "file.h5", "w") as file:
        file["a/numbers"] = np.arange(3.0)
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["secret"] = np.arange(3.0)
    (tmp_path / "raw").write_bytes(bytes(24))
    return tmp_path / "file.h5"


def external(file, folder):
    file["b"] = h5py.ExternalLink(str(folder / "other.h5"), "/secret")


def soft(file, folder):
    file["a/b"] = h5py.SoftLink("/a/numbers")


def cycle(file, folder):
    file["a/b"] = h5py.SoftLink("/a/b")


def raw(file, folder):
    file.create_dataset("b", (3,), "f8", external=[(str(folder / "raw"), 0, 24)])


def virtual(file, folder):
    layout = h5py.VirtualLayout((3,), "f8")
    layout[:] = h5py.VirtualSource(str(folder / "other.h5"), "secret", (3,))
    file.create_virtual_dataset("b", layout)


def never_written(file, folder):
    file.create_dataset("b", (10**6, 10**6, 3), "f8", chunks=(100, 100, 3))


def bomb(file, folder):
    shape = (10_000, 1000)
    file.create_dataset("b", data=np.zeros(shape), compression="gzip", chunks=shape)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (external, "b: expected an object of this file, found a link"),
        (soft, "a/b: expected an object of this file, found a link"),
        (cycle, "a/b: expected an object of this file, found a link"),
        (raw, r"b: expected numbers in this file, found them in another \(external\)"),
        (virtual, "b: expected numbers in this file, found a virtual dataset"),
        (
            never_written,
            "b: expected at most 100 times what is stored, 0 bytes, found 24000000000000 of shape "
            r"\(1000000, 1000000, 3\)",
        ),
        (bomb, "b: expected at most 100 times what is stored, .* found 80000000 of shape"),
    ],
)
def test_what_is_not_in_the_file_is_refused_wherever_it_stands(change, message, path):
    """Also where nobody would read it."""
    assert read(path).tolist() == [0.0, 1.0, 2.0]
    with h5py.File(path, "r+") as file:
        change(file, path.parent)
    with pytest.raises(DamageError, match=f"^{path}: {message}"):
        read(path)


def test_zeros_of_a_dataset_that_is_mostly_zero_are_read(path):
    with h5py.File(path, "r+") as file:
        bomb(file, path.parent)
        hdf5.require_contained(file, ["b"])
        with pytest.raises(FileError, match="b: expected at most 100 times what is stored"):
            hdf5.require_contained(file, ["a/b"])
        del file["b"]
        never_written(file, path.parent)
        with pytest.raises(FileError, match="b: expected at most 1100 times what is stored, 0"):
            hdf5.require_contained(file, ["b"])


def test_groups_in_a_circle_and_objects_of_two_names_are_read(path):
    with h5py.File(path, "r+") as file:
        file["a/again"] = file["a"]
        file["b"] = file["a/numbers"]
    assert read(path, "b").tolist() == [0.0, 1.0, 2.0]


def test_zeros_that_were_never_written_are_read_as_long_as_they_are_few(path):
    with h5py.File(path, "r+") as file:
        file.create_dataset("b", (10**6,), "f8", chunks=(1000,))
    assert not read(path, "b").any()


def test_more_than_the_memory_is_refused_before_it_is_read(path, monkeypatch):
    monkeypatch.setattr("duhamel.files.hdf5.UNCHECKED_BYTES", 20)
    monkeypatch.setattr("duhamel.files.hdf5.available", lambda: 20)
    with pytest.raises(DamageError, match="a/numbers: expected at most the 20 bytes of memory"):
        read(path)


@pytest.mark.parametrize(
    ("make", "kind"), [(os.mkfifo, "a pipe"), (os.mkdir, "a folder")], ids=["pipe", "folder"]
)
def test_what_is_no_regular_file_is_refused_at_once(make, kind, tmp_path):
    make(tmp_path / "file.h5")
    with pytest.raises(DamageError, match=f"expected a regular file, found {kind}$"):
        read(tmp_path / "file.h5")


def test_a_device_and_a_missing_file_are_refused():
    with pytest.raises(DamageError, match="/dev/zero: expected a regular file, found a device"):
        read("/dev/zero")
    with pytest.raises(DamageError, match=r"^none: no such file$"):
        read("none")
    with pytest.raises(DamageError, match="no path of a file"):
        read("a\0b")


@pytest.mark.parametrize("value", [np.bytes_(b"QZQZ"), "QZQZ"], ids=["fixed", "variable"])
def test_text_that_is_not_utf8_is_refused(value, path):
    with h5py.File(path, "r+") as file:
        file.attrs["name"] = value
    path.write_bytes(path.read_bytes().replace(b"QZQZ", b"Q\xffQ\xfe"))
    with (
        pytest.raises(DamageError, match="attribute 'name': expected text in UTF-8, found"),
        hdf5.opened(path, DamageError) as file,
    ):
        hdf5.attribute(file, "name")


def test_texts_that_are_not_utf8_are_refused(path):
    with h5py.File(path, "r+") as file:
        file["names"] = np.array([b"good", b"\xff"])
    with (
        pytest.raises(DamageError, match="names: expected text in UTF-8"),
        hdf5.opened(path, DamageError) as file,
    ):
        hdf5.texts(file["names"])


def test_long_attributes_are_refused_unread(path, monkeypatch):
    monkeypatch.setattr(hdf5, "MOST_TEXT", 1000)
    with h5py.File(path, "r+") as file:
        file.attrs["many"] = np.zeros(200)
    with (
        pytest.raises(DamageError, match="attribute 'many': expected at most 1000 bytes"),
        hdf5.opened(path, DamageError) as file,
    ):
        hdf5.attribute(file, "many")


def test_more_objects_than_anybody_makes_are_refused(path, monkeypatch):
    monkeypatch.setattr(hdf5, "MOST_LINKS", 1)
    with pytest.raises(DamageError, match="expected at most 1 groups and datasets"):
        read(path)


def test_a_heap_of_texts_that_leads_back_to_itself_is_refused(tmp_path):
    """HDF5 itself would never come back from reading such an attribute."""
    path = tmp_path / "texts.h5"
    with h5py.File(path, "w") as file:
        file.attrs["name"] = "beam"
    with h5py.File(path) as file:
        hdf5.require_contained(file)
    data = bytearray(path.read_bytes())
    free = data.index(b"GCOL") + 16 + 16 + 8  # behind the header of the heap and its one text
    assert data[free : free + 2] == b"\0\0"
    data[free + 8 : free + 16] = bytes(8)
    path.write_bytes(data)
    with h5py.File(path) as file, pytest.raises(FileError, match=r"heap of texts at byte \d+"):
        hdf5.require_contained(file)


@pytest.mark.parametrize(
    ("found", "what"),
    [
        ("duhamel-results", "found results of a run: duhamel plot, peaks, report and animate"),
        ("duhamel-state", "found the checkpoint of a run: duhamel run --continue"),
        (b"duhamel-results", "found results of a run"),
        ("duhamel-map", "found 'duhamel-map': a later Duhamel reads it"),
        ("other", "found an HDF5 file of another program: duhamel preprocess writes"),
        (7, "found an HDF5 file of another program"),
        (None, "found an HDF5 file of another program"),
    ],
)
def test_a_file_of_another_kind_is_told_with_what_takes_it(tmp_path, found, what):
    with h5py.File(tmp_path / "file.h5", "w") as file:
        if found is not None:
            file.attrs["format"] = found
        with pytest.raises(FileError, match=f"expected a superelement, {what}"):
            require_kind(file, "duhamel-superelement")
