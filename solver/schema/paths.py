"""Paths of files that a model names: in model files relative to these, absolute in Python."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Annotated, Any

from ...files.outputs import resolved
from ...inputs import Shown
from .entry import FieldSpec

# characters; systems refuse longer names with errors that do not name the key
MAX_PATH_LENGTH = 1000
# A context variable, not a global one: threads may read models of different folders.
_FOLDER: ContextVar[Path] = ContextVar("folder", default=Path())


@contextmanager
def beside(folder: Path) -> Iterator[None]:
    """Let paths that are read and written be relative to a folder."""
    token = _FOLDER.set(folder)
    try:
        yield
    finally:
        _FOLDER.reset(token)


def relative(path: str, folder: Path) -> str:
    """A path as files in a folder give it."""
    return Path(os.path.relpath(resolved(Path(path)), resolved(folder))).as_posix()


def _store(value: Any) -> str:
    path = os.fspath(value)
    if not (isinstance(path, str) and path.isprintable() and 0 < len(path) <= MAX_PATH_LENGTH):
        raise ValueError
    # Not resolved: a link in a user's project keeps its name in messages and written files.
    return os.path.abspath(_FOLDER.get() / path)


def _in_file(path: str) -> str:
    return relative(path, _FOLDER.get())


_PATH = Annotated[Any, Shown(lambda: {"type": "string"})]
FilePath = Annotated[str, FieldSpec("the path of a file", _store, _PATH, _in_file)]
