"""Lines of text files that may include others."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

from ...errors import MeshError


class Line(NamedTuple):
    """A line and its position, for messages."""

    location: str
    text: str


def lines(
    path: Path, included: Callable[[str], str | None], inside: tuple[Path, ...] = ()
) -> Iterator[Line]:
    """The lines of a file and of the files that it includes.

    `included` returns the path of the file that a line includes, or None; paths are relative to the
    including file.
    """
    path = path.resolve()
    if path in inside:
        raise MeshError(f"{path.name} includes itself")
    for number, text in enumerate(_text(path).splitlines(), 1):
        name = included(text)
        if name is None:
            yield Line(f"{path.name}, line {number}", text)
            continue
        target = path.parent / name.replace("\\", "/")
        if not target.is_file():
            raise MeshError(f"{path.name}, line {number}: no file {name} to include")
        yield from lines(target, included, (*inside, path))


def _text(path: Path) -> str:
    data = path.read_bytes()
    try:
        return data.decode()
    except (
        UnicodeDecodeError
    ):  # older programs write in the code page of their country; latin-1 has a letter for all
        return data.decode("latin-1")
