"""A buffer for rows of output, written when it is full or a second old."""

import time

import numpy as np

from ...results.batches import Batch, Energies, EventRows
from ...results.source import Writer
from ..arrays import Index
from ..lower.allocation import make_output, row_width
from ..lower.lower import LoweredModel
from ..step.system import State, Workspace
from .events import taken, unfinished
from .writer import rows_of

# 8 MB: few hand-overs to Python, and little memory beside that of the run
BUFFER_NUMBERS = 1 << 20
NO_ENERGIES = Energies(0.0, 0.0)
"""until the first row is kept"""


class Recorder:
    """Gives the time loop rows for the steps that are to be recorded, and writes them, with events.

    On exit, with or without an error, it writes the rows in the buffer, and contacts that are still
    closed; but a run that fails in its first step leaves an earlier results file as it is.
    """

    def __init__(
        self,
        writer: Writer,
        lowered: LoweredModel,
        state: State,
        work: Workspace,
        start: Energies = NO_ENERGIES,
    ) -> None:
        width = row_width(lowered)
        self._every, self._last = lowered.model.settings.output.every, lowered.n_steps
        n = min(BUFFER_NUMBERS // width, rows_of(lowered))
        # Models of thousands of bodies have long rows: some steps at least go at once.
        self.output = make_output(lowered, max(n, 16))
        self._writer, self._h = writer, lowered.h
        self._steps = np.empty(len(self.output.newton_residual), dtype=np.int64)
        self._waiting = self._taken = 0
        self._lowered, self._state, self._work = lowered, state, work
        self._events: list[EventRows] = []
        self._written = time.perf_counter()
        self.start = start
        """energies of t = 0"""

    def __enter__(self) -> "Recorder":
        return self

    def rows(self, steps: Index, stride: int = 1) -> Index:
        """Rows of the output for steps a stride apart, or as many as fit; -1: not recorded."""
        # In long steps `every` counts these.
        recorded = (steps % (self._every * stride) == 0) | (steps == self._last)
        waiting = self._waiting + np.cumsum(recorded)
        # Steps whose rows do not fit are left to the next call.
        return np.where(recorded, waiting - 1, -1)[waiting <= len(self._steps)]

    def keep(self, steps: Index, rows: Index, stride: int = 1) -> None:
        """Keep the rows of the steps, which have been taken."""
        recorded = rows >= 0
        n = int(recorded.sum())
        self._steps[self._waiting : self._waiting + n] = steps[recorded]
        self._waiting += n
        self._taken += len(rows)
        regular = recorded & (steps % (self._every * stride) == 0)
        self._state.recorded[0] += int(regular.sum())
        if self._state.contacts.n_events[0]:
            self._events.append(taken(self._state))
        full = self._waiting == len(self._steps)
        if full or time.perf_counter() - self._written > self._writer.pause:
            self.write()

    def keep_start(self, step: int) -> None:
        """Keep the first row: that of the step at which the run starts."""
        self._steps[0], self._waiting = step, 1
        self.start = Energies.of(self.output)

    def write(self, is_last: bool = False) -> None:
        """Write the rows in the buffer; none twice, even after an interrupt."""
        steps, events = self._steps[: self._waiting], self._events
        # Forgotten before they are written: after an interrupt in `append` none is written twice.
        self._waiting, self._events = 0, []
        if len(steps) or events:
            joined = EventRows.joined(events)
            self._writer.append(Batch(steps, self._h, self.output, self.start, joined, is_last))
        self._written = time.perf_counter()

    def flush(self) -> None:
        """Write the rows in the buffer, and let all rows take place in the file."""
        self.write()
        self._writer.flush()

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        # A run that fails in its first step has nothing to show for earlier results.
        if error is not None and self._taken == 0 and self._writer.abandon():
            return
        self._events.append(unfinished(self._lowered, self._state, self._work))
        try:
            self.write(is_last=True)
        finally:
            self._writer.flush()
