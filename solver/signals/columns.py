"""Columns of numbers in text files: CSV, or separated by semicolons, tabs or blanks."""

import csv
import math
import os
from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ...inputs import InputError, quoted
from ...inputs.text import read_text
from ..arrays import Array
from ..errors import ModelError

# Tried in this order, blanks last: a comma may be a decimal mark where semicolons or tabs separate.
COLUMN_SEPARATORS = (";", "\t", ",")
MAX_COLUMNS_IN_MESSAGE = 12


class _Sheet(NamedTuple):
    """The rows of a file as text, with the numbers of their lines, from 1 on."""

    names: tuple[str, ...]
    rows: tuple[tuple[int, tuple[str, ...]], ...]
    decimal_comma: bool

    @property
    def width(self) -> int:
        """The number of columns of the first line."""
        return len(self.names) or (len(self.rows[0][1]) if self.rows else 0)


def names_of_columns(path: str) -> tuple[str, ...]:
    """The names in the first line of a file; none where that has numbers."""
    return _sheet(path).names


def number_of_column(path: str, column: str | int) -> int:
    """The index of a column that is given by its name, or its number from 1 on."""
    sheet = _sheet(path)
    if isinstance(column, int):
        if not 1 <= column <= sheet.width:
            there_are = f"there are {sheet.width}, from 1 on"
            raise ModelError(f"file: {path}: no column {column}; {there_are}")
        return column - 1
    if column not in sheet.names:
        listed = ", ".join(map(quoted, sheet.names[:MAX_COLUMNS_IN_MESSAGE])) or "none with a name"
        more = ", ..." if len(sheet.names) > MAX_COLUMNS_IN_MESSAGE else ""
        raise ModelError(f"file: {path}: no column {quoted(column)}; there are: {listed}{more}")
    if sheet.names.count(column) > 1:
        raise ModelError(f"file: {path}: more than one column is named {quoted(column)}")
    return sheet.names.index(column)


def column_of(path: str, column: str | int, increasing: bool = False) -> Array:
    """The numbers of a column (n,); ModelError names the file, the line and the column."""
    sheet, k = _sheet(path), number_of_column(path, column)
    numbers = np.empty(len(sheet.rows))
    before = -math.inf
    for n, (line, cells) in enumerate(sheet.rows):
        # Empty cells beyond the last column are harmless; others mean a shifted row.
        if any(cells[sheet.width :]):  # lines may end with separators
            raise ModelError(
                f"file: {path}: line {line}: expected {sheet.width} columns, as in the first line, "
                f"found {len(cells)}"
            )
        cell = cells[k] if k < len(cells) else ""
        number = _number(cell, sheet.decimal_comma)
        if not math.isfinite(number):
            found = quoted(cell) if cell else "nothing"
            raise ModelError(f"{_where(path, line, column)}: expected a number, found {found}")
        if increasing and number <= before:
            raise ModelError(
                f"{_where(path, line, column)}: times must increase, found {number:.9g} after "
                f"{before:.9g}"
            )
        # The first bad line is named, not the number of all.
        numbers[n] = before = number
    return numbers


def _where(path: str, line: int, column: str | int) -> str:
    return f"file: {path}: line {line}, column {quoted(column)}"


def _number(cell: str, decimal_comma: bool) -> float:
    """The number in a cell; no number (nan) for other text, and for two decimal marks in a file."""
    if decimal_comma and "." in cell:
        return math.nan
    try:
        return float(cell.replace(",", ".") if decimal_comma else cell)
    except ValueError:
        return math.nan


def _is_numeric(cell: str) -> bool:
    """True for what is written as a number, nan and inf among them."""
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return True


def _has_decimal_comma(cells: tuple[str, ...]) -> bool:
    return any("," in cell and _is_numeric(cell) for cell in cells)


def _sheet(path: str) -> _Sheet:
    try:
        status = os.stat(path)
        # Time and size are arguments only to serve as a key of the cache: a changed file is read
        # again.
        return _read(path, status.st_mtime_ns, status.st_size)
    except OSError as error:
        raise ModelError(f"file: {path}: not a readable file: {error.strerror or error}") from error
    except InputError as error:
        raise ModelError(f"file: {error}") from error
    except csv.Error as error:
        raise ModelError(f"file: {path}: not a table: {error}") from error


@lru_cache(maxsize=4)
def _read(path: str, changed: int, size: int) -> _Sheet:
    """The rows of a file of this size that was changed at this time."""
    # Spreadsheets write a byte order mark, which would become part of the first name.
    lines = _lines(read_text(path).removeprefix("\ufeff"))
    if not lines:
        raise InputError(f"{path}: expected rows of numbers, found none")
    text = "\n".join(line for _, line in lines[:2])
    # The second line has numbers, where the first may have names with commas in them.
    separator = next((mark for mark in COLUMN_SEPARATORS if mark in text), " ")
    rows = tuple(_cells(lines, separator))
    # One cell decides for the whole file: "1,234" alone could be either.
    comma = separator != "," and any(_has_decimal_comma(cells) for _, cells in rows)
    _, first = rows[0]
    if any(_is_numeric(cell) for cell in first):
        return _Sheet((), rows, comma)
    return _Sheet(first, rows[1:], comma)


def _lines(text: str) -> list[tuple[int, str]]:
    """Lines that are neither empty nor comments, with their numbers."""
    numbered = enumerate(text.splitlines(), start=1)
    return [(n, line) for n, line in numbered if line.strip() and not line.lstrip().startswith("#")]


def _cells(lines: list[tuple[int, str]], separator: str) -> Iterator[tuple[int, tuple[str, ...]]]:
    if separator == " ":
        yield from ((n, tuple(line.split())) for n, line in lines)
        return
    # csv knows quotes: a name may contain the separator.
    rows = csv.reader((line for _, line in lines), delimiter=separator, skipinitialspace=True)
    for (n, _), cells in zip(lines, rows, strict=False):
        yield n, tuple(cell.strip() for cell in cells)
