"""Blocks along the diagonal of a matrix, which need not be square."""

from collections.abc import Sequence
from typing import Any

import numpy as np


def diagonal_blocks(blocks: Sequence[Any]) -> Any:
    """Blocks (n_k, m_k) along the diagonal of a matrix of zeros; none: (0, 0)."""
    rows = np.cumsum([0, *(block.shape[0] for block in blocks)])
    columns = np.cumsum([0, *(block.shape[1] for block in blocks)])
    kind = np.result_type(np.float64, *(block.dtype for block in blocks))
    matrix = np.zeros((int(rows[-1]), int(columns[-1])), dtype=kind)
    for block, row, column in zip(blocks, rows.tolist(), columns.tolist(), strict=False):
        matrix[row : row + block.shape[0], column : column + block.shape[1]] = block
    return matrix
