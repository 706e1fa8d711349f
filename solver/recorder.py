"""Rows of output on their way to the results file: they wait until they are many, or a second old."""

import time
from types import TracebackType

import numpy as np

from .compilation import CompiledModel
from .compiled import Index
from .results_file import ResultsFile
from .results_layout import make_output
from .system import Output

NUMBERS = 1 << 20
"""how many numbers wait at most"""
BETWEEN_WRITES = 1.0
"""seconds: what a run that is killed loses, so that writing takes little of the time of any run"""


class Recorder:
    """Gives the time loop room for rows, and writes them; leaving it, by whatever way, writes what waits."""

    def __init__(self, file: ResultsFile, compiled: CompiledModel) -> None:
        width = sum(array[0].size for array in make_output(compiled, 1))
        self._rows = max(NUMBERS // width, 16)
        self._output = make_output(compiled, self._rows)
        self._file = file
        self._steps: list[Index] = []
        self._waiting = 0
        self._written = time.perf_counter()

    def __enter__(self) -> "Recorder":
        return self

    @property
    def free(self) -> Output:
        """Rows for the next steps: one or more."""
        return Output._make(array[self._waiting :] for array in self._output)

    def keep(self, first: int, n: int) -> None:
        """The first n of the free rows now hold the steps from `first` on."""
        self._steps.append(np.arange(first, first + n))
        self._waiting += n
        if self._waiting == self._rows or time.perf_counter() - self._written > BETWEEN_WRITES:
            self.flush()

    def flush(self) -> None:
        self._file.append(np.concatenate([np.empty(0, dtype=np.int64), *self._steps]), self._output)
        self._steps, self._waiting, self._written = [], 0, time.perf_counter()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.flush()
