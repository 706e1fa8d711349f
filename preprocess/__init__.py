"""Meshes to superelements."""

from .assembly.structure import Structure
from .body.body import Body
from .body.measured_body import MeasuredBody
from .body.reading import body_schema, read_body
from .body.writing import write_body
from .build import assemble, build
from .errors import (
    BodyError,
    InterfaceError,
    MatrixError,
    MeasurementError,
    MeshError,
    MeshWarning,
    MethodError,
    PlausibilityWarning,
    PreprocessError,
)
from .mesh.in_memory import mesh_of
from .plausibility import doubts_of_body
from .sources.reading import files_of
from .verification import body_of, static_check

__all__ = [
    "Body",
    "BodyError",
    "InterfaceError",
    "MatrixError",
    "MeasuredBody",
    "MeasurementError",
    "MeshError",
    "MeshWarning",
    "MethodError",
    "PlausibilityWarning",
    "PreprocessError",
    "Structure",
    "assemble",
    "body_of",
    "body_schema",
    "build",
    "doubts_of_body",
    "files_of",
    "mesh_of",
    "read_body",
    "static_check",
    "write_body",
]
