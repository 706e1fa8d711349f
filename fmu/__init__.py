"""Models as functional mock-up units (FMUs): co-simulation without Python (docs/how-to/fmu.md)."""

from .errors import FMUError
from .export import ExportedModel, export_fmu

__all__ = ["ExportedModel", "FMUError", "export_fmu"]
