"""HDF5 files that others may have made: nothing outside of them is read, nor more than they hold.

HDF5 follows links into other files, reads raw data from any path, and believes the sizes that a
file declares. Source: HDF5 User Guide, Groups and Dataset Creation Properties.
"""

import os
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from typing import Any

import h5py

from .heaps import require_ending_heaps
from .memory import available
from .regular import FileError, in_one_line, require_regular

# Bounds the time that a visit of all groups and datasets takes.
MOST_LINKS = 100_000
# A dataset may declare more than it stores, for what was never written is zero; up to here that
# does no harm.
MAX_SPARSE_BYTES = 1 << 26
# Of declared to stored bytes. Numbers that vary compress to no less than a tenth, so more is a
# file made to exhaust memory.
MAX_COMPRESSION_RATIO = 100
# Of datasets that are known to be mostly zero: gzip stores no less than a 1032th of these.
MAX_RATIO_OF_ZEROS = 1100
# Asking how much memory is free takes longer than to read as little as this.
UNCHECKED_BYTES = 1 << 20
# 64 MiB of text in a dataset or an attribute.
MOST_TEXT = 1 << 26
# h5py raises any of them for wrong bytes, depending on where in the structure they are.
DAMAGE_ERRORS = (
    ArithmeticError,
    LookupError,
    OSError,
    RuntimeError,
    TypeError,
    ValueError,
)


HDF5_KINDS = {
    "duhamel-superelement": (
        "a superelement",
        "models take it as superelement of a body, duhamel info and check show it",
    ),
    "duhamel-results": ("results of a run", "duhamel plot, peaks, report and animate take them"),
    "duhamel-state": ("the checkpoint of a run", "duhamel run --continue goes on from it"),
}
"""what the files of Duhamel are, by their attribute `format`, and what takes them"""
MADE_BY = {"duhamel-superelement": "duhamel preprocess", "duhamel-results": "duhamel run"}


def require_kind(file: h5py.File, wanted: str) -> None:
    """`FileError` that says what a file is that has another format than the wanted one."""
    found = file.attrs.get("format")
    found = found.decode(errors="replace") if isinstance(found, bytes) else found
    if isinstance(found, str) and found == wanted:
        return
    if isinstance(found, str) and found in HDF5_KINDS:
        what, use = HDF5_KINDS[found]
    elif isinstance(found, str) and found.startswith("duhamel-"):
        what, use = f"{found!r}", "a later Duhamel reads it"
    else:
        what = "an HDF5 file of another program"
        use = f"{MADE_BY.get(wanted, 'duhamel run')} writes what is expected here"
    raise FileError(f"expected {HDF5_KINDS[wanted][0]}, found {what}: {use}")


@contextmanager
def opened(path: str | os.PathLike[str], failure: type[Exception]) -> Iterator[h5py.File]:
    """A file for reading that `require_contained` lets pass, see `failures_named`."""
    with failures_named(path, failure), h5py.File(path, "r") as file:
        require_contained(file)
        yield file


@contextmanager
def failures_named(
    path: str | os.PathLike[str], failure: type[Exception], what: str = "HDF5 file"
) -> Iterator[None]:
    """A block that reads a regular file, `what` in messages.

    What goes wrong in it is a `failure` that names the file: those that are raised there, and all
    that h5py says of damage.
    """
    try:
        require_regular(path)
        yield
    except (failure, FileError) as error:
        raise failure(f"{os.fspath(path)}: {error}") from error
    except FileNotFoundError as error:
        raise failure(f"{os.fspath(path)}: no such file") from error
    except MemoryError as error:
        raise failure(f"{os.fspath(path)}: out of memory: {in_one_line(error)}") from error
    except DAMAGE_ERRORS as error:
        why = in_one_line(error)
        if os.fspath(path).lower().endswith(".toml"):
            why = "a TOML file: duhamel preprocess makes superelements, duhamel run results"
        raise failure(f"{os.fspath(path)}: not a readable {what}: {why}") from error


def require_contained(file: h5py.File, mostly_zero: Collection[str] = ()) -> None:
    """`FileError` for links that are not to the object itself, and for datasets that are elsewhere.

    That is for links into other files and soft ones, for external and virtual datasets, and for
    those that declare far more than they store. mostly_zero: names of those that may declare more.
    """
    require_ending_heaps(file.filename)
    names: list[bytes] = []

    def look(name: bytes, link: Any) -> FileError | None:
        # HDF5 calls this: what it returns ends the visit, and nothing may be raised.
        if len(names) == MOST_LINKS:
            return FileError(f"expected at most {MOST_LINKS} groups and datasets, found more")
        if link.type != h5py.h5l.TYPE_HARD:
            return FileError(f"{_shown(name)}: expected an object of this file, found a link")
        names.append(name)
        return None

    refusal = file.id.links.visit(look, info=True)
    if refusal is not None:
        raise refusal
    for name in names:
        found = h5py.h5o.open(file.id, name)
        if isinstance(found, h5py.h5d.DatasetID):
            shown = _shown(name)
            ratio = MAX_RATIO_OF_ZEROS if shown in mostly_zero else MAX_COMPRESSION_RATIO
            _require_stored(shown, h5py.Dataset(found), ratio)


def whole(dataset: h5py.Dataset) -> Any:
    """All of a dataset; `FileError` where it has no values or does not fit into memory."""
    if dataset.shape is None:
        raise FileError(f"{_shown(dataset.name)}: expected values, found an empty dataset")
    if dataset.nbytes > UNCHECKED_BYTES and dataset.nbytes > (free := available()):
        raise FileError(
            f"{_shown(dataset.name)}: expected at most the {free} bytes of memory that are free, "
            f"found {dataset.nbytes} of shape {dataset.shape}"
        )
    return dataset[()]


def texts(dataset: h5py.Dataset) -> list[str]:
    """The texts (n,) of a dataset, UTF-8; `FileError` for others."""
    found: list[str] = []
    size = 0
    for entry in range(len(dataset)):
        # One after the other: all may be one long text that is stored once.
        found.append(decoded(_shown(dataset.name), dataset[entry]))
        size += len(found[-1])
        if size > MOST_TEXT:
            raise FileError(f"{_shown(dataset.name)}: expected at most {MOST_TEXT} bytes of text")
    return found


def attribute(owner: h5py.Group | h5py.Dataset, name: str) -> Any:
    """An attribute; KeyError if it is not there, `FileError` for a long one or wrong text."""
    stored = owner.attrs.get_id(name)
    size = stored.get_storage_size()
    if size > MOST_TEXT:
        raise FileError(f"attribute {name!r}: expected at most {MOST_TEXT} bytes, found {size}")
    value = owner.attrs[name]
    return decoded(f"attribute {name!r}", value) if isinstance(value, str | bytes) else value


def decoded(name: str, value: str | bytes) -> str:
    """Text that is UTF-8; `FileError` for other bytes, which h5py passes on as surrogates."""
    try:
        if isinstance(value, bytes):
            return value.decode()
        value.encode()
    except UnicodeError as error:
        raise FileError(f"{name}: expected text in UTF-8, found {value!r:.80}") from error
    return value


def _require_stored(name: str, dataset: h5py.Dataset, ratio: int) -> None:
    plist = dataset.id.get_create_plist()
    if plist.get_external_count():
        raise FileError(f"{name}: expected numbers in this file, found them in another (external)")
    if dataset.is_virtual:
        raise FileError(f"{name}: expected numbers in this file, found a virtual dataset")
    declared, stored = _declared(dataset), dataset.id.get_storage_size()
    if declared > max(MAX_SPARSE_BYTES, ratio * stored):
        raise FileError(
            f"{name}: expected at most {ratio} times what is stored, {stored} bytes, found "
            f"{declared} of shape {dataset.shape}"
        )


def _declared(dataset: h5py.Dataset) -> int:
    size = int(dataset.id.get_type().get_size())
    for length in dataset.shape or ():
        size *= int(length)
    return size


def _shown(name: str | bytes) -> str:
    """A name as paths of a file are written, in one line."""
    text = name.decode(errors="backslashreplace") if isinstance(name, bytes) else name
    text = text.removeprefix("/")
    return text if text.isprintable() else repr(text)[1:-1]
