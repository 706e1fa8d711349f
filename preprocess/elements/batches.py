"""Elements by material, some at a time."""

from collections.abc import Iterator

import numpy as np

from ..mesh.mesh import IntArray


def batched(owners: IntArray, size: int) -> Iterator[tuple[int, IntArray]]:
    """Elements of one owner at a time, at most `size` of them: the owner, and which elements."""
    # One elasticity for a batch, which all of its products then share.
    for owner in np.unique(owners).tolist():
        rows = np.flatnonzero(owners == owner)
        for start in range(0, len(rows), size):
            yield owner, rows[start : start + size]
