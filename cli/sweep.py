"""The progress of `duhamel sweep`, its failures at the end, and what an interrupt leaves."""

import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import typer

from ..files.memory import gigabytes
from ..files.progress import Progress, Work
from ..study import Row
from ..study.sweep import OnBegin, OnFinished
from .failures import one_line


@contextmanager
def shown_cases(total: int) -> Iterator[OnFinished]:
    """Progress with the time that remains, and the warnings of the cases.

    An interrupt says how many cases are kept.
    """
    with Progress(Work(total=total, unit="cases")) as work:

        def finished(row: Row) -> None:
            work.advance(free=row.reused)
            for warning in row.warnings:
                typer.echo(one_line(f"warning: {row.case.name}: {warning}"), err=True)

        try:
            yield finished
        except KeyboardInterrupt as interrupt:
            raise KeyboardInterrupt(
                f"interrupted: {work.done} of {total} cases are finished and kept; "
                "the same command makes the others"
            ) from interrupt


# Bytes that the cases of a study write: less fills no disk.
LEAST_TOLD_BYTES = 1e8


def tell_size(folder: Path) -> OnBegin:
    """Tells what the cases will write, if that is much or the disk of their folder has no room."""

    def begin(cases: int, size: int) -> None:
        # The folder of a new study is not there yet, but the disk is that of its parents.
        existing = next(path for path in (folder, *folder.parents) if path.is_dir())
        free = shutil.disk_usage(existing).free
        if size < min(LEAST_TOLD_BYTES, free):
            return
        lacking = f", and the disk has {gigabytes(free)}: record less by [output]"
        written = f"{cases} cases write about {gigabytes(size)}{lacking if size > free else ''}"
        typer.echo(one_line(f"{folder}: {written}"), err=True)

    return begin


def failures(rows: Sequence[Row]) -> Iterator[str]:
    """A line for each case that failed."""
    for row in rows:
        if row.status == "failed":
            yield f"failed: {row.case.name}: {row.message}"


def told(rows: Sequence[Row]) -> str:
    """How many cases failed, and how many of those that were run now have warnings."""
    failed = sum(row.status == "failed" for row in rows)
    warned = sum(bool(row.warnings) for row in rows)
    return f"{failed} failed" + (f", {warned} with warnings" if warned else "")
