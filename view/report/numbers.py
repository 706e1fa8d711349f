"""Numbers as a report writes them."""

from collections.abc import Iterable

import numpy as np

from ..prefixes import PREFIXES, exponent_of


def short(value: float, digits: int = 4) -> str:
    """A number of a few digits; a dash for what is none."""
    return "–" if np.isnan(value) else f"{value:.{digits}g}"


def seconds(value: float) -> str:
    """A time with its unit, as 60 µs."""
    exponent = exponent_of(min(abs(value), 999.0))
    return f"{value / 10.0**exponent:.6g} {PREFIXES[exponent]}s"


def vector(values: Iterable[float]) -> str:
    return f"({', '.join(map(short, values))})"


def counted(n: int, noun: str, plural: str = "") -> str:
    """As "1 joint", "2 joints"."""
    return f"{n} {noun if n == 1 else plural or noun + 's'}"
