"""The outline of a body: what it looks like at rest."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..files.arrays import Array, IntArray
from .cells import LINE_POINTS, TRIANGLES_OF_FACET, checked_cells, of_size, sizes, triangles
from .recovery import Recovery
from .validation import SuperelementError, checked

# Relative to the size of the body; a node is the mean of the points of its section.
RELATIVE_POINT_DISTANCE = 1e-6


@dataclass(frozen=True, eq=False)
class Outline:
    """The shape of a body at rest, by points and facets.

    Parameters
    ----------
    points : (p, 3) [m]
        From the center of mass, in body axes.
    cells : (n, k) of int
        Facets, seen counterclockwise from outside, as rows of point numbers; -1 fills short rows.
        The type follows from the number of points, in meshio's order: 3 triangle, 4 quad,
        6 triangle6, 8 quad8, 9 quad9; 2 is a line without a section.
    node : (p,) of int, optional
        Of beams: the node of the line whose section carries each point, the number of a point of
        the recovery. None for solids, whose points are those of the recovery.

    Raises
    ------
    SuperelementError
        For point numbers out of range, and cells of other numbers of points.

    Examples
    --------
    >>> from duhamel.superelement.figures import box
    >>> outline = box((1.0, 2.0, 3.0))
    >>> outline.n_facets, round(outline.volume, 12)
    (6, 6.0)
    """

    points: Array
    cells: IntArray
    node: IntArray | None = None

    def __post_init__(self) -> None:
        points = checked("outline: points", self.points, ("p", 3))
        cells = checked_cells("outline: cells", self.cells, len(points))
        known = np.isin(sizes(cells), [LINE_POINTS, *TRIANGLES_OF_FACET])
        if not known.all():
            raise SuperelementError(
                "outline: cells: expected 2, 3, 4, 6, 8 or 9 points each, found "
                f"{int(sizes(cells)[~known][0])}"
            )
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "cells", cells)
        if self.node is not None:
            object.__setattr__(self, "node", _checked_nodes(self.node, len(points)))

    @property
    def triangles(self) -> IntArray:
        """Its facets cut into triangles (m, 3)."""
        return triangles(self.cells)

    @property
    def lines(self) -> IntArray:
        """Its lines (l, 2)."""
        return of_size(self.cells, LINE_POINTS)

    @property
    def n_facets(self) -> int:
        """The number of its facets, lines not counted."""
        return len(self.cells) - len(self.lines)

    @property
    def anchors(self) -> Array:
        """What each point moves with (p, 3): the node of its section, or the point itself [m].

        A node is in the middle of its section, so it is the mean of the points there.
        """
        if self.node is None:
            return self.points
        count = np.bincount(self.node)
        # bincount with weights adds the coordinates of all points of a node.
        sums = np.array([np.bincount(self.node, x) for x in self.points.T])
        return (sums / np.maximum(count, 1)).T[self.node]

    @property
    def volume(self) -> float:
        """What its facets enclose [m^3], by the divergence theorem: sum of a . (b x c) / 6."""
        a, b, c = self.points[self.triangles].transpose(1, 0, 2)
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)

    def fits(self, recovery: Recovery) -> bool:
        """Whether its points are those of a recovery, or its sections at nodes of one."""
        node = np.arange(len(self.points)) if self.node is None else self.node
        n = len(recovery.points)
        # A recovery of another mesh: its points would be indexed out of range.
        if node.max(initial=-1) >= n or (self.node is None and len(node) != n):
            return False
        size = float(np.ptp(self.points, axis=0).max(initial=0.0))
        return np.allclose(
            recovery.points[node], self.anchors, rtol=0.0, atol=RELATIVE_POINT_DISTANCE * size
        )


def _checked_nodes(value: Any, n_points: int) -> IntArray:
    node = np.array(value)
    if node.shape != (n_points,) or not np.issubdtype(node.dtype, np.integer):
        raise SuperelementError(
            f"outline: node: expected {n_points} integers, found {node.dtype} {node.shape}"
        )
    if node.size and node.min() < 0:
        raise SuperelementError(f"outline: node: expected 0 or more, found {node.min()}")
    node = node.astype(np.int64)
    node.flags.writeable = False
    return node
