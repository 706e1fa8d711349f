"""Numbers as a report writes them."""

from collections.abc import Iterable

import numpy as np

from ..prefixes import PREFIXES, exponent_of


def prefixed(value: float) -> tuple[str, float]:
    """The prefix of a unit that makes a value easy to read, and its factor."""
    power = exponent_of(abs(value))
    return PREFIXES[power], 10.0**power


def short(value: float, digits: int = 4) -> str:
    """A number of a few digits; a dash for what is none."""
    return "–" if np.isnan(value) else f"{value:.{digits}g}"


def seconds(value: float) -> str:
    """A time with its unit, as 60 µs."""
    prefix, factor = prefixed(min(abs(value), 999.0))
    return f"{value / factor:.6g} {prefix}s"


def vector(values: Iterable[float]) -> str:
    return f"({', '.join(map(short, values))})"


def counted(n: int, noun: str, plural: str = "") -> str:
    """As "1 joint", "2 joints"."""
    return f"{n} {noun if n == 1 else plural or noun + 's'}"
