"""Stages of a build: their seconds, and a progress bar on the terminal."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


class Stages:
    """The stages of a build, timed; `bar` is a progress display of rich, None for no display."""

    def __init__(self, bar: Any | None = None) -> None:
        self.seconds: dict[str, float] = {}
        self._bar = bar
        self._name, self._task = "", None

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time what happens inside, with a moving bar of unknown length."""
        if self._bar is not None:
            self._name, self._task = name, self._bar.add_task(name, total=None)
        start = time.perf_counter()
        yield
        self.seconds[name] = time.perf_counter() - start
        if self._bar is not None:
            self._bar.remove_task(self._task)

    def report(self, text: str) -> None:
        """Show a text beside the name of the stage."""
        if self._bar is not None:
            self._bar.update(self._task, description=f"{self._name}: {text}")

    def track(self, steps: range) -> Iterator[int]:
        """The steps, with a bar that fills."""
        return (
            iter(steps)
            if self._bar is None
            else iter(self._bar.track(steps, description="marching"))
        )


@contextmanager
def shown_stages(progress: bool) -> Iterator[Stages]:
    """Stages that show themselves if `progress`; the display goes when they are over."""
    if not progress:
        yield Stages()
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        yield Stages(bar)
