"""The projects of `duhamel init` and `tutorial`: a folder each, copied with the schemas."""

import json
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal

from ...files.outputs import in_words

__all__ = ["StarterError", "commands", "make"]

StarterKind = Literal["beam", "solid", "mechanism", "tutorial"]
MODEL_NAMES = ("model.toml", "knock.toml")
README_NAME = "README.md"
SCHEMA_FOLDER = "schemas"


class StarterError(ValueError):
    """A folder in which no project can be made."""


def make(kind: StarterKind, folder: Path, schemas: Mapping[str, Any]) -> None:
    """Write the starter project of a kind into a folder that is empty, or is made.

    schemas: of TOML files, by "body" and "model"; the first line of each file names its own, for
    editors. `StarterError` for a folder that holds something or cannot be written; what was written
    then is removed.
    """
    made: list[Path] = []
    try:
        if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
            raise StarterError(f"{folder}: expected a new or an empty folder: nothing is replaced")
        for name, content in _files(kind, schemas):
            path = folder / name
            # Noted before they are made, so that a full disk leaves nothing behind.
            made += [part for part in (path, *path.parents) if not part.exists()]
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
    except OSError as error:
        _remove(made)
        raise StarterError(f"{folder}: no project can be written: {in_words(error)}") from error


def commands(kind: StarterKind) -> list[str]:
    """What to do first in a project: the commands of the first block of its README_NAME."""
    found: list[str] = []
    for line in _template(kind).joinpath(README_NAME).read_text(encoding="utf-8").splitlines():
        if line.startswith("    duhamel "):
            found.append(line.partition("#")[0].strip())
        elif found:
            break
    return found


def _files(kind: StarterKind, schemas: Mapping[str, Any]) -> Iterator[tuple[str, bytes]]:
    """The files of a project by their names, and what is in them."""
    for path in sorted(_template(kind).iterdir()):
        content = path.read_bytes()
        if path.suffix == ".toml":
            name = "model" if path.name in MODEL_NAMES else "body"
            content = f"#:schema {SCHEMA_FOLDER}/{name}.json\n".encode() + content
        yield path.name, content
    for name in ("body", "model"):
        yield f"{SCHEMA_FOLDER}/{name}.json", f"{json.dumps(schemas[name], indent=2)}\n".encode()


def _template(kind: StarterKind) -> Path:
    return Path(__file__).with_name(f"{kind}-project")


def _remove(made: list[Path]) -> None:
    """Remove files and folders that were just made, those within others first."""
    for path in sorted(set(made), key=lambda path: len(path.parts), reverse=True):
        with suppress(OSError):
            path.rmdir() if path.is_dir() else path.unlink()
