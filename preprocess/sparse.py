"""Sparse matrices from rows with few columns, and large symmetric ones from pieces of rows."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import scipy.sparse as sp

from ..superelement.cells import IntArray
from ..superelement.validation import Array

LARGEST_INDEX = int(np.iinfo(np.int32).max)  # up to which indices take four bytes


def index_type(largest: int) -> Any:
    """The type of indices up to a number: int32 where that suffices, or else int64."""
    return np.int32 if largest <= LARGEST_INDEX else np.int64


def in_columns(rows: Array, columns: IntArray, n: int) -> Any:
    """Dense rows (r, k) as sparse ones (r, n), whose entries are in some columns (k,)."""
    of_row = np.repeat(np.arange(len(rows)), len(columns))
    places = (of_row, np.tile(columns, len(rows)))
    return sp.coo_array((rows.ravel(), places), shape=(len(rows), n)).tocsr()


def stacked(pieces: Iterable[Any], n: int, most: int) -> Any:
    """The symmetric matrix (n, n), csc, with the rows of `pieces` (csr) one below the other.

    most: how many entries it has at most. The rows of a symmetric matrix are its columns: nothing
    is sorted or turned, and no more memory is touched than the matrix takes.
    """
    kind = index_type(max(n, most))
    data, indices, starts = np.empty(most), np.empty(most, kind), np.zeros(n + 1, kind)
    row = end = 0
    for piece in pieces:
        filled = slice(end, end + piece.nnz)
        data[filled], indices[filled] = piece.data, piece.indices
        starts[row + 1 : row + 1 + piece.shape[0]] = end + piece.indptr[1:].astype(kind)
        row, end = row + piece.shape[0], filled.stop
    matrix = sp.csc_array((n, n))
    # The constructor would look at all indices, and choose their type itself.
    matrix.data, matrix.indices, matrix.indptr = data[:end], indices[:end], starts
    return matrix
