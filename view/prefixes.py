"""Units of axes, with prefixes that make their numbers easy to read."""

import numpy as np

# By powers of ten.
UNIT_PREFIXES = {-15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
# The unit of a number.
DIMENSIONLESS = "1"
# Nobody reads mg as a thousandth of gravity, a number has no prefix, and one before m² would be
# squared with it.
UNPREFIXED_UNITS = ("g", "m²", DIMENSIONLESS)


def exponent_of(peak: float, unit: str = "") -> int:
    """The power of ten of the prefix that makes values up to a peak easy to read."""
    if unit in UNPREFIXED_UNITS or peak == 0.0 or 0.1 <= peak < 1e4 or not np.isfinite(peak):
        return 0
    return int(np.clip(3 * np.floor(np.log10(peak) / 3), min(UNIT_PREFIXES), max(UNIT_PREFIXES)))


def with_unit(what: str, prefix: str, unit: str) -> str:
    """ "pseudo-velocity [mm/s]"; of numbers what they are alone."""
    return what if unit in ("", DIMENSIONLESS) else f"{what} [{prefix}{unit}]".strip()


def seconds(value: float) -> str:
    """A time with its unit, as 60 µs."""
    # Minutes of motion are read as seconds: 1200 s, not 1.2 ks.
    exponent = exponent_of(min(abs(value), 999.0))
    return f"{value / 10.0**exponent:.6g} {UNIT_PREFIXES[exponent]}s"


def rounded_down(value: float) -> float:
    """The largest of 1, 2 or 5 times a power of ten that is not above a positive value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * max(step for step in (1.0, 2.0, 5.0) if step <= value / power))
