"""Rows of output on their way to the results file: they wait until they are many, or a second old."""

import time
from types import TracebackType

import numpy as np

from ..arrays import Index
from ..lower.allocation import make_output
from ..lower.lower import LoweredModel
from .file import ResultsFile

NUMBERS = 1 << 20
"""how many numbers wait at most"""
BETWEEN_WRITES = 1.0
"""seconds: what a run that is killed loses, so that writing takes little of the time of any run"""


class Recorder:
    """Gives the time loop rows for the steps that are to be recorded, and writes them.

    Leaving it, in whatever way, writes what waits.
    """

    def __init__(self, file: ResultsFile, lowered: LoweredModel) -> None:
        width = sum(array.size for array in make_output(lowered, 1).arrays())
        self._every, self._last = lowered.model.settings.output.every, lowered.n_steps
        n = min(NUMBERS // width, self._last // self._every + 2)
        self.output = make_output(lowered, max(n, 16))
        self._file = file
        self._steps = np.empty(len(self.output.residual), dtype=np.int64)
        self._waiting = 0
        self._written = time.perf_counter()

    def __enter__(self) -> "Recorder":
        return self

    def rows(self, first: int, n: int) -> Index:
        """The row of the output for each of the steps from `first` on, n or as many as there is
        room for; -1: none.
        """
        steps = np.arange(first, first + n)
        recorded = (steps % self._every == 0) | (steps == self._last)
        waiting = self._waiting + np.cumsum(recorded)
        return np.where(recorded, waiting - 1, -1)[waiting <= len(self._steps)]

    def keep(self, first: int, rows: Index) -> None:
        """The steps from `first` on have been taken and recorded in these rows."""
        recorded = rows >= 0
        n = int(recorded.sum())
        self._steps[self._waiting : self._waiting + n] = first + np.flatnonzero(recorded)
        self._waiting += n
        if (
            self._waiting == len(self._steps)
            or time.perf_counter() - self._written > BETWEEN_WRITES
        ):
            self.flush()

    def flush(self) -> None:
        self._file.append(self._steps[: self._waiting], self.output)
        self._waiting, self._written = 0, time.perf_counter()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.flush()
