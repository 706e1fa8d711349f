"""Surfaces with fewer points."""

import numpy as np

from ...superelement.cells import IntArray
from ...superelement.cells import normals as normals_of
from ...superelement.validation import Array

# Along the longest side: a point of a page takes more than a thousandth of it.
MAX_GRID_CELLS = 1024


def simplified(points: Array, triangles: IntArray, most: int) -> tuple[IntArray, IntArray]:
    """A surface with at most about `most` of its points: their numbers (m,), and triangles of them.

    Points (p, 3) that share a cell of a regular grid, and whose surface looks the same way, become
    one of them, the nearest to their mean; triangles that lose a corner vanish (vertex clustering,
    Rossignac and Borrel 1993). So a thin wall keeps both its sides. The grid is the finest that
    gives so few.
    """
    used = np.unique(triangles)
    if len(used) <= most:
        return _renumbered(used, len(points), triangles)
    facing = _facing(points, triangles)
    low, high = 1, MAX_GRID_CELLS
    while low < high:
        cells = (low + high + 1) // 2
        few = len(np.unique(_keys(points[used], facing[used], cells))) <= most
        low, high = (cells, high) if few else (low, cells - 1)
    return _clustered(points, triangles, used, _keys(points[used], facing[used], low))


def _clustered(
    points: Array, triangles: IntArray, used: IntArray, keys: IntArray
) -> tuple[IntArray, IntArray]:
    """Each cluster becomes the point of it that is nearest to its mean."""
    _, cluster, count = np.unique(keys, return_inverse=True, return_counts=True)
    sums = np.array([np.bincount(cluster, x) for x in points[used].T])
    apart = np.linalg.norm(points[used] - (sums / count).T[cluster], axis=1)
    order = np.lexsort((apart, cluster))
    first = np.concatenate([[0], np.cumsum(count)[:-1]])
    chosen = used[order[first]]
    becomes = np.arange(len(points))
    becomes[used] = chosen[cluster]
    merged = becomes[triangles]
    a, b, c = merged.T
    whole = merged[(a != b) & (b != c) & (c != a)]
    return _renumbered(np.unique(whole), len(points), whole)


def _renumbered(chosen: IntArray, points: int, triangles: IntArray) -> tuple[IntArray, IntArray]:
    place = np.zeros(points, dtype=np.int64)
    place[chosen] = np.arange(len(chosen))
    return chosen, place[triangles]


def _facing(points: Array, triangles: IntArray) -> IntArray:
    """Which of the six directions of the axes the surface at each point looks to most (p,)."""
    normals = normals_of(points, triangles)
    summed = np.zeros_like(points)
    for corner in triangles.T:
        np.add.at(summed, corner, normals)
    axis = np.abs(summed).argmax(axis=1)
    positive = np.take_along_axis(summed, axis[:, None], axis=1)[:, 0] > 0.0
    facing: IntArray = 2 * axis + positive
    return facing


def _keys(points: Array, facing: IntArray, cells: int) -> IntArray:
    """A number for each cell and direction, the same for points that become one."""
    low = points.min(axis=0)
    edge = max(float(np.ptp(points, axis=0).max()), np.finfo(float).tiny) / cells
    i, j, k = np.minimum((points - low) / edge, cells - 1).astype(np.int64).T
    keys: IntArray = ((i * cells + j) * cells + k) * 6 + facing
    return keys
