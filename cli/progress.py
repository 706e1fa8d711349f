"""The progress of a command that counts its parts."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def shown_parts(unit: str) -> Iterator[Callable[[int, int], object]]:
    """Progress with the time that remains, told the parts that are done and all of them."""
    from ..files.progress import Progress, Work

    # How many parts there are is known when the first one is made.
    with Progress(Work(unit=unit)) as work:

        def tell(done: int, total: int) -> None:
            work.total = total
            work.advance(done - work.done)

        yield tell
