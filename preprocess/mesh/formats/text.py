"""Lines of text files that may include others."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

from ....files import require_regular
from ...errors import MeshError

MOST_FILES = 1000  # that may be read for one mesh, each as often as it is included
MAX_INCLUDE_DEPTH = 20
INTEGER_PATTERN = re.compile(r"[+-]?\d{1,18}")
"""An integer of 64 bits; int() would take underscores and blanks too."""


class Line(NamedTuple):
    """A line and its position, for messages."""

    location: str
    text: str


Included = Callable[[str], str | None]
"""the path of the file that a line includes, or None"""


def lines(
    path: Path, included: Included, read: list[Path] | None = None, inside: tuple[Path, ...] = ()
) -> Iterator[Line]:
    """The lines of a file and of the files that it includes.

    Paths that `included` finds are relative to the including file. read: gets the paths of all
    files that have been read; inside: those in which this one is included.
    """
    path, read = path.resolve(), [] if read is None else read
    if path in inside:
        raise MeshError(f"{path.name} includes itself")
    if len(read) == MOST_FILES or len(inside) == MAX_INCLUDE_DEPTH:
        raise MeshError(
            f"{path.name}: expected at most {MOST_FILES} files, {MAX_INCLUDE_DEPTH} deep, that are "
            "included"
        )
    read.append(path)
    for number, text in enumerate(_text(path).splitlines(), 1):
        name = included(text)
        if name is None:
            yield Line(f"{path.name}, line {number}", text)
            continue
        target = path.parent / name.replace("\\", "/")
        if not target.is_file():
            raise MeshError(f"{path.name}, line {number}: no file {name} to include")
        yield from lines(target, included, read, (*inside, path))


def files(path: Path, included: Included) -> list[Path]:
    """A file and all that it includes."""
    read: list[Path] = []
    for _ in lines(path, included, read):
        pass
    return read


def _text(path: Path) -> str:
    require_regular(path)
    data = path.read_bytes()
    try:
        return data.decode()
    except (
        UnicodeDecodeError
    ):  # older programs write in the code page of their country; latin-1 has a letter for all
        return data.decode("latin-1")
