"""Files that a killed process leaves whole: their changes are gathered and take place at once.

HDF5 writes to a `JournaledFile` as to any file. What it writes beyond the end is appended, where
nobody looks yet; what replaces other bytes stays in memory until `commit`:

    1. what could not be appended before is, or the disk is full
    2. pages that replace others are written to the journal, with a digest
    3. they are written to the file, while nobody else has it open
    4. the journal is emptied

A process that dies before the journal is whole leaves the file as it was; one that dies later
leaves a journal from which `recover` ends step 3. The disk may be full in steps 1 and 2 alone.
"""

import errno
import hashlib
import io
import os
import shutil
import signal
import struct
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from ..files.handles import BINARY_FLAG, lock, read_at, readers_lock, unlock, write_at
from ..files.outputs import replace_durably
from .errors import ResultsError

# Files are compared and replaced by pages of this size: HDF5 changes a few bytes in many places.
PAGE_BYTES = 1 << 14
# Ahead of the records: the process that writes, and its file.
HEADER_BYTES = 128
# An address and a number of bytes. In the first record these are the size of the file, and that of
# all other records.
RECORD_LAYOUT = struct.Struct("<QQ")
# A run writes here while earlier results stand at its path: a run that fails keeps them.
PARTIAL_SUFFIX = ".partial"
# Length of a SHA-256.
DIGEST_BYTES = 32


class BusyError(OSError):
    """Others have the file open."""


class Journal:
    """The journal of the results at a path, held by one process at a time.

    `ResultsError` where another run holds it. It is a hidden file beside the results, and goes when
    the run ends; that of a process that died is taken over by the next.
    """

    def __init__(self, target: Path) -> None:
        self.target, self.path = target, journal_of(target)
        self._handle = _held(self.path)
        if self._handle is None:
            raise ResultsError(f"another run writes to this file ({_writer_of(self.path)})")
        _replay(self._handle, target)

    def begin(self, file: Path) -> None:
        """Start the journal of a file, which stands beside the target."""
        which = "partial" if file == partial_of(self.target) else "whole"
        header = f"duhamel journal, process {os.getpid()}\n{which}\n"
        os.ftruncate(self._descriptor, 0)
        write_at(self._descriptor, header.encode().ljust(HEADER_BYTES, b"\0"), 0)

    def write(self, size: int, pieces: list[tuple[int, bytes]], durable: bool) -> None:
        """Keep what is to be done: pieces of the file by address, and its size afterwards."""
        records = b"".join(RECORD_LAYOUT.pack(at, len(piece)) + piece for at, piece in pieces)
        # The digest tells a whole journal from one that a crash cut off, in one write.
        content = RECORD_LAYOUT.pack(size, len(records)) + records
        try:
            # Behind the header, which stays: it names the process and the file.
            write_at(self._descriptor, content + hashlib.sha256(content).digest(), HEADER_BYTES)
            if durable:
                os.fsync(self._descriptor)
        except OSError:
            self.clear()
            raise

    def clear(self) -> None:
        os.ftruncate(self._descriptor, HEADER_BYTES)

    def close(self) -> None:
        if self._handle is None:
            return
        handle, self._handle = self._handle, None
        try:
            self.path.unlink(missing_ok=True)
            remains = False
        except PermissionError:  # Windows removes no file that is open
            remains = True
        os.close(handle)
        if remains:
            with suppress(PermissionError):  # the next run has begun with it
                self.path.unlink(missing_ok=True)

    def __del__(self) -> None:
        if getattr(self, "_handle", None) is not None:
            self.close()

    @property
    def _descriptor(self) -> int:
        if self._handle is None:
            raise ResultsError("the run has ended")
        return self._handle


def journal_of(target: Path) -> Path:
    return target.with_name(f".{target.name}.journal")


def partial_of(target: Path) -> Path:
    """The file of a run while earlier results stand at the path that it is to have."""
    return target.with_name(target.name + PARTIAL_SUFFIX)


def recover(file: Path) -> None:
    """End what a process that died was about to write to a file, or to the partial one there."""
    _recover(file)
    if file.name.endswith(PARTIAL_SUFFIX):
        _recover(file.with_name(file.name.removesuffix(PARTIAL_SUFFIX)))


def _recover(target: Path) -> None:
    path = journal_of(target)
    try:
        # An empty journal, so that readers of a running simulation take no lock.
        if path.stat().st_size <= HEADER_BYTES:
            return
        handle = _held(path)
    except OSError:
        return
    if handle is not None:
        try:
            _replay(handle, target)
        finally:
            os.close(handle)


def _held(path: Path) -> int | None:
    """A descriptor of the file, locked; None while another process or run holds it."""
    while True:
        handle = os.open(path, os.O_RDWR | os.O_CREAT | BINARY_FLAG, 0o666)
        if not lock(handle):
            os.close(handle)
            return None
        try:  # the run that held it may have removed it
            if os.path.samestat(os.fstat(handle), path.stat()):
                return handle
        except FileNotFoundError:
            pass
        os.close(handle)


def _writer_of(path: Path) -> str:
    """The process that a journal names."""
    with path.open("rb") as file:
        return (
            file.read(HEADER_BYTES).partition(b", ")[2].partition(b"\n")[0].decode(errors="replace")
        )


def _replay(handle: int, target: Path) -> None:
    """Do what a whole journal says, and empty it; nothing where the file is gone."""
    content = read_at(handle, os.fstat(handle).st_size, 0)
    header, body, digest = (
        content[:HEADER_BYTES],
        content[HEADER_BYTES:-DIGEST_BYTES],
        content[-DIGEST_BYTES:],
    )
    # A journal that is not whole changed nothing yet: the file is as it was committed.
    if len(body) >= RECORD_LAYOUT.size and hashlib.sha256(body).digest() == digest:
        path = partial_of(target) if header.split(b"\n")[1] == b"partial" else target
        # The user may have removed the results of the run that died.
        with suppress(FileNotFoundError), path.open("r+b", buffering=0) as file:
            size, _ = RECORD_LAYOUT.unpack_from(body)
            for at, piece in _records(body[RECORD_LAYOUT.size :]):
                write_at(file.fileno(), piece, at)
            # Bytes beyond were appended by a commit that never took place.
            os.ftruncate(file.fileno(), size)
            os.fsync(file.fileno())
    # Emptied only after the file is on the disk: repeating a replay does no harm.
    os.ftruncate(handle, min(len(content), HEADER_BYTES))


def _records(content: bytes) -> Iterator[tuple[int, bytes]]:
    first = 0
    while first < len(content):
        at, length = RECORD_LAYOUT.unpack_from(content, first)
        first += RECORD_LAYOUT.size
        yield at, content[first : first + length]
        first += length


def _pages_of(at: int, n: int) -> range:
    """The numbers of the pages that n bytes touch."""
    return range(at // PAGE_BYTES, -(-(at + n) // PAGE_BYTES))


class JournaledFile(io.RawIOBase):
    """A file for h5py.File(file, "r+"), whose changes take place when they are committed.

    durable: a commit has reached the disk when it returns, whatever becomes of the machine.
    """

    def __init__(self, path: Path, journal: Journal, durable: bool) -> None:
        super().__init__()
        self.path, self._journal, self._durable = path, journal, durable
        self._handle = os.open(path, os.O_RDWR | BINARY_FLAG)
        # committed: what readers see; reach: how far bytes are on the disk; size: as HDF5 sees the
        # file.
        self._committed = self._reach = self._size = os.fstat(self._handle).st_size
        self._pages: dict[int, bytes] = {}
        self._at = 0
        journal.begin(path)

    @property
    def waiting(self) -> int:
        """Bytes in memory."""
        return PAGE_BYTES * len(self._pages)

    def readable(self) -> bool:
        return True

    def writable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        start = {os.SEEK_SET: 0, os.SEEK_CUR: self._at, os.SEEK_END: self._size}[whence]
        self._at = start + offset
        return self._at

    def tell(self) -> int:
        return self._at

    def readinto(self, buffer: Any) -> int:
        view = memoryview(buffer).cast("B")
        n = max(min(len(view), self._size - self._at), 0)
        view[:n] = self._content(self._at, n)
        self._at += n
        return n

    def write(self, data: Any) -> int:
        view = memoryview(data).cast("B")
        if not self._is_appended(view):
            self._keep(view)
        self._at += len(view)
        self._size = max(self._at, self._size)
        return len(view)

    def _is_appended(self, view: memoryview) -> bool:
        """Write what lies beyond the committed end at once, if the disk has room."""
        numbers = _pages_of(self._at, len(view))
        # Pages in memory hide those on the disk, and readers must not see half a change.
        if numbers.start * PAGE_BYTES < self._committed or not self._pages.keys().isdisjoint(
            numbers
        ):
            return False
        try:
            write_at(self._handle, view, self._at)
        except OSError:  # HDF5 would not survive it; `commit` tries again
            return False
        self._reach = max(self._reach, self._at + len(view))
        return True

    def _keep(self, view: memoryview) -> None:
        first, end = self._at, self._at + len(view)
        for number in _pages_of(first, len(view)):
            start = number * PAGE_BYTES
            low, high = max(first, start), min(end, start + PAGE_BYTES)
            # Whole pages are kept, so that reading needs no list of pieces within a page.
            page = bytes(view[low - first : high - first])
            if len(page) < PAGE_BYTES:
                old = self._content(start, PAGE_BYTES)
                page = old[: low - start] + page + old[high - start :]
            self._pages[number] = page

    def truncate(self, size: int | None = None) -> int:
        self._size = self._at if size is None else size
        return self._size

    def _content(self, at: int, n: int) -> bytes:
        """n bytes as they will be, zeros beyond the end."""
        # Reading beyond the reach would give fewer bytes; HDF5 expects zeros there.
        stored = max(min(n, self._reach - at), 0)
        content = bytearray(read_at(self._handle, stored, at).ljust(n, b"\0"))
        for number in _pages_of(at, n):
            if (page := self._pages.get(number)) is not None:
                start = number * PAGE_BYTES
                low, high = max(at, start), min(at + n, start + PAGE_BYTES)
                content[low - at : high - at] = page[low - start : high - start]
        return bytes(content)

    def commit(self, patience: float) -> None:
        """Let the changes take place; `BusyError` if others have the file open for so many seconds.

        OSError leaves the file as it was: the disk is full, or somebody has removed the file.
        """
        # Writing on would go to a file that has no name any more, and be lost without a word.
        if not os.path.samestat(os.fstat(self._handle), self.path.stat()):
            raise FileExistsError(errno.EEXIST, "another program has replaced it")
        replaced = self._append()
        if self._durable:
            os.fsync(self._handle)
        # From here on a crash is repaired by `recover`.
        self._journal.write(self._size, replaced, self._durable)
        try:
            with self._alone(patience):
                self._replace(replaced)
        except BusyError:
            self._journal.clear()
            raise
        self._journal.clear()
        self._committed = self._reach = self._size
        self._pages = {}

    def _replace(self, pieces: list[tuple[int, bytes]]) -> None:
        for at, piece in pieces:
            write_at(self._handle, piece, at)
        os.ftruncate(self._handle, self._size)
        if self._durable:
            os.fsync(self._handle)

    def move_to_copy(self) -> None:
        """Go on in a copy that takes the place of the file; others keep the one that they opened.

        OSError where it cannot be made.
        """
        # Hidden and on the same file system, so that the replacement is atomic.
        copy = self._journal.path.with_suffix(".copy")
        try:
            shutil.copyfile(self.path, copy)
            handle = os.open(copy, os.O_RDWR | BINARY_FLAG)
            if self._durable:
                replace_durably(copy, self.path)
            else:
                copy.replace(self.path)
        finally:
            copy.unlink(missing_ok=True)
        os.close(self._handle)
        self._handle = handle

    def close(self) -> None:
        """Close the file as it was committed last."""
        if not self.closed:
            os.ftruncate(self._handle, self._committed)
            os.close(self._handle)
        super().close()

    def _append(self) -> list[tuple[int, bytes]]:
        """Write what lies beyond the end of the file; the pieces that replace others."""
        replaced = []
        for at, piece in self._pieces():
            # The part of the page before the committed end, which readers may be looking at.
            inside = max(min(self._committed - at, len(piece)), 0)
            if piece[inside:]:
                write_at(self._handle, piece[inside:], at + inside)
            # HDF5 often writes what is there already; unchanged bytes need no journal.
            if inside and read_at(self._handle, inside, at) != piece[:inside]:
                replaced.append((at, piece[:inside]))
        return replaced

    def _pieces(self) -> Iterator[tuple[int, bytes]]:
        """The changed pages below the size, by address."""
        for number in sorted(self._pages):
            at = number * PAGE_BYTES
            if at < self._size:
                yield at, self._pages[number][: self._size - at]

    @contextmanager
    def _alone(self, patience: float) -> Iterator[None]:
        if not readers_lock():
            yield
            return
        deadline = time.monotonic() + patience
        # flock itself has no time limit.
        while not lock(self._handle):
            if time.monotonic() > deadline:
                raise BusyError(errno.EWOULDBLOCK, "others have it open")
            time.sleep(0.005)
        try:
            yield
        finally:
            unlock(self._handle)


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Let an interrupt (Ctrl-C) wait until the block has ended.

    A handler that is not Python's own, as Gmsh installs one, cannot be put back: Python's is.
    """
    if threading.current_thread() is not threading.main_thread():
        yield  # no other thread is ever interrupted
        return
    caught: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, frame: caught.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler if before is None else before)
        if caught:
            signal.raise_signal(signal.SIGINT)
