"""Numbers that files give to nodes and elements."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import MeshError
from .mesh import IntArray


def is_whole(values: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Where numbers are integers, and so small that a float holds them exactly."""
    whole = np.abs(values) < 2.0**53
    # Not a number modulo 1 would warn.
    whole[whole] = values[whole] % 1.0 == 0.0
    return whole


class Numbering:
    """Numbers (n,) of nodes or elements in a file, and the row of each."""

    def __init__(self, numbers: ArrayLike, what: str) -> None:
        self._what = what
        array = np.asarray(numbers, dtype=np.int64)
        self._order = np.argsort(array, kind="stable")
        self._sorted = array[self._order]
        twice = self._sorted[1:][self._sorted[1:] == self._sorted[:-1]]
        if len(twice):
            raise MeshError(f"{what} {twice[0]} is there more than once")

    def __len__(self) -> int:
        return len(self._sorted)

    def known(self, numbers: ArrayLike) -> NDArray[np.bool_]:
        """True for numbers in the file, in their shape."""
        return self._found(np.asarray(numbers, dtype=np.int64))[1]

    def within(self, numbers: range) -> IntArray:
        """The rows of those numbers of a range that are in the file."""
        inside = (self._sorted >= numbers.start) & (self._sorted < numbers.stop)
        inside &= (self._sorted - numbers.start) % numbers.step == 0
        return self._order[inside]

    def rows(self, numbers: ArrayLike, user: str) -> IntArray:
        """The rows of numbers, in their shape; `MeshError` names `user` and a missing number."""
        wanted = np.asarray(numbers, dtype=np.int64)
        places, known = self._found(wanted)
        if not known.all():
            raise MeshError(f"{user}: no {self._what} {wanted[~known][0]} in the file")
        return self._order[places]

    def _found(self, wanted: IntArray) -> tuple[IntArray, NDArray[np.bool_]]:
        """Where wanted numbers are among the sorted ones, and which of them are there."""
        if not len(self._sorted):
            return np.zeros(wanted.shape, dtype=np.int64), np.zeros(wanted.shape, dtype=np.bool_)
        first = self._sorted[0]
        if self._sorted[-1] - first == len(self._sorted) - 1:  # none is left out
            places = wanted - first
        else:
            places = np.searchsorted(self._sorted, wanted)
        places = places.clip(0, len(self._sorted) - 1)
        return places, self._sorted[places] == wanted
