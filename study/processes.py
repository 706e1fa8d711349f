"""Workers that are processes of this machine, which only this process can reach: through pipes."""

import multiprocessing
import os
import signal
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from multiprocessing.connection import wait
from typing import Any, Protocol

from .case import Case, Kind
from .workers import Report, attempt

MOST_DEATHS = 4
"""of processes by one case, which then is to blame"""
SPAWN = multiprocessing.get_context("spawn")
"""new processes: copies of this one would have its threads' locks"""
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""of linear algebra, in the environment: a process is for one core"""


class _Process(Protocol):
    def terminate(self) -> None: ...
    def join(self) -> None: ...


class Worker:
    """A process that makes one case after another."""

    def __init__(self, kind: Kind) -> None:
        self.pipe, far_end = SPAWN.Pipe()
        process = SPAWN.Process(target=_serve, args=(far_end, kind), daemon=True)
        with _one_thread_each():
            process.start()
        far_end.close()  # so that the pipe ends with the process
        self.process: _Process = process

    def stop(self) -> None:
        self.process.terminate()
        self.process.join()
        self.pipe.close()


def on_processes(
    kind: Kind, cases: Sequence[Case], workers: int | None = None
) -> Iterator[tuple[Case, Report]]:
    """Cases as they are finished by processes of this machine, by default one a core.

    A case whose process dies is begun again by another, and fails with the fourth.
    """
    waiting, deaths = deque(cases), dict.fromkeys((case.name for case in cases), 0)
    running: dict[Any, tuple[Worker, Case]] = {}
    idle: list[Worker] = []
    most = min(workers or _cores(), len(cases))
    try:
        while waiting or running:
            while waiting and len(running) < most:
                worker, case = idle.pop() if idle else Worker(kind), waiting.popleft()
                running[worker.pipe] = worker, case
                _hand_over(worker, case)
            for pipe in wait(list(running)):
                worker, case = running.pop(pipe)
                report = _report(worker)
                if report is not None:
                    idle.append(worker)
                elif (died := deaths[case.name] + 1) < MOST_DEATHS:
                    deaths[case.name] = died
                    waiting.appendleft(case)
                    continue
                yield case, report or Report(f"{MOST_DEATHS} processes died of it")
    finally:
        for worker in [*idle, *(worker for worker, _ in running.values())]:
            worker.stop()


def _cores() -> int:
    """Those that this process may use, where the system says it."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


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
def _one_thread_each() -> Iterator[None]:
    added = {name: "1" for name in THREADS if name not in os.environ}
    os.environ.update(added)
    try:
        yield
    finally:
        for name in added:
            del os.environ[name]
