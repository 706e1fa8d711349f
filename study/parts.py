"""Files that are written under names of their own, so that a file with its proper name is no longer written."""

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

SUFFIX = ".part.h5"


@contextmanager
def renamed_at_the_end(target: Path) -> Iterator[Path]:
    """A file of this process's own, which takes the name of the target when a run is over, even where it failed.

    A worker that everybody takes for dead may still write while another one runs its case again.
    """
    part = target.with_name(f"{target.stem}.{socket.gethostname()}-{os.getpid()}{SUFFIX}")
    try:
        yield part
    finally:
        if part.exists():
            part.replace(target)


def remove_parts(folder: Path) -> None:
    """Remove what workers that were killed have left."""
    for part in folder.glob(f"*{SUFFIX}"):
        part.unlink(missing_ok=True)
