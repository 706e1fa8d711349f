"""Results to pictures."""

from .errors import PictureError, QuantityError, ResultsError
from .fields import Field, draw_fields
from .overview import overview
from .picture import COLOURS, draw, entitle, panels, save, style
from .quantities import Curve, curves
from .scene import Patch, Place, Scene, draw_scene

__all__ = [
    "COLOURS",
    "Curve",
    "Field",
    "Patch",
    "PictureError",
    "Place",
    "QuantityError",
    "ResultsError",
    "Scene",
    "curves",
    "draw",
    "draw_fields",
    "draw_scene",
    "entitle",
    "overview",
    "panels",
    "save",
    "style",
]
