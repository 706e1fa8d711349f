"""Matrix Market files (.mtx): real matrices, sparse or dense, general or symmetric.

Not by scipy, whose reader ends the process on some damaged files. Source: R. F. Boisvert, R. Pozo,
K. Remington, The Matrix Market Exchange Formats, NISTIR 5935 (1996).
"""

from pathlib import Path
from typing import Any, TextIO

import numpy as np
import scipy.sparse as sp

from ..errors import MatrixError
from .damage import load_rows, whole_numbers

MARKET_HEAD = "%%MatrixMarket"
ROW_NUMBERS = {"coordinate": 3, "array": 1}  # of sparse and dense matrices


def read_market(path: Path) -> Any:
    """The matrix, sparse; of a symmetric one the half that the file has. `MatrixError`."""
    with path.open(encoding="utf-8") as file:
        form, symmetry = _head(file.readline())
        size = _size(file)
        # numpy refuses ragged rows with the line, so nothing is to be checked by hand.
        rows = load_rows(file, comments="%")
    if rows.size and rows.shape[1] != ROW_NUMBERS[form]:
        raise MatrixError(f"expected {ROW_NUMBERS[form]} numbers in a row, found {rows.shape[1]}")
    expected = 3 if form == "coordinate" else 2
    if len(size) != expected:
        raise MatrixError(f"not a Matrix Market file: expected {expected} sizes, found {size}")
    if form == "coordinate":
        return _sparse(rows.reshape(-1, 3), size)
    return _dense(rows.reshape(-1), size, symmetry)


def _head(line: str) -> tuple[str, str]:
    words = line.lower().split()
    if len(words) != 5 or words[1] != "matrix" or words[2] not in ROW_NUMBERS:
        raise MatrixError(
            f"expected '{MARKET_HEAD} matrix coordinate real general', found {line[:80]!r}"
        )
    _, _, form, numbers, symmetry = words
    if numbers not in ("real", "double", "integer"):
        raise MatrixError(f"expected real numbers, found {numbers[:20]} ones")
    if symmetry not in ("general", "symmetric"):
        raise MatrixError(f"expected a general or symmetric matrix, found {symmetry[:20]!r}")
    return form, symmetry


def _size(file: TextIO) -> list[int]:
    """The first line that is neither empty nor a comment."""
    for line in file:
        if line.strip() and not line.startswith("%"):
            sizes = whole_numbers(np.array(line.split()[:4], dtype=float), "sizes")
            return [int(size) for size in sizes]
    raise MatrixError("expected the size of a matrix, found none")


def _sparse(rows: Any, size: list[int]) -> Any:
    n_rows, n_columns, count = size
    if len(rows) != count:
        raise MatrixError(f"expected {count} entries, found {len(rows)}")
    places = whole_numbers(rows[:, :2], "rows and columns") - 1
    if count and (places.min() < 0 or (places.max(axis=0) >= [n_rows, n_columns]).any()):
        raise MatrixError(
            f"expected rows 1 to {n_rows} and columns 1 to {n_columns}, found "
            f"{(places.min(axis=0) + 1).tolist()} to {(places.max(axis=0) + 1).tolist()}"
        )
    return sp.coo_array((rows[:, 2], tuple(places.T)), shape=(n_rows, n_columns))


def _dense(values: Any, size: list[int], symmetry: str) -> Any:
    """Values column by column; of a symmetric matrix from the diagonal down."""
    n_rows, n_columns = size
    half = symmetry == "symmetric"
    count = n_rows * (n_rows + 1) // 2 if half else n_rows * n_columns
    if len(values) != count or (half and n_rows != n_columns):
        raise MatrixError(f"expected {count} values, found {len(values)}")
    matrix = np.zeros((n_columns, n_rows))
    matrix[np.triu_indices(n_rows) if half else ...] = (
        values if half else values.reshape(n_columns, n_rows)
    )
    return sp.coo_array(matrix.T)
