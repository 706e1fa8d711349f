"""The refusal of work that does not fit into the available memory."""

from collections.abc import Mapping

from ..files.memory import available, gigabytes
from .errors import MemoryShortageError


def require(needs: Mapping[str, float], remedy: str) -> None:
    """`MemoryShortageError` if the sum of `needs`, bytes by purpose, exceeds the available memory.

    `remedy`: advice that ends the message.
    """
    size, free = sum(needs.values()), available()
    if size > free:
        (what, first), *others = needs.items()
        parts = [
            f"{what} needs {gigabytes(first)} of memory",
            *(f"{what} {gigabytes(need)}" for what, need in others),
        ]
        raise MemoryShortageError(
            f"{' and '.join(parts)}, {gigabytes(free)} are available: {remedy}", size, free
        )
