"""Nastran's OUTPUT4 files (.op4), binary and text; dense, sparse, or sparse and long (BIGMAT).

Each column is a record ICOL, IROW, NW and NW words: the values from IROW on, or for IROW = 0
strings of them with a header each, IS = IROW + 65536 (L + 1) or for BIGMAT the pair L + 1, IROW,
for L words. A last column NCOL + 1 ends it. Source: MSC Nastran DMAP Programmer's Guide, OUTPUT4.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp

from ...files import in_one_line
from ..errors import MatrixError
from .damage import MATRIX_DAMAGE
from .matrix_names import chosen_name

BIGMAT_ROWS = 65536  # from which on a matrix is BIGMAT, whether it says so or not
_HEADERS = {24: ("i4", 8), 48: ("i8", 16)}
"""By the length of the first record: the type of integers, and the letters of the name."""
_REAL = {1: "f4", 2: "f8"}

Run = tuple[int, int, Any]
"""Column and first row, from 1, and values below each other."""


def read_op4(path: Path, names: tuple[str, ...]) -> Any:
    """The real matrix (n, n), sparse, of the first of some names, or the only one in the file.

    `MatrixError` if there is none.
    """
    data = path.read_bytes()
    try:
        matrices = dict(
            _text(data.decode()) if data[:16].strip(b" 0123456789-") == b"" else _binary(data)
        )
    except MATRIX_DAMAGE as error:
        raise MatrixError(
            f"not an OUTPUT4 file of Nastran, or one that breaks off: {in_one_line(error)}"
        ) from error
    chosen = chosen_name(matrices, names)
    if matrices[chosen] is None:
        raise MatrixError(f"matrix {chosen}: expected real numbers, found complex ones")
    return matrices[chosen]


def _matrix(columns: int, rows: int, kind: int, runs: list[Run]) -> Any:
    """The sparse matrix (rows, columns); None for a complex one."""
    if kind not in _REAL:
        return None
    lengths = np.array([len(values) for _, _, values in runs], dtype=np.int64)
    column = np.repeat(np.array([run[0] for run in runs], dtype=np.int64), lengths) - 1
    first = np.repeat(np.array([run[1] for run in runs], dtype=np.int64), lengths) - 1
    within = np.arange(lengths.sum()) - np.repeat(np.cumsum(lengths) - lengths, lengths)
    values = np.concatenate([np.zeros(0), *(values for _, _, values in runs)])
    return sp.coo_array((values, (first + within, column)), shape=(abs(rows), columns))


def _binary(data: bytes) -> Iterator[tuple[str, Any]]:
    """Records of Fortran, with their lengths in bytes before and after."""
    order = "<" if int.from_bytes(data[:4], "little") in _HEADERS else ">"
    position = 0

    def record() -> bytes:
        nonlocal position
        length = int(np.frombuffer(data, f"{order}i4", 1, position)[0])
        payload = data[position + 4 : position + 4 + length]
        if len(payload) < length:
            raise ValueError(f"a record of {length} bytes, of which {len(payload)} are there")
        position += length + 8
        return payload

    while position < len(data):
        head = record()
        if len(head) not in _HEADERS:
            raise ValueError(f"a first record of {len(head)} bytes")
        integer, letters = _HEADERS[len(head)]
        word = np.dtype(order + integer)
        columns, rows, _, kind = np.frombuffer(head, word, 4).tolist()
        name = head[-letters:].decode().strip()
        value = np.dtype(order + _REAL.get(kind, "f8"))
        runs: list[Run] = []
        while True:
            body = record()
            column, first, _ = np.frombuffer(body, word, 3).tolist()
            if column > columns:
                break
            # Nastran marks BIGMAT by a negative count of rows; large matrices are so without a
            # mark.
            long = rows < 0 or rows >= BIGMAT_ROWS
            runs += _runs(body[3 * word.itemsize :], column, first, long, word, value)
        yield name, _matrix(columns, rows, kind, runs)


def _runs(body: bytes, column: int, first: int, long: bool, word: Any, value: Any) -> Iterator[Run]:
    """The strings of values in the record of a column."""
    if first:
        yield column, first, np.frombuffer(body, value)
        return
    position = 0
    while position < len(body):
        head = np.frombuffer(body, word, 1 + long, position).tolist()
        words, row = (head[0], head[1]) if long else divmod(head[0], BIGMAT_ROWS)
        words -= 1
        position += (1 + long) * word.itemsize
        if words < 1:
            raise ValueError(f"a string of {words} words")
        count = words * word.itemsize // value.itemsize
        yield column, row, np.frombuffer(body, value, count, position)
        position += words * word.itemsize


def _text(text: str) -> Iterator[tuple[str, Any]]:
    """The matrices of a text file: integers head columns (3) and strings (1 or 2); values have
    points.
    """
    lines = iter(text.splitlines())
    for head in lines:
        # Four integers of equal width, the name, and the format of the values: 1P,3E23.16.
        width = 8 if head[32:33].isalpha() else 16
        columns, rows, _, kind = (int(head[i * width : (i + 1) * width]) for i in range(4))
        name, _, form = head[4 * width :].partition("1P,")
        size = int(form.split("E")[1].split(".")[0])
        runs: list[Run] = []
        column = row = 0
        while column <= columns:
            line = next(lines, "")
            if "." in line:
                # Fields may touch each other: widths, not blanks, tell them apart.
                line = line.replace("D", "E").rstrip()
                values = np.array([float(line[i : i + size]) for i in range(0, len(line), size)])
                runs.append((column, row, values))
                row += len(values)
                continue
            match [int(part) for part in line.split()]:
                case [column, row, _]:
                    pass
                case [_, row]:
                    pass
                case [string]:
                    row = string % BIGMAT_ROWS
                case _:
                    raise ValueError(f"matrix {name.strip()}, after column {column}: {line!r}")
        next(lines, "")  # a value that stands for the last column
        yield name.strip(), _matrix(columns, rows, kind, runs)
