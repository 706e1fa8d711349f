"""The processes of MPI: their sums and decisions, and how they end where one of them fails."""

import atexit
import sys
import time
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
import petsc4py
from mpi4py import MPI

from ...superelement.validation import Array
from ..processes import Found, Processes

Result = TypeVar("Result")
petsc4py.init(["-no_signal_handler"])  # signals are Python's
FAILURE_WAIT_SECONDS = 1.0  # for the others to fail as well

OUTPUT_WAIT_SECONDS = 0.3  # for mpiexec to pass on what was told, before it ends all


class FirstFailedError(Exception):
    """The first process has failed, and tells of it."""


class Ranks(Processes):
    """The processes of a communicator, the first of which reads, decides, tells and writes."""

    def __init__(self, comm: Any) -> None:
        self.comm = comm
        self.first = comm.rank == 0
        self.apart = False
        """true in the first one once the others need it no longer"""
        self._failing = comm.Dup()
        self._machine = comm.Split_type(MPI.COMM_TYPE_SHARED)

    @property
    def size(self) -> int:
        return int(self.comm.size)

    def total(self, part: Array) -> Array:
        # The sum of one process, sent to all: not each its own, which may round differently.
        mine = np.ascontiguousarray(part, dtype=np.float64)
        found = np.empty_like(mine)
        self.comm.Reduce(mine, found, op=MPI.SUM, root=0)
        self.comm.Bcast(found, root=0)
        return found

    def largest(self, part: float) -> float:
        # MPI would lose what is no number beside one.
        return float(self.comm.allreduce(np.inf if np.isnan(part) else part, op=MPI.MAX))

    def agreed(self, find: Callable[[], Found]) -> Found:
        if not self.first:
            found, failed = self.comm.bcast(None)
            if failed:
                raise FirstFailedError
            return found  # type: ignore[no-any-return]
        try:
            found = find()
        except BaseException:
            self.apart = True
            self.comm.bcast((None, True))
            raise
        self.comm.bcast((found, False))
        return found

    def in_first(self, find: Callable[[], Found]) -> Found | None:
        """What the first process finds, in itself alone; None in the others, which wait."""
        kept: list[Found] = []
        self.agreed(lambda: kept.append(find()))
        return kept[0] if kept else None

    def on_this_machine(self, part: int) -> int:
        return int(self._machine.allreduce(part, op=MPI.SUM))

    def guarded(self, work: Callable[[], Result]) -> Result:
        """What all processes do together. Where some fail, one of them raises, and all end."""
        try:
            return work()
        except FirstFailedError:
            sys.exit(1)
        except BaseException:
            if not self.apart and not self._tells():
                sys.exit(1)
            raise

    def _tells(self) -> bool:
        """Whether this process, which has failed, is the one that tells why.

        Where all fail, as by a decision that they share, it is the first. Otherwise each that does,
        and the rest is ended once Python has told of the exception.
        """
        mine, found = np.array([self.comm.rank]), np.zeros(1, dtype=np.int64)
        # Not blocking: a process that has not failed never comes here.
        request = self._failing.Iallreduce(mine, found, op=MPI.MIN)
        until = time.monotonic() + FAILURE_WAIT_SECONDS
        while not request.Test():
            if time.monotonic() > until:
                atexit.register(_abort)
                return True
            time.sleep(0.01)
        return bool(found[0] == self.comm.rank)


def _abort() -> None:
    sys.stdout.flush()
    sys.stderr.flush()
    time.sleep(OUTPUT_WAIT_SECONDS)
    MPI.COMM_WORLD.Abort(1)
