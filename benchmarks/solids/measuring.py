"""Measurements in processes of their own, and tables of them."""

import contextlib
import multiprocessing
import os
import resource
import time
from collections.abc import Callable, Iterator
from typing import Any

Measurement = dict[str, Any]


@contextlib.contextmanager
def measured() -> Iterator[Measurement]:
    """Seconds on the clock and of all processors, and the peak of memory [GB] with what was there
    before.
    """
    found: Measurement = {}
    start, cpu = time.perf_counter(), time.process_time()
    yield found
    found |= {
        "total": time.perf_counter() - start,
        "cpu": time.process_time() - cpu,
        "peak": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20,
    }


def alone(
    work: Callable[..., Measurement], *arguments: Any, patience: float | None = None
) -> Measurement | None:
    """What `work` measures in a fresh process; None if that dies, or takes longer than `patience`
    [s].
    """
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=send, args=(sender, work, *arguments))
    process.start()
    sender.close()
    try:
        return receiver.recv() if receiver.poll(patience) else None
    except EOFError:
        return None
    finally:
        process.kill()
        process.join()


def send(sender: Any, work: Callable[..., Measurement], *arguments: Any) -> None:
    """Exudyn tells of its progress on the standard output, which is for the table. An interrupt is
    for the process that waits.
    """
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), 1)
    with contextlib.suppress(KeyboardInterrupt):
        sender.send(work(*arguments))


def table_of(heading: list[str]) -> list[str]:
    return ["| " + " | ".join(heading) + " |", "|" + "---|" * len(heading)]
