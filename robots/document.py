"""A model file with comments: tables one after the other, a key a line."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import tomli_w

from ..files.arrays import Array

BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
# Of computed numbers: the last digits of 0.30000000000000004 say nothing.
SIGNIFICANT_DIGITS = 15
# Relative to the largest entry: what products of rotations leave of a zero.
NEGLIGIBLE_ENTRY = 1e-15
# Characters of a line, where words allow it.
LINE_WIDTH = 100


@dataclass
class Section:
    """A table of a model file, headed by "[bodies.hub]" or "[[joints]]".

    remarks: by key, what stands behind the value; above: lines of comment before the table.
    """

    head: str
    values: dict[str, Any] = field(default_factory=dict)
    remarks: dict[str, str] = field(default_factory=dict)
    above: list[str] = field(default_factory=list)

    @property
    def text(self) -> str:
        lines = [comment(line) for line in self.above] + [self.head]
        for key, value in self.values.items():
            remark = self.remarks.get(key)
            line = f"{_keys(key)} = {inline(value)}"
            lines.append(f"{line}    {comment(remark)}" if remark else line)
        return "\n".join(lines)


def document_of(above: Sequence[str], sections: Sequence[Section]) -> str:
    """The text of a file, with lines of comment at its head."""
    head = "\n".join(comment(line) for line in above)
    return "\n\n".join((head, *(section.text for section in sections))) + "\n"


def comment(text: str) -> str:
    """Text as one line of comment; names of others may hold any characters."""
    kept = "".join(each if each.isprintable() else "?" for each in text)
    return f"# {kept}".rstrip()


def table_head(*keys: str) -> str:
    """The head of a table by its keys."""
    return f"[{'.'.join(map(_key, keys))}]"


def inline(value: Any) -> str:
    """A value on one line; numbers read back as they are."""
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{_key(key)} = {inline(inner)}' for key, inner in value.items())}}}"
    # Arrays print as numpy's, lists as those of TOML.
    if isinstance(value, np.ndarray):
        return inline(value.tolist())
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(inline, value))}]"
    plain = float(value) if isinstance(value, np.floating) else value
    return tomli_w.dumps({"x": plain}).removeprefix("x = ").strip()


def tidy(values: Array, size: float = 0.0) -> Array:
    """Computed numbers without what rounding has left of zeros and of short decimals.

    size: of the numbers from which they were computed, where these are larger.
    """
    largest = max(float(np.abs(values).max(initial=0.0)), size)
    if largest == 0.0:
        return values
    decimals = SIGNIFICANT_DIGITS - 1 - math.floor(math.log10(largest))
    # Adding 0 turns -0 into 0.
    rounded: Array = np.round(values, decimals) + 0.0
    return rounded


def without_noise(values: Array) -> Array:
    """Computed numbers, those that rounding has left of zeros as zeros; the others as they are."""
    least = NEGLIGIBLE_ENTRY * float(np.abs(values).max(initial=0.0))
    return np.where(np.abs(values) <= least, 0.0, values)


def _keys(key: str) -> str:
    """A dotted key: frames.NAME."""
    first, dot, rest = key.partition(".")
    return f"{_key(first)}.{_key(rest)}" if dot else _key(first)


def _key(key: str) -> str:
    return key if BARE_KEY.fullmatch(key) else inline(key)
