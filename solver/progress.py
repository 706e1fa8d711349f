"""A progress bar for work that lasts longer than a second."""

import time
from types import TracebackType
from typing import Any


class Progress:
    """A bar with `label` that shows the done part of `total`; without a total, mere activity."""

    def __init__(self, label: str, total: int | None = None, shown: bool = True) -> None:
        self._label, self._total, self._shown = label, total, shown
        self._done = 0
        self._bar: Any = None
        self._started = time.perf_counter()

    def __enter__(self) -> "Progress":
        if self._total is None and self._shown:
            self._show()
        return self

    def advance(self, steps: int) -> None:
        self._done += steps
        if self._bar is not None:
            self._bar.update(self._task, completed=self._done)
        elif self._shown and time.perf_counter() - self._started > 1.0:
            self._show()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._bar is not None:
            self._bar.stop()

    def _show(self) -> None:
        from rich.console import Console
        from rich.progress import Progress as Bar

        self._bar = Bar(console=Console(stderr=True), transient=True)
        self._task = self._bar.add_task(self._label, total=self._total, completed=self._done)
        self._bar.start()
