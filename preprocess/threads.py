"""The number of threads for numerical libraries, and work on several of them."""

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import AbstractContextManager, nullcontext
from typing import TypeVar

from ..files.blas import one_blas_thread
from ..files.cores import usable_cores

Item = TypeVar("Item")
Result = TypeVar("Result")

MIN_THREADED_UNKNOWNS = 200_000  # from which on products with a basis are worth the threads of BLAS


def blas_threads(n_u: int) -> AbstractContextManager[None]:
    """One thread of BLAS inside, for a body of n_u unknowns; all of them for large ones.

    Factors have threads of their own.
    """
    return nullcontext() if n_u >= MIN_THREADED_UNKNOWNS else one_blas_thread()


def threads() -> int:
    """The processors that this process may run on, or OMP_NUM_THREADS if that is fewer."""
    # A list sets the threads of nested regions, outermost first.
    cores, asked = usable_cores(), os.environ.get("OMP_NUM_THREADS", "").split(",")[0].strip()
    return min(cores, int(asked)) if asked.isdecimal() and int(asked) > 0 else cores


def in_order(work: Callable[[Item], Result], items: Iterable[Item]) -> Iterator[Result]:
    """`work` of every item, in the order of the items, whichever thread is done first.

    So sums of the results are the same with any number of threads. Only as many results wait as
    there are threads, and no item is taken before it is needed.
    """
    if (n := threads()) == 1:
        yield from map(work, items)
        return
    waiting: deque[Future[Result]] = deque()
    with ThreadPoolExecutor(n) as pool:
        for item in items:
            waiting.append(pool.submit(work, item))
            # One result ahead of the threads, so that none of them is idle while this is summed.
            if len(waiting) > n:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()
