"""Folders that results are written into, and names in them."""

import os
from collections.abc import Iterable
from pathlib import Path

from ..errors import ExportError

LONGEST = 100
"""characters of the name of a file"""


def made(folder: str | os.PathLike[str]) -> Path:
    """A folder, made with those above it if it is not there; `ExportError` if it cannot be."""
    path = Path(folder)
    try:
        path.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        raise ExportError(f"{path}: cannot be made a folder: {error}") from error
    if not os.access(path, os.W_OK):
        raise ExportError(f"{path}: cannot be written into")
    return path


def distinct(names: Iterable[str], longest: int = LONGEST) -> list[str]:
    """The names, cut to a length, with numbers behind those that others have already.

    Small and capital letters count as the same, as they do in the names of files of some systems.
    """
    taken: set[str] = set()
    found = []
    for name in names:
        number, chosen = 1, name[:longest]
        while chosen.lower() in taken:
            number += 1
            chosen = f"{name[: longest - 1 - len(str(number))]}_{number}"
        taken.add(chosen.lower())
        found.append(chosen)
    return found
