"""SHA-256 of files that many cases name, each computed once while it does not change."""

from functools import cache
from pathlib import Path

from ..superelement import sha256


def digest(path: Path) -> str:
    """The SHA-256 of a file; OSError if it cannot be read."""
    status = path.stat()
    return _digest(path, status.st_mtime_ns, status.st_size)


@cache
def _digest(path: Path, modified: int, size: int) -> str:
    return sha256(path)
