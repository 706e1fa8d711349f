"""Pictures of results and bodies."""

from .errors import PictureError, QuantityError, ResultsError, SeriesError, SeriesWarning
from .fields import Field, draw_fields
from .overview import overview
from .picture import COLORS, draw, entitle, panels, save, style
from .quantities import Curve, curves
from .scene import Cross, Marker, Patch, Scene, draw_scene
from .variation import draw_variation

__all__ = [
    "COLORS",
    "Cross",
    "Curve",
    "Field",
    "Marker",
    "Patch",
    "PictureError",
    "QuantityError",
    "ResultsError",
    "Scene",
    "SeriesError",
    "SeriesWarning",
    "curves",
    "draw",
    "draw_fields",
    "draw_scene",
    "draw_variation",
    "entitle",
    "overview",
    "panels",
    "save",
    "style",
]
