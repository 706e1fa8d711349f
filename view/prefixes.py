"""Units of axes, with prefixes that make their numbers easy to read."""

import numpy as np

PREFIXES = {-15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
"""of units, by their powers of ten"""
PLAIN = "1"
"""the unit of a number"""
UNPREFIXED = ("g", "m²", PLAIN)
"""units that take no prefix: one before m² would be squared with it"""


def exponent_of(peak: float, unit: str = "") -> int:
    """The power of ten of the prefix that makes values up to a peak easy to read."""
    if unit in UNPREFIXED or peak == 0.0 or 0.1 <= peak < 1e4 or not np.isfinite(peak):
        return 0
    return int(np.clip(3 * np.floor(np.log10(peak) / 3), min(PREFIXES), max(PREFIXES)))


def with_unit(what: str, prefix: str, unit: str) -> str:
    """ "pseudo-velocity [mm/s]"; of numbers what they are alone."""
    return what if unit in ("", PLAIN) else f"{what} [{prefix}{unit}]".strip()
