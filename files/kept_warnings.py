"""Warnings that belong to a piece of work: Python's own filters are those of all threads."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_kept: ContextVar[list[Warning] | None] = ContextVar("kept", default=None)


def warn(message: str, category: type[Warning], stacklevel: int = 1) -> None:
    """Warn as `warnings.warn` does, unless the caller keeps the warnings of its thread."""
    kept = _kept.get()
    if kept is None:
        warnings.warn(message, category, stacklevel=stacklevel + 1)
    else:
        kept.append(category(message))


@contextmanager
def kept_warnings() -> Iterator[list[Warning]]:
    """Inside, the warnings of this thread go to a list, whatever other threads do."""
    found: list[Warning] = []
    token = _kept.set(found)
    try:
        yield found
    finally:
        _kept.reset(token)
