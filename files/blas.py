"""The threads of BLAS, which spin while they wait: many small products are quicker on one."""

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Inside, numpy and scipy multiply and solve on the calling thread alone.

    Whatever the environment says. Products of matrices with some hundred rows take no less time on
    two threads, and on a machine with other work ten times as long.
    """
    from threadpoolctl import ThreadpoolController

    with ThreadpoolController().limit(limits=1, user_api="blas"):
        yield
