"""Meshes to superelements."""

from .body import Body, read_body
from .build import build
from .errors import BodyError, InterfaceError, MatrixError, MeshError, MeshWarning, MethodError, PreprocessError
from .structure import Structure, assemble

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
    "read_body",
]
