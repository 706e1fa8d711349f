"""The folder in which compiled code is kept: one to which nobody writes but its user.

Machine code runs with the rights of the user who loads it. So the folder and each file in it must
belong to this user or to root, and nobody else may write to them. A file is opened relative to the
folder that was checked, and links within it are not followed: neither a link that somebody has
planted nor a folder that is exchanged between the check and the use is followed elsewhere.
"""

import os
import shutil
import stat
import sys
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from fnmatch import fnmatch
from functools import cache
from pathlib import Path

from ...files.handles import BINARY_FLAG
from .digests import checked_code

BY_FOLDER = os.open in os.supports_dir_fd and os.scandir in os.supports_fd
"""whether files can be opened relative to an open folder; not on Windows, where the folders of
users are kept apart"""
NO_FOLLOW_FLAGS = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
"""flags by which links are not followed and a pipe does not wait for its other end"""


class NotPrivateError(OSError):
    """A file or a folder that another user owns or may write to, or that is a link or a pipe."""


@dataclass(frozen=True)
class Cache:
    """A folder of this user, open as `handle` where the system can open files relative to it."""

    path: Path
    handle: int | None

    def read(self, name: str) -> bytes:
        """The content of a file; OSError if there is none, `NotPrivateError` if it is not ours."""
        with os.fdopen(self._open(name, os.O_RDONLY), "rb") as file:
            return file.read()

    def write(self, name: str, content: bytes) -> None:
        """Write a file, whole or not at all."""
        part = f"{Path(name).stem}.{os.getpid()}.part"
        with suppress(FileNotFoundError):
            self._remove(part)
        try:
            made = self._open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL)
            with os.fdopen(made, "wb") as file:
                file.write(content)
            os.replace(
                self._at(part), self._at(name), src_dir_fd=self.handle, dst_dir_fd=self.handle
            )
        except BaseException:
            with suppress(OSError):
                self._remove(part)
            raise

    @contextmanager
    def locked(self) -> Iterator[None]:
        """One process at a time; all at once where nothing can be locked."""
        with ExitStack() as stack:
            with suppress(OSError, ImportError):  # a folder that cannot be written to; Windows
                import fcntl

                handle = self._open("lock", os.O_RDWR | os.O_CREAT)
                stack.callback(os.close, handle)
                fcntl.flock(handle, fcntl.LOCK_EX)
            yield

    def remove_oldest(self, pattern: str, kept: int) -> None:
        """Remove files or folders but for the newest ones; other processes may be quicker."""
        with suppress(OSError):
            with os.scandir(self.path if self.handle is None else self.handle) as entries:
                found = [entry for entry in entries if fnmatch(entry.name, pattern)]
            found.sort(key=lambda entry: entry.stat(follow_symlinks=False).st_mtime)
            for old in found[:-kept]:
                if old.is_dir(follow_symlinks=False):
                    shutil.rmtree(self._at(old.name), ignore_errors=True, dir_fd=self.handle)
                else:
                    self._remove(old.name)

    def _open(self, name: str, flags: int) -> int:
        flags |= NO_FOLLOW_FLAGS | BINARY_FLAG
        handle = os.open(self._at(name), flags, 0o600, dir_fd=self.handle)
        status = os.fstat(handle)
        if not (stat.S_ISREG(status.st_mode) and is_private(status)):
            os.close(handle)
            raise NotPrivateError(
                f"{self.path / name} is not used: another user owns it or may write to it"
            )
        return handle

    def _at(self, name: str) -> str | Path:
        return self.path / name if self.handle is None else name

    def _remove(self, name: str) -> None:
        os.unlink(self._at(name), dir_fd=self.handle)


@contextmanager
def opened_cache(make: bool = False) -> Iterator[Cache]:
    """The folder of compiled code, open; OSError where there is none, made before if so wished."""
    folder = cache_folder()
    if make:
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    handle = _open_folder(folder)
    try:
        yield Cache(folder, handle)
    finally:
        if handle is not None:
            os.close(handle)


def kept_content(name: str) -> bytes | None:
    """What a file holds before its digest; None where there is none, or not a whole one of ours."""
    try:
        with opened_cache() as folder:
            content = folder.read(name)
    except NotPrivateError as refusal:
        tell_once(str(refusal))
        return None
    except OSError:
        return None
    return checked_code(content)


def cache_folder() -> Path:
    """Where compiled code is, or will be, kept: a folder that is private, or not yet there.

    DUHAMEL_CACHE, or the user's folder of caches; the next place, after a warning, where another
    user could write to that. `NotPrivateError` where that is so of all places.
    """
    refusal: NotPrivateError | None = None
    for folder in dict.fromkeys(_places()):
        if refusal is not None:
            tell_once(f"{refusal}; {folder} is tried instead")
        try:
            handle = _open_folder(folder)
        except NotPrivateError as error:
            refusal = error
            continue
        except OSError:  # it is not there yet
            return folder
        if handle is not None:
            os.close(handle)
        return folder
    assert refusal is not None
    raise refusal


def _places() -> Iterator[Path]:
    """Folders for compiled code, in the order in which they are tried."""
    if given := os.environ.get("DUHAMEL_CACHE"):
        yield Path(given)
    import platformdirs

    yield Path(platformdirs.user_cache_dir("duhamel", appauthor=False))
    if hasattr(os, "geteuid"):
        yield Path(tempfile.gettempdir()) / f"duhamel-{os.geteuid()}"


def _open_folder(folder: Path) -> int | None:
    """The folder, open; None where the system opens none. `NotPrivateError` where it is not ours.

    A link to it may be one of our own or of root.
    """
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY) if BY_FOLDER else None
    status = folder.stat() if handle is None else os.fstat(handle)
    if is_private(status) and _is_ours(folder.lstat()):
        return handle
    if handle is not None:
        os.close(handle)
    raise NotPrivateError(
        f"the folder {folder} is not used for compiled code: another user owns it or may write "
        f"to it (expected a folder of your own, as by chmod 700)"
    )


def is_private(status: os.stat_result) -> bool:
    """True where nobody writes but this user and root."""
    others = status.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
    return _is_ours(status) and (not others or not hasattr(os, "geteuid"))


def _is_ours(status: os.stat_result) -> bool:
    """True for what belongs to this user or to root; on Windows, where one cannot tell, always."""
    return not hasattr(os, "geteuid") or status.st_uid in (0, os.geteuid())


@cache
def tell_once(message: str) -> None:
    """Tell the user on stderr, once in a process."""
    print(f"duhamel: {message}", file=sys.stderr, flush=True)
