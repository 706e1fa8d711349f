"""Symmetric matrices summed from element matrices, a block for every pair of nodes."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from ...superelement.validation import Array
from ..mesh.mesh import IntArray
from ..sparse import stacked
from ..threads import in_order

BLOCKS_PER_PIECE = 2**16  # of the rows of a matrix, so that they stay in the cache


@dataclass(frozen=True, eq=False)
class Pattern:
    """The pairs of nodes that share an element.

    numbers (n_nodes, n_nodes), csr, sorted: at (i, j) and at (j, i) the number of the block of a
    pair. The n_blocks blocks (i, j), i <= j, are counted by rows and then by columns. An element of
    k nodes has a pair for each entry of the upper triangle of a k by k matrix (numpy's
    triu_indices).
    """

    numbers: Any
    n_blocks: int

    @property
    def n_nodes(self) -> int:
        return int(self.numbers.shape[0])

    def entries(self, cells: IntArray, b: int) -> IntArray:
        """Where blocks (pairs, n, b, b) of elements (n, k) go in sums (n_blocks, b, b), flat.

        A block whose first node has the higher number goes in transposed.
        """
        i, j = np.triu_indices(cells.shape[1])
        first, second = cells.T[i].ravel(), cells.T[j].ravel()
        straight = np.arange(b * b)
        orders = np.stack([straight, straight.reshape(b, b).T.ravel()])
        starts = b * b * self.numbers[first, second].astype(np.int64)
        return np.asarray((starts[:, None] + orders[(first > second).astype(int)]).ravel())

    def matrix(self, total: Array, copies: int = 1) -> Any:
        """The sparse matrix (b n_nodes, b n_nodes) of blocks (n_blocks, b, b), symmetric to the
        last bit; with `copies` c > 1 that matrix times I (c, c).
        """
        b = total.shape[-1]

        def piece(nodes: slice) -> Any:
            rows = self._rows(nodes, total).tocsr()
            return rows if copies == 1 else _times_identity(rows, copies)

        pieces = in_order(piece, self._pieces())
        return stacked(pieces, b * copies * self.n_nodes, b * b * copies * self.numbers.nnz)

    def _pieces(self) -> Iterator[slice]:
        """Nodes that follow each other, with some BLOCKS_PER_PIECE blocks in their rows."""
        steps = np.arange(BLOCKS_PER_PIECE, self.numbers.nnz, BLOCKS_PER_PIECE)
        ends = [*np.unique(np.searchsorted(self.numbers.indptr, steps)).tolist(), self.n_nodes]
        return (slice(a, b) for a, b in zip([0, *ends], ends, strict=False) if a < b)

    def _rows(self, nodes: slice, total: Array) -> Any:
        """The rows of some nodes, as blocks."""
        rows = self.numbers[nodes]
        of_row = np.repeat(np.arange(nodes.start, nodes.stop), np.diff(rows.indptr))
        blocks = total[rows.data]
        below, middle = rows.indices < of_row, rows.indices == of_row
        blocks[below] = blocks[below].swapaxes(1, 2)
        # A block of the diagonal is symmetric but for rounding.
        blocks[middle] = 0.5 * blocks[middle] + 0.5 * blocks[middle].swapaxes(1, 2)
        b, (n, n_nodes) = total.shape[-1], rows.shape
        return sp.bsr_array((blocks, rows.indices, rows.indptr), shape=(b * n, b * n_nodes))


def _times_identity(rows: Any, c: int) -> Any:
    """The Kronecker product of a csr matrix with I (c, c), without the zeros."""
    repeated = rows[np.repeat(np.arange(rows.shape[0]), c)]
    of_row = np.tile(np.arange(c), rows.shape[0])
    columns = c * repeated.indices + np.repeat(of_row, np.diff(repeated.indptr))
    shape = (c * rows.shape[0], c * rows.shape[1])
    return sp.csr_array((repeated.data, columns, repeated.indptr), shape=shape)


def pattern(elements: Mapping[str, IntArray], n_nodes: int) -> Pattern:
    """The pattern of elements (n, k) of each type."""
    numbers = sum(_neighbors(cells, n_nodes) for cells in elements.values())
    numbers.sort_indices()
    of_row = np.repeat(np.arange(n_nodes), np.diff(numbers.indptr))
    # Half of the blocks are stored: the other half are their transposes.
    upper = numbers.indices >= of_row
    n_blocks = int(np.count_nonzero(upper))
    counted = np.arange(n_blocks, dtype=numbers.indices.dtype)
    starts = np.concatenate([[0], np.cumsum(upper)])[numbers.indptr]
    half = sp.csr_array((counted, numbers.indices[upper], starts), shape=numbers.shape)
    numbers.data = np.empty(numbers.nnz, dtype=counted.dtype)
    numbers.data[upper] = counted
    numbers.data[numbers.indices <= of_row] = half.tocsc().data
    return Pattern(numbers, n_blocks)


def _neighbors(cells: IntArray, n_nodes: int) -> Any:
    """How many elements (n, k) each pair of nodes shares (n_nodes, n_nodes), csr."""
    n, k = cells.shape
    ones = np.ones(cells.size, dtype=np.int32)
    of_element = sp.csr_array(
        (ones, cells.ravel(), np.arange(0, cells.size + 1, k)), shape=(n, n_nodes)
    )
    return of_element.T.tocsr() @ of_element
