"""Meshes of body files: paths or, of bodies that are made in Python, meshes in memory."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import (
    Field,
    PlainSerializer,
    SerializationInfo,
    ValidatorFunctionWrapHandler,
    WrapValidator,
)

from ..mesh.mesh import Mesh


def _mesh_or_path(value: Any, path_of: ValidatorFunctionWrapHandler) -> Any:
    # A mesh passes as it is: it is large, and was checked when it was made.
    return value if isinstance(value, Mesh) else path_of(value)


def _mesh_in_words(mesh: Any, info: SerializationInfo) -> Any:
    """In JSON the path, or the name of a mesh in memory."""
    if not info.mode_is_json():
        return mesh
    return mesh.name if isinstance(mesh, Mesh) else str(mesh)


if TYPE_CHECKING:
    AnyMesh = Path | Mesh
else:
    AnyMesh = Annotated[
        Path, Field(strict=False), WrapValidator(_mesh_or_path), PlainSerializer(_mesh_in_words)
    ]
    """the path of a mesh file or, of a body that is made in Python, a mesh"""
