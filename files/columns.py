"""Tables of comma-separated values (RFC 4180), written whole, numbers so that they read back."""

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from .outputs import renamed_when_whole


def write_rows(
    path: Path, rows: Iterable[Sequence[Any]], failure: type[Exception] | None = None
) -> None:
    """Write a table of cells; OSError, or a `failure` that names the file, if it cannot be written.

    Cells are text and numbers of Python, which are written with as few digits as read back to the
    same number. The encoding is UTF-8, lines end in CR LF, and cells with commas, quotes or ends of
    lines are quoted.
    """
    with (
        renamed_when_whole(path, failure=failure) as temporary,
        temporary.open("w", encoding="utf-8", newline="") as file,
    ):
        csv.writer(file).writerows(rows)
