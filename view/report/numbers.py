"""Numbers as a report writes them."""

from collections.abc import Iterable

import numpy as np

PREFIXES = {-9: "n", -6: "µ", -3: "m", 0: ""}
"""of seconds, by their powers of ten"""


def short(value: float, digits: int = 4) -> str:
    """A number of a few digits; a dash for what is none."""
    return "–" if np.isnan(value) else f"{value:.{digits}g}"


def seconds(value: float) -> str:
    """A time with its unit, as 60 µs."""
    if not np.isfinite(value) or value == 0.0:
        return f"{value:g} s"
    power = int(np.clip(3 * np.floor(np.log10(abs(value)) / 3), -9, 0))
    return f"{value / 10.0**power:.6g} {PREFIXES[power]}s"


def vector(values: Iterable[float]) -> str:
    return f"({', '.join(map(short, values))})"


def counted(n: int, noun: str, plural: str = "") -> str:
    """As "1 joint", "2 joints"."""
    return f"{n} {noun if n == 1 else plural or noun + 's'}"
