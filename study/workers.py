"""Workers for the cases: this process, or workers of Dask; processes.py has those between."""

import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING, Any

from .case import Case, Kind
from .errors import ClusterError

if TYPE_CHECKING:
    from distributed import Client

# [s], for a scheduler and its first worker.
MAX_SCHEDULER_WAIT = 60


@dataclass(frozen=True)
class Report:
    """The result of a case: its failure, "" if it was made, and its warnings.

    lacks_memory: the failure is one that it might not have had alone.
    """

    failure: str = ""
    warnings: tuple[str, ...] = ()
    lacks_memory: bool = False


def attempt(kind: Kind, case: Case) -> Report:
    """Make one case, from nothing."""
    case.target.unlink(missing_ok=True)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", UserWarning)
        failure, lacks_memory = "", False
        try:
            kind.make(case)
        except kind.failures as error:
            failure = str(error) or type(error).__name__
            lacks_memory = isinstance(error, MemoryError)
    told = tuple(dict.fromkeys(str(warning.message) for warning in caught))
    return Report(failure, told, lacks_memory)


def in_process(kind: Kind, cases: Sequence[Case]) -> Iterator[tuple[Case, Report]]:
    """One case after another; an exception that is a defect comes through."""
    for case in cases:
        yield case, attempt(kind, case)


def on_cluster(kind: Kind, cases: Sequence[Case], scheduler: str) -> Iterator[tuple[Case, Report]]:
    """Cases as they are finished by the workers of a scheduler.

    A case whose worker dies is run again by another. One of which four workers die (more than the
    allowed-failures of Dask) is reported as failed. Raises `ClusterError` without Dask, or without
    an answer of the scheduler.
    """
    with _client(scheduler) as client:
        from distributed import as_completed

        waiting = iter(cases)
        running: dict[Any, Case] = {}
        finished = as_completed()

        def hand_out() -> None:
            # No more than there are threads: Dask blames the death of a worker on all that it was
            # given.
            for case in islice(waiting, max(0, _threads(client) - len(running))):
                future = client.submit(attempt, kind, case, pure=False)
                running[future.key] = case
                finished.add(future)

        hand_out()
        for future in finished:
            case, error = running.pop(future.key), future.exception()
            report = (
                future.result() if error is None else Report(f"{type(error).__name__}: {error}")
            )
            # Else Dask would make the case again, should the worker that holds the report die.
            future.release()
            hand_out()
            yield case, report


def _threads(client: "Client") -> int:
    """The number of cases that run at once; 1 while all workers are being replaced."""
    threads: dict[str, int] = client.nthreads()
    return max(1, sum(threads.values()))


@contextmanager
def _client(scheduler: str) -> Iterator["Client"]:
    try:
        from distributed import Client
    except ModuleNotFoundError as error:
        raise ClusterError(
            "Dask is not installed: pip install 'duhamel[cluster]', "
            "or no --scheduler for processes of this machine"
        ) from error
    try:
        client = Client(scheduler, timeout=MAX_SCHEDULER_WAIT)
    except (OSError, ValueError, TypeError) as error:  # TypeError: TLS without certificates
        raise ClusterError(f"{scheduler}: no scheduler: {error}") from error
    with client:
        try:
            client.wait_for_workers(1, timeout=MAX_SCHEDULER_WAIT)
        except TimeoutError as error:
            raise ClusterError(f"{scheduler}: no worker within {MAX_SCHEDULER_WAIT} s") from error
        yield client
