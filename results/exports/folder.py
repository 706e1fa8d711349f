"""Folders that results are written into, and names in them."""

import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from ...files.outputs import in_words, remove_orphans, resolved, temporary_prefix
from ..errors import ExportError

# Hidden folders of an unfinished export are named after it.
UNFINISHED_NAME = "export"
# Characters. File systems end names at 255 bytes, and a character may take several.
MAX_FILE_NAME = 100


class Export:
    """Files that are written beside their folder's other files, and appear there in the end."""

    def __init__(self, folder: Path, temporary: Path) -> None:
        self.folder = folder
        self._temporary = temporary
        self._names: list[str] = []

    @contextmanager
    def file(self, name: str) -> Iterator[Path]:
        """Where to write a file of this name; `ExportError` names it where that fails."""
        self._names.append(name)
        with _failures_named(self.folder / name):
            yield self._temporary / name

    @property
    def paths(self) -> tuple[Path, ...]:
        """Where the files are in the end, in the order in which they were written."""
        return tuple(self.folder / name for name in self._names)

    def appear(self) -> None:
        for name in self._names:
            with _failures_named(self.folder / name):
                shutil.move(self._temporary / name, resolved(self.folder / name))


@contextmanager
def exported(folder: str | os.PathLike[str]) -> Iterator[Export]:
    """Files for a folder, which is made with those above it if it is not there.

    All of them appear when the block ends without an error. With one, the folder and its files stay
    as they were, and folders that were made are removed. What exports that were killed left there
    is removed too. `ExportError` where it cannot be made.
    """
    place = Path(folder)
    made, unfinished = _make(place), place / UNFINISHED_NAME
    try:
        with _failures_named(place):
            # Folders of exports that were killed, on this machine.
            remove_orphans(unfinished)
            prefix = temporary_prefix(unfinished)
            # Within the folder itself: only on the same disk are files moved without copying.
            with tempfile.TemporaryDirectory(prefix=prefix, dir=place) as temporary:
                export = Export(place, Path(temporary))
                yield export
                # Only here, when all files are whole.
                export.appear()
    # Also for Ctrl-C.
    except BaseException:
        for path in made:
            shutil.rmtree(path, ignore_errors=True)
        raise


def _make(folder: Path) -> list[Path]:
    """Make a folder and those above it; the ones that were not there, innermost first."""
    try:
        missing = [path for path in (folder, *folder.parents) if not path.exists()]
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        raise ExportError(f"{folder}: cannot be made a folder: {in_words(error)}") from error
    if not os.access(folder, os.W_OK):
        raise ExportError(f"{folder}: cannot be written into")
    return missing


@contextmanager
def _failures_named(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise ExportError(f"{path}: cannot be written: {in_words(error)}") from error


def distinct(names: Iterable[str], longest: int = MAX_FILE_NAME) -> list[str]:
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
