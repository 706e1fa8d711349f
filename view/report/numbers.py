"""Numbers as a report writes them."""

from collections.abc import Iterable

import numpy as np


def short(value: float, digits: int = 4) -> str:
    """A number of a few digits; a dash for what is none."""
    return "–" if np.isnan(value) else f"{value:.{digits}g}"


def vector(values: Iterable[float]) -> str:
    return f"({', '.join(map(short, values))})"


def counted(n: int, noun: str, plural: str = "") -> str:
    """As "1 joint", "2 joints"."""
    return f"{n} {noun if n == 1 else plural or noun + 's'}"
