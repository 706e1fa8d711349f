"""Arrays of numbers as the compiled time step expects them."""

from collections.abc import Iterable
from itertools import accumulate
from typing import Any

import numpy as np

from ..files.arrays import Array as Array
from ..files.arrays import Index as Index


def as_index(values: Any) -> Index:
    """Integers (n,) of 64 bits."""
    return np.array(values, dtype=np.int64).reshape(-1)


def as_rows(vectors: Any) -> Array:
    """Three-vectors (n, 3), n = 0 included."""
    return np.array(vectors, dtype=np.float64).reshape(-1, 3)


def starts(lengths: Iterable[int]) -> Index:
    """The first of each of some ranges that follow one another, and the end of the last."""
    return as_index([0, *accumulate(lengths)])


def distinct(values: Any) -> Any:
    """The values of an array, each once, in ascending order (n,).

    As `np.unique` has them, which loads numpy's masked arrays: 13 ms of a first start.
    """
    ordered = np.sort(np.ravel(values))
    first = np.ones(len(ordered), dtype=bool)
    first[1:] = ordered[1:] != ordered[:-1]
    return ordered[first]
