"""What another thread holds, continues and stops a run by, between its batches of steps."""

import time
from collections.abc import Callable
from contextvars import ContextVar
from pathlib import Path
from threading import Event

SECONDS_PER_LOOK = 0.2
"""between two looks at the keyboard; some systems wait for threads with deaf ears"""


class RunControl:
    """Holds, continues and stops runs from other threads than theirs."""

    def __init__(self) -> None:
        self._going, self._stopped = Event(), Event()
        self._going.set()
        self.place: Path | None = None
        """the file to which the run writes its rows, once it has begun one"""

    @property
    def held(self) -> bool:
        return not (self._going.is_set() or self._stopped.is_set())

    def hold(self) -> None:
        """Let the run wait after its present batch of steps, unless it is to end."""
        self._going.clear()

    def go_on(self) -> None:
        self._going.set()

    def stop(self) -> None:
        """End the run as an interrupt from the keyboard does, also while it is held."""
        self._stopped.set()
        self._going.set()

    def obey(self, before_waiting: Callable[[], object]) -> float:
        """Wait while the run is held, and return for how long [s]; `KeyboardInterrupt` to end it.

        before_waiting: is called first where it is held.
        """
        waited = 0.0
        if self.held:
            started = time.perf_counter()
            before_waiting()
            # A look at both: `hold` and `stop` may come at once, from two threads.
            while not (self._going.wait(SECONDS_PER_LOOK) or self._stopped.is_set()):
                pass
            waited = time.perf_counter() - started
        if self._stopped.is_set():
            raise KeyboardInterrupt
        return waited


RUN_CONTROL: ContextVar[RunControl | None] = ContextVar("control", default=None)
"""what controls runs in this thread, beside the keyboard, which interrupts the main thread"""
