"""Attributes and datasets of HDF5 files, with errors that name them, and with units."""

from collections.abc import Sequence
from typing import Any, TypeVar

import h5py
import numpy as np

from ..files import hdf5
from ..files.arrays import Array
from .validation import SuperelementError, check_shape, checked

Value = TypeVar("Value", str, int)
# HDF5 caches chunks of up to 1 MiB by default; data that fit into one need none.
CHUNK_BYTES = 1 << 20


def put(parent: h5py.Group, name: str, data: Any, units: str) -> None:
    """Write a dataset with its units."""
    parent.create_dataset(name, data=data).attrs["units"] = units


def put_large(parent: h5py.Group, name: str, data: Any, units: str = "", kind: Any = None) -> None:
    """Write a dataset, in chunks of rows and compressed where it is large.

    Without loss, by shuffled bytes and gzip, which every HDF5 library reads. kind: the type in the
    file, if that is not the type of the data, which is then converted chunk by chunk.
    """
    kind = data.dtype if kind is None else np.dtype(kind)
    row = kind.itemsize * max(1, data[:1].size)
    if row * len(data) <= CHUNK_BYTES:
        found = parent.create_dataset(name, data=data.astype(kind, copy=False))
    else:
        chunks = (max(1, CHUNK_BYTES // row), *data.shape[1:])
        found = parent.create_dataset(
            name,
            data.shape,
            kind,
            chunks=chunks,
            shuffle=True,
            compression="gzip",
            compression_opts=1,
        )
        # Chunk by chunk: a converted copy of everything would double the memory.
        for part in found.iter_chunks():
            found[part] = data[part].astype(kind)
    if units:
        found.attrs["units"] = units


def group(file: h5py.Group, name: str) -> h5py.Group:
    if not isinstance(file.get(name), h5py.Group):
        raise SuperelementError(f"group {name!r} is missing")
    return file[name]


def dataset(file: h5py.Group, name: str, *shape: int | str) -> Any:
    """The whole of a dataset, of a shape in which a letter allows any length: looked at first."""
    found = _dataset(file, name)
    check_shape(name, found.shape or (), shape)
    return hdf5.whole(found)


def require_shape(file: h5py.Group, name: str, *shape: int) -> None:
    """`SuperelementError` unless a dataset, of which nothing is read, has a shape."""
    check_shape(name, _dataset(file, name).shape or (), shape)


def numbers(file: h5py.Group, name: str, *shape: int | str) -> Array:
    """A dataset of finite numbers."""
    return checked(name, dataset(file, name, *shape), shape)


def scalar(file: h5py.Group, name: str) -> float:
    return float(numbers(file, name))


def texts(file: h5py.Group, name: str) -> list[str]:
    """A dataset of text (n,), UTF-8 of any length or of the fixed length that some tools write."""
    found = _dataset(file, name)
    if h5py.check_string_dtype(found.dtype) is None or found.ndim != 1:
        raise SuperelementError(
            f"{name}: expected text of shape (n,), found {found.dtype} of shape {found.shape}"
        )
    return hdf5.texts(found)


def number(file: h5py.Group, name: str) -> float:
    """A finite number in an attribute."""
    return float(checked(_label(file, name), _attribute(file, name), ()))


def pair(file: h5py.Group, name: str) -> tuple[float, float]:
    """Two finite numbers in an attribute."""
    first, second = checked(_label(file, name), _attribute(file, name), (2,)).tolist()
    return first, second


def rank(file: h5py.Group, name: str) -> int:
    """The number of dimensions of a dataset."""
    return len(_dataset(file, name).shape or ())


def text(file: h5py.Group, name: str) -> str:
    """A text in an attribute."""
    found = _attribute(file, name)
    if not isinstance(found, str):
        raise SuperelementError(f"{_label(file, name)}: expected text, found {_quoted(found)}")
    return found


def expect(file: h5py.Group, name: str, *allowed: Value) -> Value:
    """An attribute that must have one of the allowed values; that value."""
    found = text(file, name) if isinstance(allowed[0], str) else _attribute(file, name)
    for value in allowed:
        if np.array_equal(found, value):
            return value
    raise SuperelementError(
        f"{_label(file, name)}: expected {' or '.join(map(repr, allowed))}, found {_quoted(found)}"
    )


def names(owner: h5py.Group) -> Sequence[str]:
    """The names of the attributes of a group."""
    return [hdf5.decoded("the name of an attribute", name) for name in owner.attrs]


def _quoted(value: Any) -> str:
    """A value in one line, not at length."""
    return " ".join(repr(value).split())[:80]


def _dataset(file: h5py.Group, name: str) -> h5py.Dataset:
    if not isinstance(file.get(name), h5py.Dataset):
        raise SuperelementError(f"dataset {name!r} is missing")
    return file[name]


def _attribute(file: h5py.Group, name: str) -> Any:
    if name not in file.attrs:
        raise SuperelementError(f"{_label(file, name)} is missing")
    found = hdf5.attribute(file, name)
    return found.item() if isinstance(found, np.generic) else found


def _label(file: h5py.Group, name: str) -> str:
    return f"attribute {name!r}" + ("" if file.name == "/" else f" of group {file.name[1:]!r}")
