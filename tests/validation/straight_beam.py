"""Superelements of beams along given points."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import meshio
import numpy as np
from duhamel.preprocess import Body, build
from duhamel.superelement import Superelement
from numpy.typing import NDArray

Array = NDArray[np.float64]


def along(length: float, elements: int) -> Array:
    """The nodes of a straight beam along x that starts at the origin, (elements + 1, 3)."""
    points = np.zeros((elements + 1, 3))
    points[:, 0] = np.linspace(0.0, length, elements + 1)
    return points


def beam_superelement(
    folder: Path,
    points: Array,
    section: Mapping[str, Any],
    interfaces: Mapping[str, int],
    **settings: Any,
) -> Superelement:
    """A beam through points (n, 3), one element between each two; interfaces name points by number.

    Any step can be used with it: its kernel of one step is a matter of form, its modes are all
    there.
    """
    path = folder / "beam.msh"
    lines = np.column_stack([np.arange(len(points) - 1), np.arange(1, len(points))])
    tags = {tag: [np.ones(len(lines), dtype=int)] for tag in ("gmsh:physical", "gmsh:geometrical")}
    meshio.Mesh(points, [("line", lines)], cell_data=tags).write(
        path, file_format="gmsh22", binary=False
    )
    body = {
        "name": "beam",
        "mesh": str(path),
        "section": dict(section),
        "interfaces": {name: {"node": points[i].tolist()} for name, i in interfaces.items()},
        "impulse": {"step": 1e-3, "steps": 1, "method": "modal"},
        **settings,
    }
    return build(Body.model_validate(body))
