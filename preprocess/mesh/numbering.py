"""Numbers that files give to nodes and elements."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import MeshError
from .mesh import IntArray


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
        return np.isin(np.asarray(numbers, dtype=np.int64), self._sorted)

    def within(self, numbers: range) -> IntArray:
        """The rows of those numbers of a range that are in the file."""
        inside = (self._sorted >= numbers.start) & (self._sorted < numbers.stop)
        inside &= (self._sorted - numbers.start) % numbers.step == 0
        return self._order[inside]

    def rows(self, numbers: ArrayLike, user: str) -> IntArray:
        """The rows of numbers, in their shape; `MeshError` names `user` and a missing number."""
        wanted = np.asarray(numbers, dtype=np.int64)
        known = self.known(wanted)
        if not known.all():
            raise MeshError(f"{user}: no {self._what} {wanted[~known][0]} in the file")
        return self._order[np.searchsorted(self._sorted, wanted)]
