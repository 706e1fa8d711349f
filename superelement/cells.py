"""Lines and facets as rows of point numbers, each of the type of its number of points."""

from itertools import pairwise
from typing import Any

import numpy as np

from ..files.arrays import Array
from ..files.arrays import IntArray as IntArray
from .validation import SuperelementError

LINE_POINTS = 2
# By the number of points of a facet, corners before middle nodes as in meshio.
TRIANGLES_OF_FACET = {
    3: ((0, 1, 2),),
    4: ((0, 1, 2), (0, 2, 3)),
    6: ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
    8: ((0, 4, 7), (4, 1, 5), (5, 2, 6), (6, 3, 7), (4, 5, 6), (4, 6, 7)),
    9: tuple((a, b, 8) for a, b in pairwise((0, 4, 1, 5, 2, 6, 3, 7, 0))),
}


def checked_cells(name: str, value: Any, n_points: int) -> IntArray:
    """Read-only rows (n, k) of point numbers below n_points, -1 filling short rows."""
    cells = np.array(value, order="C")
    if cells.ndim != 2 or not np.issubdtype(cells.dtype, np.integer):
        raise SuperelementError(
            f"{name}: expected integers of shape (n, k), found {cells.dtype} {cells.shape}"
        )
    if cells.size and (cells.min() < -1 or cells.max() >= n_points):
        raise SuperelementError(
            f"{name}: expected point indices from -1 to {n_points - 1}, found "
            f"{cells.min()} to {cells.max()}"
        )
    cells = cells.astype(np.int64)
    # Cells are shared between superelements, outlines and views without copies.
    cells.flags.writeable = False
    return cells


def of_size(cells: IntArray, k: int) -> IntArray:
    """The cells (m, k) that have k points."""
    # Where no row is as long as k, the slice is narrower than (0, k), which callers index.
    chosen: IntArray = cells[sizes(cells) == k, :k]
    return chosen if chosen.shape[1] == k else np.empty((0, k), dtype=np.int64)


def sizes(cells: IntArray) -> IntArray:
    """The number of points (n,) of each cell."""
    counts: IntArray = np.count_nonzero(cells >= 0, axis=1)
    return counts


def triangles(cells: IntArray) -> IntArray:
    """The triangles (m, 3) that all facets are cut into."""
    cut = [
        of_size(cells, k)[:, list(rows)].reshape(-1, 3) for k, rows in TRIANGLES_OF_FACET.items()
    ]
    joined: IntArray = np.concatenate(cut)
    return joined


def normals(points: Array, triangles: IntArray) -> Array:
    """Normals (m, 3) of triangles (m, 3) of points (p, 3), twice as long as their areas [m^2]."""
    a, b, c = (points[corner] for corner in triangles.T)
    across: Array = np.cross(b - a, c - a)
    return across


def padded(blocks: list[IntArray]) -> IntArray:
    """Rows of different lengths below each other, -1 filling short ones."""
    width = max((rows.shape[1] for rows in blocks), default=0)
    rows = np.full((sum(map(len, blocks)), width), -1, dtype=np.int64)
    first = 0
    for block in blocks:
        rows[first : first + len(block), : block.shape[1]] = block
        first += len(block)
    return rows
