"""Result files to pictures."""

from .errors import PictureError, QuantityError, ResultsError
from .overview import overview
from .picture import COLOURS, draw, entitle, panels, save, style
from .quantities import Curve, curves
from .recording import Recording, read

__all__ = [
    "COLOURS",
    "Curve",
    "PictureError",
    "QuantityError",
    "Recording",
    "ResultsError",
    "curves",
    "draw",
    "entitle",
    "overview",
    "panels",
    "read",
    "save",
    "style",
]
