"""The summary of a study: a row a case."""

import csv
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..files import write_rows
from ..files.arrays import Array
from ..files.outputs import in_words
from ..inputs import InputError, quoted, read_text
from .case import Case
from .errors import StudyError
from .study_file import Study, units_beside

STATUS, MESSAGE = "status", "message"
"""columns: that after the parameters, and that after the numbers"""
# Columns of the file with units.
UNIT_COLUMNS = ("output", "unit")


@dataclass(frozen=True)
class Row:
    """A case in the summary of a study. See `sweep` for an example.

    Parameters
    ----------
    case : Case
    status : {"open", "done", "failed"}
        "open" where the study was stopped before it.
    numbers : dict of float
        Its outputs by name.
    message : str
        Why it failed.
    warnings : tuple of str
    reused : bool
        Its files existed already and were up to date.
    """

    case: Case
    status: str = "open"
    numbers: dict[str, float] = field(default_factory=dict)
    message: str = ""
    warnings: tuple[str, ...] = ()
    reused: bool = False


def write_summary(path: Path, study: Study, rows: Sequence[Row]) -> None:
    """Write the summary, a table of comma-separated values; `StudyError` where it cannot be.

    Columns: case, parameters, status, numbers and outputs in SI units, message.
    """
    parameters = list(study.cases[0].parameters)
    numbers = [*study.kind.columns, *study.outputs]
    table: list[list[Any]] = [["case", *parameters, STATUS, *numbers, MESSAGE]]
    for row in rows:
        values = [_cell(row.case.parameters[key]) for key in parameters]
        found = [row.numbers.get(name, "") for name in numbers]
        table.append([row.case.name, *values, row.status, *found, row.message])
    try:
        write_rows(path, table)
    except OSError as error:
        raise StudyError(f"{path}: cannot be written: {in_words(error)}") from error


def write_units(study: Study, rows: Sequence[Row]) -> None:
    """Write the units of the outputs beside the summary, where a case is done that tells them."""
    done = next((row.case for row in rows if row.status == "done"), None)
    if done is None or not study.outputs:
        return
    found = study.kind.units(done, study.outputs)
    try:
        write_rows(study.units, [UNIT_COLUMNS, *found.items()])
    except OSError as error:
        raise StudyError(f"{study.units}: cannot be written: {in_words(error)}") from error


def _read_units(path: Path) -> dict[str, str]:
    """The units of outputs; none where the file is not there, as of older studies."""
    if not path.is_file():
        return {}
    rows = list(csv.reader(io.StringIO(read_text(path), newline="")))
    if rows[:1] != [list(UNIT_COLUMNS)] or any(
        len(row) != len(UNIT_COLUMNS) for row in rows if row
    ):
        raise StudyError(f"{path}: no units of a study")
    return {row[0]: row[1] for row in rows[1:] if row}


def _cell(value: Any) -> Any:
    return json.dumps(value) if isinstance(value, list | dict | bool) else value


@dataclass(frozen=True, eq=False)
class Summary:
    """The cases of a summary that are done, in their order, and those that failed.

    See `sweep` for an example.

    Parameters
    ----------
    parameters : mapping of list
        By key, values as TOML has them.
    numbers : mapping of (n,)
        By name, the numbers of runs and the outputs.
    failed : mapping of list
        By key, values of the parameters of cases that failed.
    units : mapping of str
        By name, of outputs.
    """

    parameters: Mapping[str, list[Any]]
    numbers: Mapping[str, Array]
    failed: Mapping[str, list[Any]] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)


def read_summary(path: Path) -> Summary:
    """Read the summary of a study that `sweep` wrote.

    Parameters
    ----------
    path : Path

    Returns
    -------
    Summary

    Raises
    ------
    StudyError
        Names the file, which is no summary or cannot be read. See `sweep` for an example.
    """
    try:
        header, *rows = list(csv.reader(io.StringIO(read_text(path), newline=""))) or [[]]
        found = _summary(header, [row for row in rows if row])
        return replace(found, units=_read_units(units_beside(path)))
    except InputError as error:
        raise StudyError(str(error)) from error
    except (csv.Error, StudyError, ValueError) as error:
        raise StudyError(f"{path}: no summary of a study: {error}") from error


def _summary(header: Sequence[str], rows: Sequence[Sequence[str]]) -> Summary:
    if header[:1] != ["case"] or STATUS not in header or header[-1] != MESSAGE:
        raise StudyError(
            f"expected columns case, parameters, {STATUS}, numbers, {MESSAGE}, "
            f"found {quoted(list(header))}"
        )
    if any(len(row) != len(header) for row in rows):
        raise StudyError(f"expected {len(header)} cells in every row")
    status = header.index(STATUS)
    done = [row for row in rows if row[status] == "done"]
    if not done:
        raise StudyError(f"none of {len(rows)} cases is done")
    columns = list(zip(*done, strict=True))
    parameters = {header[i]: list(map(_value, columns[i])) for i in range(1, status)}
    numbers: dict[str, Array] = {
        header[i]: np.array([float(cell or "nan") for cell in columns[i]])
        for i in range(status + 1, len(header) - 1)
    }
    failed = [row for row in rows if row[status] == "failed"]
    lost = {header[i]: [_value(row[i]) for row in failed] for i in range(1, status)}
    return Summary(parameters, numbers, lost)


def _value(cell: str) -> Any:
    """The value of a cell: a number, an array, a table, true or false, or else text."""
    try:
        return json.loads(cell)
    except (ValueError, RecursionError):
        return cell
