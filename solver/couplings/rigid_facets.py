"""Rigid surfaces of facets from files: STL, and all other formats of meshio that have triangles."""

from pathlib import Path

import numpy as np

from ...superelement import Surface
from ..errors import ModelError

SAME_POINT = 1e-9
"""distance of points, over the size of the surface, that are one: STL repeats them per triangle"""
LINEAR_FACETS = "triangle", "quad"


def read_facets(path: str) -> Surface:
    """The surface in a file [m]; ModelError for one without triangles or quadrilaterals."""
    import meshio  # slow to load, and few models have facets

    try:
        mesh = meshio.read(path)
    except (OSError, ValueError, meshio.ReadError, SystemExit) as error:
        raise ModelError(f"{Path(path).name}: expected a surface mesh: {error}") from error
    cells = {kind: mesh.cells_dict[kind] for kind in LINEAR_FACETS if kind in mesh.cells_dict}
    if len(cells) != 1:
        found = ", ".join(mesh.cells_dict) or "nothing"
        raise ModelError(f"{Path(path).name}: expected triangles or quadrilaterals, found {found}")
    ((kind, facets),) = cells.items()
    points, numbers = _merged(np.asarray(mesh.points, dtype=float))
    facets = numbers[facets]
    used, places = np.unique(facets, return_inverse=True)
    X, facets = points[used], places.reshape(facets.shape)
    a, b = X[facets[:, 1]] - X[facets[:, 0]], X[facets[:, -1]] - X[facets[:, 0]]
    doubled = (
        np.cross(a, b)
        if kind == "triangle"
        else np.cross(X[facets[:, 2]] - X[facets[:, 0]], X[facets[:, 3]] - X[facets[:, 1]])
    )
    lengths = np.linalg.norm(doubled, axis=1)
    if not (lengths > 0.0).all():
        n = int((lengths == 0.0).sum())
        raise ModelError(f"{Path(path).name}: expected facets with an area, found {n} without")
    normals = np.zeros_like(X)
    for corner in facets.T:
        np.add.at(normals, corner, doubled)
    sizes = np.linalg.norm(normals, axis=1)
    # Sharp tips of thin sheets may have no mean normal: any does, for facets have their own.
    normals = np.where(sizes[:, None] > 0.0, normals, [0.0, 0.0, 1.0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    name = "".join(c if c.isalnum() else "-" for c in Path(path).stem) or "facets"
    return Surface(name, used, X, facets, kind, normals, float(0.5 * lengths.sum()))


def _merged(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points without repetitions, and the number of each among them."""
    size = float(np.ptp(points, axis=0).max(initial=0.0)) or 1.0
    _, first, numbers = np.unique(
        np.round(points / (SAME_POINT * size)), axis=0, return_index=True, return_inverse=True
    )
    return points[first], numbers.reshape(-1)
