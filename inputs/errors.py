"""The error of a file that users wrote, and values as errors quote them."""

from collections.abc import Iterable
from reprlib import Repr
from typing import Any

QUOTED = 200
"""characters of a value that an error quotes"""


class InputError(ValueError):
    """A file that is unreadable or has invalid entries; one line."""


class _Quotation(Repr):
    """Values in at most `QUOTED` characters: long ones with an ellipsis in the middle."""

    def __init__(self) -> None:
        super().__init__()
        self.maxlevel, self.maxstring, self.maxother = 4, QUOTED, QUOTED
        self.maxtuple = self.maxlist = self.maxdict = 20

    def repr_int(self, x: int, level: int) -> str:
        # Python refuses to write out integers of thousands of digits.
        return repr(x) if x.bit_length() < 3 * QUOTED else f"an integer of {x.bit_length()} bits"


def quoted(value: Any) -> str:
    """A value as errors quote it, in one line and not at length."""
    text = _Quotation().repr(value)
    return text if len(text) <= QUOTED else f"{text[: QUOTED - 3]}..."


def dotted(keys: Iterable[str]) -> str:
    """Keys within one another as errors name them; those that are no plain words are quoted."""
    return ".".join(
        key if key.isprintable() and len(key) <= QUOTED else quoted(key) for key in keys
    )
