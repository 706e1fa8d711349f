"""Values of body files: paths, and inertia."""

from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from ...inputs import Also, Vector

FilePath = Annotated[Path, Field(strict=False)]


def _as_matrix(value: Any) -> Any:
    """Three principal values are a diagonal matrix."""
    if (
        isinstance(value, list | tuple)
        and len(value) == 3
        and all(isinstance(entry, int | float) for entry in value)
    ):
        return (value[0], 0.0, 0.0), (0.0, value[1], 0.0), (0.0, 0.0, value[2])
    return value


InertiaTensor = Annotated[tuple[Vector, Vector, Vector], BeforeValidator(_as_matrix), Also(Vector)]
"""a 3 x 3 matrix [kg m^2], or principal values along the axes"""
