"""Workers that are processes of this machine, which only this process can reach: through pipes."""

import multiprocessing
import os
import signal
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess
from typing import Any

from ..files.cores import usable_cores
from ..files.memory import available
from .case import Case, Kind
from .workers import Report, attempt

# A case that ends as many processes is to blame itself, not the machine.
MOST_DEATHS = 4
# A process with its packages and a small case.
BYTES_OF_PROCESS = 250e6
# New processes, not copies: a fork would inherit the locks of this one's threads.
SPAWN_CONTEXT = multiprocessing.get_context("spawn")
# Each process has one core; more threads of linear algebra would compete for it.
LINEAR_ALGEBRA_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
# Keeps Python from importing what lies in the user's folder.
SAFE_PATH = "PYTHONSAFEPATH"


class Worker:
    """A process that makes one case after another."""

    def __init__(self, kind: Kind) -> None:
        self.pipe, far_end = SPAWN_CONTEXT.Pipe()
        process = SPAWN_CONTEXT.Process(target=_serve, args=(far_end, kind), daemon=True)
        with _environment():
            process.start()
        far_end.close()  # so that the pipe ends with the process
        self.process: BaseProcess = process

    def stop(self) -> None:
        self.process.terminate()
        self.process.join()
        self.pipe.close()


class _Queue:
    """The cases that wait, those that are to run with no others beside them last."""

    def __init__(self, cases: Sequence[Case]) -> None:
        self._waiting, self._alone = deque(cases), deque[Case]()
        self._deaths = dict.fromkeys((case.name for case in cases), 0)
        self._retried: set[str] = set()

    def __bool__(self) -> bool:
        return bool(self._waiting or self._alone)

    def next(self, running: int, most: int) -> Case | None:
        """The next case, if it may run beside so many others; None if all are to wait."""
        if self._waiting:
            return self._waiting.popleft() if running < most else None
        return self._alone.popleft() if self._alone and not running else None

    def takes_back(self, case: Case, report: Report | None) -> bool:
        """Whether a case is to run again, by its report, or None of a process that died of it.

        One that lacked memory, or died twice, gets all the machine the next time.
        """
        if report is None:
            self._deaths[case.name] += 1
            again = self._deaths[case.name] < MOST_DEATHS
            is_first = self._deaths[case.name] == 1
        else:
            again = report.lacks_memory and case.name not in self._retried
            is_first = False
            self._retried.add(case.name)
        if again and is_first:
            self._waiting.appendleft(case)
        elif again:
            self._alone.append(case)
        return again


def on_processes(
    kind: Kind, cases: Sequence[Case], workers: int | None = None
) -> Iterator[tuple[Case, Report]]:
    """Cases as they are finished by processes of this machine.

    By default one a core, as far as there is memory. A case whose process dies is begun again by
    another, and fails with the fourth; what lacked memory is tried once more, alone.
    """
    queue = _Queue(cases)
    running: dict[Any, tuple[Worker, Case]] = {}
    idle: list[Worker] = []
    most = min(workers or _cores(), len(cases))
    try:
        while queue or running:
            while (case := queue.next(len(running), most)) is not None:
                worker = idle.pop() if idle else Worker(kind)
                running[worker.pipe] = worker, case
                _hand_over(worker, case)
            for pipe in wait(list(running)):
                worker, case = running.pop(pipe)
                report = _report(worker)
                if report is not None:
                    idle.append(worker)
                if not queue.takes_back(case, report):
                    yield case, report or Report(f"{MOST_DEATHS} processes died of it")
    finally:
        for worker in [*idle, *(worker for worker, _ in running.values())]:
            worker.stop()


def _cores() -> int:
    """Those that this process may use and has memory for."""
    return max(1, min(usable_cores(), int(available() // BYTES_OF_PROCESS)))


def _hand_over(worker: Worker, case: Case) -> None:
    # One that died between two cases shows that when its report is waited for.
    with suppress(ConnectionError):
        worker.pipe.send(case)


def _report(worker: Worker) -> Report | None:
    """What a worker says of its case; None if it has died, also in the middle of saying it."""
    try:
        report: Report = worker.pipe.recv()
    except (EOFError, OSError):
        worker.stop()
        return None
    return report


def _serve(pipe: Any, kind: Kind) -> None:
    """Make the cases that come through a pipe until it ends."""
    # An interrupt is for the process that waits for this one, and ends it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    while True:
        try:
            case = pipe.recv()
        except EOFError:
            return
        try:
            report = attempt(kind, case)
        except Exception as error:
            report = Report(f"{type(error).__name__}: {error}")
        try:
            pipe.send(report)
        except ConnectionError:
            return


@contextmanager
def _environment() -> Iterator[None]:
    """What processes that start within find in their environment, beside what is there."""
    added = {name: "1" for name in (*LINEAR_ALGEBRA_THREADS, SAFE_PATH) if name not in os.environ}
    os.environ.update(added)
    try:
        yield
    finally:
        for name in added:
            del os.environ[name]
