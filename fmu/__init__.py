"""Models as functional mock-up units (FMUs): co-simulation without Python (docs/how-to/fmu.md)."""

from .errors import ExportError
from .export import Export, export

__all__ = ["Export", "ExportError", "export"]
