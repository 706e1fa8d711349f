"""Long series with fewer points, of which no peak is lost."""

import numpy as np

from ...superelement.cells import IntArray
from ...superelement.validation import Array

# As many as a plot has pixels, about.
PLOT_COLUMNS = 1200


def kept(values: Array, columns: int = PLOT_COLUMNS) -> IntArray:
    """The numbers of the points (m,) that stand for a series (n,), in order.

    The series is cut into columns of equally many points, and of each the smallest and the largest
    value stay, so that the picture of the lines between them is that of the whole. The first and
    the last point stay too; all do where there are not more than two for each column.
    """
    n = len(values)
    if n <= 2 * columns:
        return np.arange(n)
    edges = np.linspace(0, n, columns + 1).astype(np.int64)
    known = np.where(np.isnan(values), np.inf, values)
    low = _of_columns(known, edges)
    high = _of_columns(np.where(np.isnan(values), np.inf, -values), edges)
    return np.unique(np.concatenate([[0], low, high, [n - 1]]))


def _of_columns(values: Array, edges: IntArray) -> IntArray:
    """The number of the smallest value of each column."""
    smallest = np.minimum.reduceat(values, edges[:-1])
    widths = np.diff(edges)
    equal = np.flatnonzero(values == np.repeat(smallest, widths))
    column = np.repeat(np.arange(len(widths)), widths)[equal]
    _, first = np.unique(column, return_index=True)
    return equal[first]
