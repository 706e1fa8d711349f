"""Paths that can be read as files."""

import os
import stat


class FileError(ValueError):
    """A file that is not what it should be, or that reaches beyond itself."""


def require_regular(path: str | os.PathLike[str]) -> None:
    """`FileError` for what is there but no regular file: a folder, a pipe that never ends, ...

    `FileNotFoundError` where nothing is there.
    """
    try:
        status = os.stat(path)
    except ValueError as error:
        raise FileError(f"no path of a file: {error}") from error
    if not stat.S_ISREG(status.st_mode):
        raise FileError(f"expected a regular file, found {_kind(status.st_mode)}")


def in_one_line(error: BaseException) -> str:
    """The text of an error, or its kind where it has none."""
    return " ".join(str(error).split()) or type(error).__name__


def _kind(mode: int) -> str:
    if stat.S_ISDIR(mode):
        return "a folder"
    return "a pipe" if stat.S_ISFIFO(mode) else "a device or socket"
