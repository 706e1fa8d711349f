"""Meshes to superelements."""

from .assembly.structure import Structure
from .body.body import Body, body_schema, read_body
from .build import assemble, build
from .errors import (
    BodyError,
    InterfaceError,
    MatrixError,
    MeshError,
    MeshWarning,
    MethodError,
    PreprocessError,
)
from .plausibility import doubts_of_body
from .sources.reading import files_of
from .verification import body_of, static_check

__all__ = [
    "Body",
    "BodyError",
    "InterfaceError",
    "MatrixError",
    "MeshError",
    "MeshWarning",
    "MethodError",
    "PreprocessError",
    "Structure",
    "assemble",
    "body_of",
    "body_schema",
    "build",
    "doubts_of_body",
    "files_of",
    "read_body",
    "static_check",
]
