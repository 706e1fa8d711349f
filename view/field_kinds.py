"""The fields of bodies that pictures, films and reports show, and their colors."""

import matplotlib
import numpy as np
from matplotlib.colors import LinearSegmentedColormap

FIELDS = {
    "displacement": ("elastic displacement", "m"),
    "velocity": ("velocity", "m/s"),
    "von_mises": ("von Mises stress", "Pa"),
}
"""their names and units"""
COLOR_MAP = LinearSegmentedColormap.from_list(
    "field", matplotlib.colormaps["turbo"](np.linspace(0.07, 0.98, 256))
)
"""turbo without its darkest ends, which light and shade would make black"""
WORST = "worst"
"""the time at which a field is largest"""
