"""The threads of BLAS, which spin while they wait: many small products are quicker on one."""

import sys
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from functools import lru_cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController


class _Limit:
    """The limit of all libraries of BLAS, which lasts while any thread of Python needs it."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._users = 0
        self._limited: set[object] = set()
        self._limits = ExitStack()

    def begin(self) -> None:
        with self._lock:
            # A library that was loaded since the last limit has its threads still.
            controller = _controller(len(sys.modules))
            if controller not in self._limited:
                self._limits.enter_context(controller.limit(limits=1, user_api="blas"))
                self._limited.add(controller)
            self._users += 1

    def end(self) -> None:
        with self._lock:
            self._users -= 1
            # Threads of Python end in any order: the last one gives back what the first one found.
            if self._users == 0:
                self._limited.clear()
                self._limits.close()


_limit = _Limit()


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Inside, numpy and scipy multiply and solve on the calling thread alone.

    Whatever the environment says. Products of matrices with some hundred rows take no less time on
    two threads, and on a machine with other work ten times as long.
    """
    _limit.begin()
    try:
        yield
    finally:
        _limit.end()


# To look for the libraries takes as long as a hundred steps; new ones come with new modules.
@lru_cache(maxsize=1)
def _controller(modules: int) -> "ThreadpoolController":
    """What sets the threads of the libraries that a process with so many modules has loaded."""
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
