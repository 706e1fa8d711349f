"""Arrays of bodies one after the other, each shared by those that have the same."""

from collections.abc import Sequence

import numpy as np

from ..arrays import Array, Index, as_index


def packed(arrays: Sequence[Array], owners: Sequence[int]) -> tuple[Array, Index]:
    """The arrays one after the other, each owner's once, and the start of each."""
    starts: dict[int, int] = {}
    flat: list[Array] = []
    length = 0
    for array, owner in zip(arrays, owners, strict=True):
        if owner not in starts:
            starts[owner] = length
            flat.append(array.ravel())
            length += array.size
    return np.concatenate([np.empty(0), *flat]), as_index([starts[owner] for owner in owners])
