"""The results file of a `Simulator`: rows of single steps, by the recorder of a run."""

import time
from pathlib import Path

import numpy as np

from ...results.results import Results
from ..start.initial import InitialState
from ..step.system import Output
from .keeper import forget_checkpoint, settle_checkpoint
from .recorder import Recorder
from .validity import ValidityMonitor
from .writer import make_writer, read_back


class Recording:
    """A results file to which steps are added one by one.

    It has all that the file of a run has: the rows that `output.every` asks for, contacts that have
    ended, and the validity of what was passed so far.
    """

    def __init__(self, path: Path, initial: InitialState) -> None:
        self._lowered, self._state, self._work = initial.lowered, initial.state, initial.work
        self._begin = int(initial.state.step[0])
        self._monitor = ValidityMonitor(self._lowered)
        self._writer = make_writer(path, initial, self._lowered.n_steps, self._monitor)
        forget_checkpoint(self._writer)
        self._recorder = Recorder(self._writer, self._lowered, initial.state, initial.work)
        self._last = self._begin - 1
        self._began = time.perf_counter()

    def keep(self, step: int, output: Output) -> None:
        """Keep the only row of an output as that of a step, unless that has been kept."""
        # `finish` and the end of the `with` block both keep the last step.
        if step == self._last:
            return
        first, self._last = self._last < self._begin, step
        steps = np.array([step])
        rows = np.zeros(1, dtype=np.int64) if first else self._recorder.rows(steps)
        if rows[0] >= 0:
            # The simulator has one row, in which its views lie: it is copied to the buffer.
            for kept, row in zip(self._recorder.output.arrays(), output.arrays(), strict=True):
                kept[rows[0]] = row[0]
        if first:
            self._recorder.keep_start(step)
        else:
            self._recorder.keep(steps, rows)

    def finish(self) -> Results:
        """End the file where it is, and open it."""
        taken = self._last - self._begin
        self._end(None, None, None)
        seconds = time.perf_counter() - self._began
        self._writer.note(finished=True, seconds=seconds, steps=taken)
        settle_checkpoint(self._writer)
        self._writer.finish()
        self._writer.leave()
        return read_back(self._writer, self._lowered.model)

    def abandon(self, kind: object, error: BaseException | None, trace: object) -> None:
        """End the file after an error, with the steps before it, as a run that fails does."""
        self._end(kind, error, trace)
        self._writer.leave()

    def _end(self, kind: object, error: BaseException | None, trace: object) -> None:
        self._writer.check(self._monitor.values(self._state, self._last - self._begin))
        self._recorder.__exit__(kind, error, trace)
