"""Labels of nodes with directions, as the rows of a matrix."""

import numpy as np

from ..errors import MatrixError
from ..mesh.mesh import IntArray

MAX_LABEL = 2.0**31  # a label or a row: two of them are one number of 64 bits


def numbered(pairs: IntArray) -> tuple[IntArray, IntArray]:
    """The different dofs (k, 2) among pairs (n, 2) of label and direction, and the row of each."""
    # One number for node and dof: rows of a table sort much slower.
    width = int(pairs[:, 1].max(initial=0)) + 1
    if width > MAX_LABEL:
        raise MatrixError(f"expected dofs of nodes, 1 to 6, found {width - 1}")
    keys, number = np.unique(pairs[:, 0] * width + pairs[:, 1], return_inverse=True)
    return np.stack([keys // width, keys % width], axis=1), number
