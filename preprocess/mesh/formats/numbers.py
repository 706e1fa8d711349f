"""Numbers of a file from front to back, written as text or as bytes."""

from typing import Any

import numpy as np

from ...errors import MeshError
from ..mesh import IntArray
from ..numbering import is_whole

Column = tuple[str, int]
"""A type, "i" (int), "u" (size) or "d" (double), and how many of it stand in a row."""


class TextNumbers:
    """Numbers between blanks."""

    def __init__(self, text: bytes) -> None:
        try:
            self._values = np.array(text.split(), dtype=float)
        except ValueError as error:
            raise MeshError(f"expected numbers: {error}") from error

    def table(self, rows: int, *columns: Column) -> list[Any]:
        """The next rows, split into arrays (rows, n) for each column; `MeshError` if there are
        fewer.
        """
        width = sum(count for _, count in columns)
        if min(rows, *(count for _, count in columns)) < 0 or rows * width > self.left:
            raise MeshError(f"expected {rows} rows of {width} numbers, found {self.left} numbers")
        values, self._values = np.split(self._values, [rows * width])
        ends = np.cumsum([count for _, count in columns])[:-1]
        parts = np.split(values.reshape(rows, width), ends, axis=1)
        return [
            part if code == "d" else _integers(part)
            for part, (code, _) in zip(parts, columns, strict=True)
        ]

    def ahead(self, count: int) -> list[int]:
        """The next integers, without taking them."""
        if self.left < count:
            raise MeshError(f"expected {count} more numbers, found {self.left}")
        numbers: list[int] = _integers(self._values[:count]).tolist()
        return numbers

    def alike(self, width: int, columns: slice, limit: int) -> int:
        """The number of next rows, `limit` at most, that equal the first in some columns."""
        asked = 1
        while True:
            n_rows = min(asked, limit, self.left // width)
            rows = self._values[: n_rows * width].reshape(n_rows, width)[:, columns]
            differs = (rows != rows[:1]).any(axis=1)
            if differs.any():
                return int(differs.argmax())
            if n_rows < asked:
                return n_rows
            asked *= 2

    @property
    def left(self) -> int:
        return len(self._values)


class BinaryNumbers:
    """Numbers as the machine that wrote them had them; order: "<" or ">", size: bytes of a size."""

    def __init__(self, data: memoryview, order: str, size: int) -> None:
        self._data = data
        self._types = {"i": f"{order}i4", "u": f"{order}u{size}", "d": f"{order}f8"}

    def table(self, rows: int, *columns: Column) -> list[Any]:
        """The next rows, as `TextNumbers.table`."""
        rows = int(rows)  # numpy's integers overflow
        width = sum(int(count) * np.dtype(self._types[code]).itemsize for code, count in columns)
        if min(rows, *(count for _, count in columns)) < 0 or rows * width > self.left:
            raise MeshError(f"expected {rows} rows of {width} bytes, found {self.left} bytes")
        row = np.dtype(
            [(str(i), self._types[code], (count,)) for i, (code, count) in enumerate(columns)]
        )
        table = np.frombuffer(self._data, row, rows)
        self._data = self._data[rows * row.itemsize :]
        return [
            table[str(i)].astype(float if code == "d" else np.int64)
            for i, (code, _) in enumerate(columns)
        ]

    @property
    def left(self) -> int:
        return len(self._data)


Numbers = TextNumbers | BinaryNumbers


def _integers(values: Any) -> IntArray:
    if not (whole := is_whole(values)).all():
        raise MeshError(f"expected an integer, found {values[~whole][0]}")
    return np.asarray(values.astype(np.int64))
