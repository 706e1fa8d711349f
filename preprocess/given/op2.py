"""Matrices in Nastran's OUTPUT2 files (.op2), of either order of bytes and words of 4 or 8 bytes.

Records of Fortran. A record of one word is a key: a positive one tells the words of the record that
follows, others structure the file. A data block is its name, a trailer (number, columns, rows,
form, type, ...) and records, of which those of type 1 are columns of a matrix: strings of a first
row and values. Source: MSC Nastran DMAP Programmer's Guide, OUTPUT2.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp

from ...files import in_one_line
from ..errors import MatrixError
from ..mesh.mesh import IntArray
from .damage import MATRIX_DAMAGE
from .matrix_names import chosen_name

TAPE_HEADER = 3  # the first key of a file that begins with date and label
COLUMN_RECORD = 1
PRECISION_TYPES = (1, 2)  # single and double


def read_op2(path: Path, names: tuple[str, ...]) -> Any:
    """The real matrix (n, n), sparse, of the first of some names, or the only one in the file.

    `MatrixError` if there is none.
    """
    try:
        found = dict(_blocks(path.read_bytes()))
    except MATRIX_DAMAGE as error:
        raise MatrixError(
            f"not an OUTPUT2 file of Nastran, or one that breaks off: {in_one_line(error)}"
        ) from error
    # Tables have no columns, and are no matrices.
    name = chosen_name([name for name, (_, columns) in found.items() if columns], names)
    trailer, columns = found[name]
    if trailer[4] not in PRECISION_TYPES:
        raise MatrixError(f"matrix {name}: expected real numbers, found type {trailer[4]}")
    if len(columns) != trailer[1]:
        raise MatrixError(
            f"matrix {name}: expected {trailer[1]} columns, found {len(columns)}: it breaks off"
        )
    return _matrix(trailer, columns)


Column = list[tuple[int, Any]]
"""Strings of a column: the first row, from 0, and values below each other."""


def _matrix(trailer: IntArray, columns: list[Column]) -> Any:
    strings = [(row, number, values) for number, c in enumerate(columns) for row, values in c]
    rows = [row + np.arange(len(values)) for row, _, values in strings]
    owner = [np.full(len(values), number) for _, number, values in strings]
    empty = np.zeros(0, dtype=np.int64)
    return sp.coo_array(
        (
            np.concatenate([np.zeros(0), *(values for _, _, values in strings)]),
            (np.concatenate([empty, *rows]), np.concatenate([empty, *owner])),
        ),
        shape=(int(trailer[2]), int(trailer[1])),
    )


class _Records:
    """The records of a file, one after the other; `ValueError` for one that breaks off."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        # The first record is a key: its length is that of a word.
        self.order = "<" if data[:4] in (b"\4\0\0\0", b"\10\0\0\0") else ">"
        self.word = int(np.frombuffer(data[:4], f"{self.order}i4")[0])
        if self.word not in (4, 8):
            raise ValueError(f"expected a first record of 4 or 8 bytes, found {self.word}")
        self._position = 0

    def __bool__(self) -> bool:
        return self._position < len(self._data)

    def record(self) -> bytes:
        length = int(np.frombuffer(self._data, f"{self.order}i4", 1, self._position)[0])
        body = self._data[self._position + 4 : self._position + 4 + length]
        if length < 0 or len(body) < length:
            raise ValueError(f"a record of {length} bytes, of which {len(body)} are there")
        self._position += length + 8
        return body

    def integers(self, body: bytes) -> IntArray:
        return np.frombuffer(body, f"{self.order}i{self.word}").astype(np.int64)

    def key(self) -> int:
        body = self.record()
        if len(body) != self.word:
            raise ValueError(f"expected a key of {self.word} bytes, found {len(body)}")
        return int(self.integers(body)[0])


def _blocks(data: bytes) -> Iterator[tuple[str, tuple[IntArray, list[Column]]]]:
    """Name, trailer and columns of all data blocks; of tables there are no columns."""
    records = _Records(data)
    while records:
        key = records.key()
        if key == TAPE_HEADER:
            # Date, key, title, key, label, and two keys that end them.
            for _ in range(5):
                records.record()
            records.key()
            records.key()
            continue
        # The end of the file; a first key tells the words of a name.
        if key <= 0:
            return
        name = records.record().decode("ascii").replace("\0", " ").split()[0]
        records.key()
        records.key()
        trailer = records.integers(records.record())
        # The header of the block repeats its name.
        while records.key() <= 0 or not _is_header(records):
            continue
        yield name, (trailer, list(_columns(records, trailer)))


def _is_header(records: _Records) -> bool:
    return len(records.record()) > records.word


def _columns(records: _Records, trailer: IntArray) -> Iterator[Column]:
    """The columns of a matrix, some of which are empty; records of tables are passed over."""
    # With words of 8 bytes single precision takes as many.
    value = "f8" if trailer[4] == 2 or records.word == 8 else "f4"
    records.key()  # the number of the record, as later the last key of each
    while True:
        records.key()
        kind, key = records.key(), records.key()
        if key == 0:
            return
        strings: Column = []
        while key > 0:
            body = records.record()
            if kind == COLUMN_RECORD:
                first = int(records.integers(body[: records.word])[0]) - 1
                strings.append((first, np.frombuffer(body[records.word :], records.order + value)))
            key = records.key()
        if kind == COLUMN_RECORD:
            yield strings
