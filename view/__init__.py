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
from .report import REPORT_FIELDS, write_report
from .scene import Cross, Marker, Patch, Scene, draw_scene
from .variation import draw_variation

__all__ = [
    "COLORS",
    "REPORT_FIELDS",
    "CampbellLine",
    "Cross",
    "Curve",
    "Field",
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
    "write_report",
]
