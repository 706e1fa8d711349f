"""The error of a file that users wrote, and values as errors quote them."""

import difflib
from collections.abc import Iterable
from reprlib import Repr
from typing import Any

from .words_of_others import WORDS_OF_OTHERS

# An error stays on a few lines of a terminal whatever the file holds.
MAX_QUOTED_LENGTH = 200


class InputError(ValueError):
    """A file that is unreadable or has invalid entries; one line."""


class _Quotation(Repr):
    """Shortens values to `MAX_QUOTED_LENGTH` characters, with an ellipsis in the middle."""

    def __init__(self) -> None:
        super().__init__()
        self.maxlevel, self.maxstring, self.maxother = 4, MAX_QUOTED_LENGTH, MAX_QUOTED_LENGTH
        self.maxtuple = self.maxlist = self.maxdict = 20

    def repr_int(self, x: int, level: int) -> str:
        # Python refuses to write out integers of thousands of digits.
        return (
            repr(x)
            if x.bit_length() < 3 * MAX_QUOTED_LENGTH
            else f"an integer of {x.bit_length()} bits"
        )


def quoted(value: Any) -> str:
    """A value as errors quote it, in one line and not at length."""
    text = _Quotation().repr(value)
    return text if len(text) <= MAX_QUOTED_LENGTH else f"{text[: MAX_QUOTED_LENGTH - 3]}..."


def did_you_mean(name: str, known: Iterable[str], n: int = 1, cutoff: float = 0.6) -> str:
    """The end of a message about an unknown name: up to n known ones that are like it, if any."""
    names = list(known)
    word = WORDS_OF_OTHERS.get(name.lower())
    near = [word] if word in names else difflib.get_close_matches(name, names, n, cutoff)
    return f"; did you mean {' or '.join(map(repr, near))}?" if near else ""


def dotted(keys: Iterable[str]) -> str:
    """Keys within one another as errors name them; those that are no plain words are quoted."""
    return ".".join(
        key if key.isprintable() and len(key) <= MAX_QUOTED_LENGTH else quoted(key) for key in keys
    )
