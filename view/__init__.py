"""Pictures of results and bodies."""

from .body_fields import draw_body_fields
from .curve import Curve
from .errors import (
    PictureError,
    PictureWarning,
    QuantityError,
    ResultsError,
    SeriesError,
    SeriesWarning,
)
from .fields import Field, draw_fields
from .fit import FitOfTest, draw_fit
from .linear import (
    CampbellLine,
    ModeShape,
    ResponseCurve,
    draw_campbell,
    draw_response,
    draw_shapes,
)
from .naming import title_and_labels
from .optimization import GoalHistory, draw_optimization
from .overlay import overlaid
from .overview import overview, overview_quantities
from .picture import draw, entitle, panels, save, style
from .quantities import curves
from .report import REPORT_FIELDS, write_report
from .runs import Run, names_of, panel, runs_of
from .scene import Cross, Marker, Patch, Scene, draw_scene
from .sensitivities import draw_elasticities
from .series_fit import SeriesFit, draw_series_fit
from .space import Film, animate
from .styles import COLORS
from .variation import draw_variation

__all__ = [
    "COLORS",
    "REPORT_FIELDS",
    "CampbellLine",
    "Cross",
    "Curve",
    "Field",
    "Film",
    "FitOfTest",
    "GoalHistory",
    "Marker",
    "ModeShape",
    "Patch",
    "PictureError",
    "PictureWarning",
    "QuantityError",
    "ResponseCurve",
    "ResultsError",
    "Run",
    "Scene",
    "SeriesError",
    "SeriesFit",
    "SeriesWarning",
    "animate",
    "curves",
    "draw",
    "draw_body_fields",
    "draw_campbell",
    "draw_elasticities",
    "draw_fields",
    "draw_fit",
    "draw_optimization",
    "draw_response",
    "draw_scene",
    "draw_series_fit",
    "draw_shapes",
    "draw_variation",
    "entitle",
    "names_of",
    "overlaid",
    "overview",
    "overview_quantities",
    "panel",
    "panels",
    "runs_of",
    "save",
    "style",
    "title_and_labels",
    "write_report",
]
