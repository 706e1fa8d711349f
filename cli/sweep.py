"""The progress of `duhamel sweep`, and its failures at the end."""

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from threading import Event, Thread
from time import perf_counter

import typer

from ..study import Row
from ..study.sweep import OnFinished
from .failures import one_line

Renew = Callable[[], object]
"""shows the progress as it is"""
INTERVAL = 5.0
"""between lines of progress where there is no terminal [s]"""


class Progress:
    """How many cases of a study are finished, and when the others will be."""

    def __init__(self, total: int) -> None:
        self.total, self.finished, self.reused = total, 0, 0
        self._started = perf_counter()

    def take(self, row: Row) -> None:
        self.finished += 1
        self.reused += row.reused

    def remaining(self, now: float) -> float | None:
        """Seconds to go, as fast as the cases that were run so far; None before the first."""
        ran = self.finished - self.reused
        if not ran:
            return None
        return (now - self._started) / ran * (self.total - self.finished)

    def __str__(self) -> str:
        left = self.remaining(perf_counter())
        count = f"{self.finished} of {self.total} cases"
        return count if left is None else f"{count}, {clock(left)} left"


def clock(seconds: float) -> str:
    """A time as minutes and seconds, from an hour on with hours."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"


@contextmanager
def shown_cases(total: int) -> Iterator[OnFinished]:
    """Progress with the time that remains, and the warnings of the cases.

    On a terminal one line that is renewed; elsewhere a line every few seconds.
    """
    progress = Progress(total)
    shown = _bar(progress) if sys.stderr.isatty() else _lines(progress)
    with shown as renew:

        def finished(row: Row) -> None:
            progress.take(row)
            renew()
            for warning in row.warnings:
                typer.echo(one_line(f"warning: {row.case.name}: {warning}"), err=True)

        yield finished


@contextmanager
def _bar(progress: Progress) -> Iterator[Renew]:
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bar

    columns = (BarColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(str(progress), total=progress.total)
        yield lambda: bar.update(task, completed=progress.finished, description=str(progress))


@contextmanager
def _lines(progress: Progress) -> Iterator[Renew]:
    ended = Event()

    def tell() -> None:
        while not ended.wait(INTERVAL):
            typer.echo(str(progress), err=True)

    thread = Thread(target=tell, daemon=True)
    thread.start()
    try:
        yield lambda: None
    finally:
        ended.set()
        thread.join()


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
