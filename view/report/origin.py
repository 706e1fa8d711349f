"""Where results come from: their file, the program that wrote it, and the model."""

import tomllib
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from itertools import takewhile
from pathlib import Path
from typing import Any

import h5py

from ...results import Results


@dataclass(frozen=True)
class Origin:
    """Where results come from.

    path: of the results file, None for results in memory; written: when; created_by: the program
    and its version; version: of the file.
    """

    path: Path | None
    written: datetime | None = None
    created_by: str = ""
    version: str = ""

    @property
    def name(self) -> str:
        return self.path.stem if self.path else "results in memory"


def origin(results: Results) -> Origin:
    """The file of results, of which the date is that of its last change."""
    path = Path(results.name)
    try:
        written = datetime.fromtimestamp(path.stat().st_mtime).astimezone()
        with h5py.File(path, "r") as file:
            created_by, version = (
                str(file.attrs.get(key, "")) for key in ("created_by", "version")
            )
    except (OSError, ValueError):
        return Origin(None)
    return Origin(path, written, created_by, version)


def opening(model: str) -> str:
    """The comment that a model file begins with, as one paragraph; not what editors read of it."""
    lines = (line.strip() for line in model.lstrip().splitlines())
    comments = takewhile(lambda line: line.startswith("#"), lines)
    words = (line.lstrip("#").strip() for line in comments if not line.startswith("#:"))
    return " ".join(filter(None, words))


def tables(model: str) -> dict[str, Any]:
    """The tables of a model file; none where the text is none."""
    with suppress(tomllib.TOMLDecodeError, RecursionError):
        return tomllib.loads(model)
    return {}
