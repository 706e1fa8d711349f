"""What a benchmark keeps of a run."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Run:
    """Microseconds of CPU and on the clock, and iterations, a step; the tip at times (n,) [s], (n,
    3) [m].
    """

    cpu: float
    wall: float
    iterations: float
    time: Array
    tip: Array

    def apart(self, other: "Run") -> float:
        """The largest distance [m] between the tips of two runs, at the times of this one."""
        there = np.column_stack([np.interp(self.time, other.time, x) for x in other.tip.T])
        return float(np.linalg.norm(self.tip - there, axis=1).max())


class Stopwatch:
    """Seconds of CPU and of the clock that were spent under it."""

    def __init__(self) -> None:
        self.cpu = self.wall = 0.0

    @contextmanager
    def running(self) -> Iterator[None]:
        wall, cpu = time.perf_counter(), time.process_time()
        yield
        self.cpu += time.process_time() - cpu
        self.wall += time.perf_counter() - wall
