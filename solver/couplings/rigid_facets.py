"""Rigid surfaces of facets from files: STL, and all other formats of meshio that have triangles."""

from pathlib import Path

import numpy as np

from ...superelement import Surface
from ..errors import ModelError

SAME_POINT = 1e-9
"""distance of points, over the size of the surface, that are one: STL repeats them per triangle"""
LINEAR_FACETS = "triangle", "quad"


def read_facets(path: str, hollow: bool) -> Surface:
    """The surface in a file [m]; ModelError for one without triangles or quadrilaterals.

    Its facets act on the side of their normals. hollow: those of a closed surface point inward.
    """
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
    if _is_closed(Path(path).name, facets):
        inward = _volume(X, facets) < 0.0
        if inward and not hollow:
            raise ModelError(
                f"{Path(path).name}: expected normals that point out of its closed surface, or "
                "hollow = true, found inward ones"
            )
        if hollow and not inward:
            facets, doubled = facets[:, ::-1], -doubled
    elif hollow:
        raise ModelError(f"{Path(path).name}: hollow: expected a closed surface, found an open one")
    normals = np.zeros_like(X)
    for corner in facets.T:
        np.add.at(normals, corner, doubled)
    sizes = np.linalg.norm(normals, axis=1)
    # Sharp tips of thin sheets may have no mean normal: any does, for facets have their own.
    normals = np.where(sizes[:, None] > 0.0, normals, [0.0, 0.0, 1.0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    name = "".join(c if c.isalnum() else "-" for c in Path(path).stem) or "facets"
    return Surface(name, used, X, facets, kind, normals, float(0.5 * lengths.sum()))


def _is_closed(name: str, facets: np.ndarray) -> bool:
    """Whether two facets meet at each edge; ModelError where they turn their backs on each other.

    Neighbors run along their common edge in opposite directions.
    """
    edges = np.stack([facets, np.roll(facets, -1, axis=1)], axis=2).reshape(-1, 2)
    _, first, counts = np.unique(edges, axis=0, return_index=True, return_counts=True)
    if (counts > 1).any():
        f = int(first[counts > 1].min()) // facets.shape[1]
        raise ModelError(
            f"{name}: expected normals on one side of the surface, found facet {f + 1} against a "
            "neighbor's, or three facets on one edge"
        )
    return {*map(tuple, edges.tolist())} == {*map(tuple, edges[:, ::-1].tolist())}


def _volume(points: np.ndarray, facets: np.ndarray) -> float:
    """The volume inside a closed surface, negative where normals point inward."""
    x = points[facets] - points.mean(axis=0)
    last = facets.shape[1] - 1
    return float(
        sum(
            np.einsum("fi,fi->", x[:, 0], np.cross(x[:, i], x[:, i + 1])) / 6.0
            for i in range(1, last)
        )
    )


def _merged(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points without repetitions, and the number of each among them."""
    size = float(np.ptp(points, axis=0).max(initial=0.0)) or 1.0
    _, first, numbers = np.unique(
        np.round(points / (SAME_POINT * size)), axis=0, return_index=True, return_inverse=True
    )
    return points[first], numbers.reshape(-1)
