"""The progress of `duhamel sweep`, and its failures at the end."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import typer

from ..study import Row
from ..study.sweep import OnFinished
from .failures import one_line


@contextmanager
def shown_cases(total: int) -> Iterator[OnFinished]:
    """A progress bar over the cases, with their warnings above it."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("cases"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    console = Console(stderr=True)
    with Progress(
        *columns, console=console, transient=True, disable=not console.is_terminal
    ) as bar:
        task = bar.add_task("cases", total=total)

        def finished(row: Row) -> None:
            bar.advance(task)
            for warning in row.warnings:
                typer.echo(one_line(f"warning: {row.case.name}: {warning}"), err=True)

        yield finished


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
