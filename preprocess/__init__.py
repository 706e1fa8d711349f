"""Meshes to superelements."""

from .assembly.structure import Structure
from .body.body import Body, read_body
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
from .sources.reading import files_of

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
    "build",
    "files_of",
    "read_body",
]
