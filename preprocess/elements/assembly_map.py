"""Symmetric matrices summed from element matrices, a block for every pair of nodes."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from ...superelement.validation import Array
from ..mesh.mesh import IntArray


@dataclass(frozen=True, eq=False)
class Pattern:
    """The upper triangle of the blocks, ordered by rows and then by columns.

    rows, columns (n_blocks,), rows <= columns. An element of k nodes has a pair of nodes for each
    entry of the upper triangle of a k by k matrix (numpy's triu_indices). By type of element
    (pairs, n): slots, the block that a pair belongs to; turned, whether its first node has the
    higher number, so that its block goes in transposed.
    """

    n_nodes: int
    rows: IntArray
    columns: IntArray
    slots: Mapping[str, IntArray]
    turned: Mapping[str, np.ndarray[tuple[int, int], np.dtype[np.bool_]]]

    def add(self, total: Array, kind: str, elements: slice | IntArray, blocks: Array) -> None:
        """Add blocks (pairs, n, b, b) of elements of a type to the sums (n_blocks, b, b)."""
        b = blocks.shape[-1]
        straight = np.arange(b * b)
        orders = np.stack([straight, straight.reshape(b, b).T.ravel()])
        entries = (
            b * b * self.slots[kind][:, elements, None]
            + orders[self.turned[kind][:, elements].astype(int)]
        )
        np.add.at(total.reshape(-1), entries.ravel(), blocks.ravel())

    def matrix(self, total: Array) -> Any:
        """The sparse matrix (b n_nodes, b n_nodes) of blocks (n_blocks, b, b), symmetric to the
        last bit.
        """
        b = total.shape[-1]
        # Half of each diagonal block, for it meets its own transpose.
        upper = total * np.where(self.rows == self.columns, 0.5, 1.0)[:, None, None]
        starts = np.searchsorted(self.rows, np.arange(self.n_nodes + 1)).astype(np.int32)
        shape = (b * self.n_nodes, b * self.n_nodes)
        half = sp.bsr_array((upper, self.columns.astype(np.int32), starts), shape=shape)
        full = (half + half.T).tocsr()
        return sp.csc_array((full.data, full.indices, full.indptr), shape=full.shape)


def pattern(elements: Mapping[str, IntArray], n_nodes: int) -> Pattern:
    """The pattern of elements (n, k) of each type."""
    keys, turned = {}, {}
    for kind, cells in elements.items():
        i, j = np.triu_indices(cells.shape[1])
        first, second = cells.T[i], cells.T[j]
        turned[kind] = first > second
        keys[kind] = np.minimum(first, second) * n_nodes + np.maximum(first, second)
    blocks, slots = np.unique(
        np.concatenate([key.ravel() for key in keys.values()]), return_inverse=True
    )
    parts = np.split(slots, np.cumsum([key.size for key in keys.values()])[:-1])
    shaped = {kind: part.reshape(keys[kind].shape) for kind, part in zip(keys, parts, strict=True)}
    return Pattern(n_nodes, blocks // n_nodes, blocks % n_nodes, shaped, turned)
