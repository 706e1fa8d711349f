"""Result files to pictures."""

from .errors import PictureError, QuantityError, ResultsError
from .fields import Field, draw_fields
from .overview import overview
from .picture import COLOURS, draw, entitle, panels, save, style
from .quantities import Curve, curves
from .recording import Recording, read
from .scene import Patch, Place, Scene, draw_scene

__all__ = [
    "COLOURS",
    "Curve",
    "Field",
    "Patch",
    "PictureError",
    "Place",
    "QuantityError",
    "Recording",
    "ResultsError",
    "Scene",
    "curves",
    "draw",
    "draw_fields",
    "draw_scene",
    "entitle",
    "overview",
    "panels",
    "read",
    "save",
    "style",
]
