"""Stages of a build: their seconds, how far they are, and what is to be said of them."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from ..files.progress import Progress, Work

Warn = Callable[[str], object]


def silent(warning: str) -> None:
    """Where warnings are not asked for."""


class Stages:
    """The stages of a build, timed; `work` is what is shown of them.

    warn: called with what may be wrong.
    """

    def __init__(self, work: Work | None = None, warn: Warn = silent) -> None:
        self.seconds: dict[str, float] = {}
        self.warn = warn
        self._work = Work() if work is None else work

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time what happens inside, of unknown length."""
        self._work.begin(name)
        start = time.perf_counter()
        try:
            yield
        except KeyboardInterrupt as interrupt:
            raise KeyboardInterrupt(f"interrupted in the stage {name}") from interrupt
        self.seconds[name] = time.perf_counter() - start

    def report(self, text: str) -> None:
        """Show a text beside the name of the stage."""
        self._work.note = text

    def track(self, steps: range) -> Iterator[int]:
        """The steps, which are counted as they are done."""
        self._work.begin("marching", len(steps))
        for step in steps:
            yield step
            self._work.advance()


@contextmanager
def shown_stages(progress: bool, warn: Warn = silent) -> Iterator[Stages]:
    """Stages that show themselves if `progress`; the display goes when they are over."""
    with Progress(Work("mesh"), shown=progress) as work:
        yield Stages(work, warn)
