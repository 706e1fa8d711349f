"""Open files by their handles, the same on every system: bytes at a place, and locks."""

import errno
import os
from contextlib import suppress
from importlib import import_module
from typing import Any

BINARY_FLAG = getattr(os, "O_BINARY", 0)
"""without it Windows writes two bytes for the end of a line"""
ERRNOS_WITHOUT_LOCKS = {errno.ENOLCK, errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOSYS}
"""what network and container file systems without locks answer; then nothing is to be waited for"""
LOCKED_BYTE = (1 << 31) - 2
"""the byte that stands for a whole file on Windows, which locks bytes: far behind the end of small
files, and where a `long` still reaches"""


def read_at(handle: int, n: int, at: int) -> bytes:
    """Up to n bytes from a place on; Windows has no `pread`, and moves the handle."""
    if hasattr(os, "pread"):
        return os.pread(handle, n, at)
    os.lseek(handle, at, os.SEEK_SET)
    return os.read(handle, n)


def write_at(handle: int, content: bytes | memoryview, at: int) -> None:
    """Write all of the content from a place on, which the system may do in parts."""
    view = memoryview(content)
    while view:
        if hasattr(os, "pwrite"):
            written = os.pwrite(handle, view, at)
        else:
            os.lseek(handle, at, os.SEEK_SET)
            written = os.write(handle, view)
        view, at = view[written:], at + written


def readers_lock() -> bool:
    """Whether HDF5 locks the files that it opens: by flock, which Windows does not have."""
    try:
        import_module("fcntl")
    except ImportError:
        return False
    return True


def lock(handle: int) -> bool:
    """Lock a file for this handle alone; False while others have it locked.

    By flock, as HDF5 does; on Windows by `LOCKED_BYTE`. Where there are no locks all is taken to be
    free.
    """
    try:
        import fcntl
    except ImportError:
        return _lock_byte(handle)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError as error:
        if error.errno not in ERRNOS_WITHOUT_LOCKS:
            raise
    return True


def unlock(handle: int) -> None:
    """End a lock; closing the handle does it as well."""
    with suppress(ImportError, OSError):
        import fcntl

        fcntl.flock(handle, fcntl.LOCK_UN)


def _lock_byte(handle: int) -> bool:
    try:
        msvcrt: Any = import_module("msvcrt")
    except ImportError:
        return True
    os.lseek(handle, LOCKED_BYTE, os.SEEK_SET)
    try:
        msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
    except OSError:
        return False
    return True
