"""The fields of bodies that pictures, films and reports show, and their colors."""

from dataclasses import dataclass

import matplotlib
import numpy as np
from matplotlib.colors import LinearSegmentedColormap

from .prefixes import UNIT_PREFIXES, exponent_of

# By the names of fields: what they are called, and their units.
FIELD_WORDS = {
    "displacement": ("elastic displacement", "m"),
    "velocity": ("velocity", "m/s"),
    "von_mises": ("von Mises stress", "Pa"),
    "pressure": ("contact pressure", "Pa"),
}
# Viridis, in which equal steps look equal, without its dark end, which shade would make black.
COLOR_MAP = LinearSegmentedColormap.from_list(
    "field", matplotlib.colormaps["viridis"](np.linspace(0.28, 1.0, 256))
)
# In place of a time: when the field is largest.
WORST_TIME = "worst"


@dataclass(frozen=True)
class Scale:
    """The scale of the colors of a field, from 0 to its largest value.

    unit: in which its numbers are easy to read; factor: of that unit.
    """

    words: str
    unit: str
    factor: float
    largest: float

    def text(self, digits: int) -> str:
        """The largest value with its unit."""
        return f"{self.largest / self.factor:.{digits}g} {self.unit}"


def scale_of(field: str, largest: float) -> Scale:
    """The scale of a field of `FIELD_WORDS` up to a value in its own unit."""
    words, unit = FIELD_WORDS[field]
    exponent = exponent_of(largest, unit)
    return Scale(words, f"{UNIT_PREFIXES[exponent]}{unit}", 10.0**exponent, largest)
