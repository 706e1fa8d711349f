"""How far long work is and how long it will take, told on stderr.

On a terminal by a bar, after a second; elsewhere by a line every few seconds, for logs.
"""

import sys
from collections.abc import Callable
from contextlib import suppress
from threading import Event, Thread
from time import perf_counter

# [s] between lines of progress where there is no terminal.
LINE_INTERVAL = 5.0
# [s]: work that is shorter shows no bar, which would only flicker.
BAR_DELAY = 1.0
# [s] between pictures of a bar.
BAR_INTERVAL = 0.2


class Work:
    """What is done of some work, and when the rest will be.

    total: how many parts it has, None where nobody knows; counted in `unit`, or as a fraction where
    that is none. now: the clock [s].
    """

    def __init__(
        self,
        label: str = "",
        total: int | None = None,
        unit: str = "",
        now: Callable[[], float] = perf_counter,
    ) -> None:
        self.note, self.unit, self._now = "", unit, now
        self.begin(label, total)

    def begin(self, label: str, total: int | None = None) -> None:
        """Begin other work, of which nothing is done."""
        self.label, self.total, self.note = label, total, ""
        self.done, self.free = 0, 0
        self._started = self._now()

    def advance(self, parts: int = 1, free: bool = False) -> None:
        """Some parts are done; free: they took no time, as those of an earlier run."""
        self.done += parts
        self.free += parts if free else 0

    def remaining(self, now: float) -> float | None:
        """Seconds to go, as fast as the work was so far; None before the first part is done."""
        worked = self.done - self.free
        if self.total is None or worked <= 0:
            return None
        return (now - self._started) / worked * max(self.total - self.done, 0)

    def __str__(self) -> str:
        now = self._now()
        left = self.remaining(now)
        until = f"{clock(now - self._started)} so far" if left is None else f"{clock(left)} left"
        return ", ".join(part for part in (self._how_far(), until) if part)

    def _how_far(self) -> str:
        parts = [self.label, self.note]
        if self.total is not None:
            count = f"{self.done} of {self.total} {self.unit}"
            parts.append(count if self.unit else f"{100.0 * self.done / max(self.total, 1):.0f} %")
        return ": ".join(part for part in parts if part)


def clock(seconds: float) -> str:
    """A time as minutes and seconds, from an hour on with hours."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"


class Progress:
    """Shows work while the context lasts, from a thread of its own; `shown` False: it does not."""

    def __init__(self, work: Work, shown: bool = True) -> None:
        self.work = work
        self._ended = Event()
        follow = _as_bar if shown and _is_terminal() else _as_lines
        self._thread = Thread(target=follow, args=(work, self._ended), daemon=True)
        self._shown = shown

    def __enter__(self) -> Work:
        if self._shown:
            self._thread.start()
        return self.work

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        self._ended.set()
        if self._shown:
            self._thread.join()


def _is_terminal() -> bool:
    return sys.stderr is not None and sys.stderr.isatty()


def _as_lines(work: Work, ended: Event) -> None:
    # A pipe that nobody reads any more ends the telling, not the work.
    with suppress(OSError, ValueError, AttributeError):
        while not ended.wait(LINE_INTERVAL):
            print(work, file=sys.stderr, flush=True)


def _as_bar(work: Work, ended: Event) -> None:
    if ended.wait(BAR_DELAY):
        return
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn
    from rich.progress import Progress as Bar

    columns = (BarColumn(), TextColumn("{task.description}", markup=False))
    bar = Bar(*columns, console=Console(stderr=True), transient=True)
    with suppress(OSError, ValueError), bar:
        task = bar.add_task(str(work), total=work.total)
        while True:
            bar.update(task, total=work.total, completed=work.done, description=str(work))
            if ended.wait(BAR_INTERVAL):
                return
