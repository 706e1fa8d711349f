"""HDF5 files that are written as they grow and appear whole, also where the disk may fill up."""

import io
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py

from .outputs import renamed_when_whole


@contextmanager
def written_whole(path: Path) -> Iterator[h5py.File]:
    """A new HDF5 file, groups in the order of their making, that replaces `path` in the end.

    OSError where it cannot be written, and nothing is left of it then.
    """
    with renamed_when_whole(path) as temporary, temporary.open("r+b", buffering=0) as raw:
        store = _Store(raw)
        try:
            with h5py.File(store, "w", track_order=True) as file:
                yield file
        finally:
            if store.failure is not None:
                raise store.failure


class _Store(io.RawIOBase):
    """A file for h5py that keeps what goes wrong: HDF5 itself brings the process down."""

    def __init__(self, raw: io.FileIO) -> None:
        super().__init__()
        self._raw = raw
        self.failure: OSError | None = None

    def write(self, data: Any) -> int:
        view = memoryview(data).cast("B")
        if self.failure is None:
            try:
                written(self._raw, view)
            except OSError as error:
                self.failure = error
        return len(view)

    def readinto(self, buffer: Any) -> int:
        return self._raw.readinto(buffer)

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        return self._raw.seek(offset, whence)

    def tell(self) -> int:
        return self._raw.tell()

    def truncate(self, size: int | None = None) -> int:
        try:
            return self._raw.truncate(size)
        except OSError as error:
            self.failure = self.failure or error
            return size or 0

    def readable(self) -> bool:
        return True

    def writable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True


def written(raw: io.FileIO, view: memoryview) -> None:
    """Write all of it, which the system may do in parts."""
    while len(view):
        view = view[raw.write(view) :]
