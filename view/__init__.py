"""Pictures of results and bodies."""

from .errors import PictureError, QuantityError, ResultsError, SeriesError, SeriesWarning
from .fields import Field, draw_fields
from .linear import (
    CampbellLine,
    ModeShape,
    ResponseCurve,
    draw_campbell,
    draw_response,
    draw_shapes,
)
from .overview import overview
from .picture import COLORS, draw, entitle, panels, save, style
from .quantities import Curve, curves
from .scene import Cross, Marker, Patch, Scene, draw_scene
from .space import Film, animate
from .variation import draw_variation

__all__ = [
    "COLORS",
    "CampbellLine",
    "Cross",
    "Curve",
    "Field",
    "Film",
    "Marker",
    "ModeShape",
    "Patch",
    "PictureError",
    "QuantityError",
    "ResponseCurve",
    "ResultsError",
    "Scene",
    "SeriesError",
    "SeriesWarning",
    "animate",
    "curves",
    "draw",
    "draw_campbell",
    "draw_fields",
    "draw_response",
    "draw_scene",
    "draw_shapes",
    "draw_variation",
    "entitle",
    "overview",
    "panels",
    "save",
    "style",
]
