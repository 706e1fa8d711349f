"""Copies of arrays in compiled code, which cannot assign one array to another."""

from ..arrays import Array
from .marks import compiled


@compiled
def copy(source: Array, out: Array) -> None:
    """out[...] = source for contiguous arrays of one shape (`build` makes it a memcpy)."""
    a, b = source.reshape(source.size), out.reshape(out.size)
    for i in range(len(a)):
        b[i] = a[i]
