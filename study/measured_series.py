"""Measured series that fits compare runs with: columns of text files, UFF 58 records, results."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from ..files.arrays import Array
from ..inputs import Table
from ..results import QuantityError, Results, ResultsError, SeriesError, transforms
from ..solver import ModelError
from ..solver.signals.columns import column_of
from .errors import StudyError

FUNCTION_SETS = 58
"""type of the sets of UFF that hold functions"""
TIME_AXIS_TYPE = 17
"""of UFF: an abscissa of time"""


class SeriesTable(Table):
    """A measured series in a study file.

    quantity: of the run that it is compared with; file: a text file with columns (.csv, .txt), UFF
    58 (.unv, .uff, .ufb) or results (.h5); column: a name or a number from 1 on, of UFF the number
    of the set; of results a quantity, by default the same; time: the column of the time [s];
    sigma: the standard deviation of its noise, of all or none of the series.
    """

    quantity: str
    file: Annotated[Path, Field(strict=False)]
    column: str | int = 2
    time: str | int = 1
    scale: float = 1.0
    sigma: float | None = Field(default=None, gt=0.0)


@dataclass(frozen=True, eq=False)
class MeasuredSeries:
    """time, values (n,); sigma: the standard deviation of its noise, 0 if it is not known."""

    name: str
    quantity: str
    time: Array
    values: Array
    sigma: float


def read_series(table: SeriesTable, folder: Path, name: str) -> MeasuredSeries:
    """Read a series; `StudyError` names the file, the column, and what was found there."""
    # Relative to the study file, wherever the program was started.
    path = folder / table.file
    reader = SERIES_READERS.get(path.suffix.lower(), _of_text)
    try:
        time, values = reader(path, table)
    except (ModelError, ResultsError, QuantityError, SeriesError) as error:
        raise StudyError(f"{name}: {error}") from error
    check_times(time, f"{name}: {path}")
    return MeasuredSeries(name, table.quantity, time, table.scale * values, table.sigma or 0.0)


def check_times(time: Array, place: str) -> None:
    if len(time) < 2 or not (np.diff(time) > 0.0).all():
        raise StudyError(f"{place}: expected two or more times that increase")


def _of_text(path: Path, table: SeriesTable) -> tuple[Array, Array]:
    return column_of(str(path), table.time, increasing=True), column_of(str(path), table.column)


def _of_results(path: Path, table: SeriesTable) -> tuple[Array, Array]:
    quantity = table.column if isinstance(table.column, str) else table.quantity
    found = transforms.series(Results.read(path), quantity)
    if found.axes:
        raise StudyError(f"{path}: {quantity} is of a vector: expected {quantity}:{found.axes[0]}")
    return found.abscissa, found.values


def _of_uff(path: Path, table: SeriesTable) -> tuple[Array, Array]:
    # Import here: an extra.
    try:
        import pyuff
    except ImportError as error:
        raise StudyError(f"{path}: UFF takes pyuff: pip install 'duhamel[measured]'") from error
    number = table.column
    try:
        file = pyuff.UFF(str(path))
        kinds = [int(kind) for kind in file.get_set_types()]
        if not isinstance(number, int) or not 1 <= number <= len(kinds):
            raise StudyError(
                f"{path}: column: expected the number of a set, 1 to {len(kinds)}, found {number!r}"
            )
        is_function = kinds[number - 1] == FUNCTION_SETS
        record: dict[str, Any] = file.read_sets(number - 1) if is_function else {}
    except StudyError:
        raise
    except Exception as error:  # pyuff raises plain ones
        raise StudyError(f"{path}: not a readable UFF file: {error}") from error
    if int(record.get("abscissa_spec_data_type", 0)) != TIME_AXIS_TYPE:
        raise StudyError(f"{path}: set {number}: expected a record over time of set type 58")
    return np.asarray(record["x"], dtype=float), np.asarray(record["data"], dtype=float)


SERIES_READERS: dict[str, Callable[[Path, SeriesTable], tuple[Array, Array]]] = {
    **dict.fromkeys((".h5", ".hdf5"), _of_results),
    **dict.fromkeys((".unv", ".uff", ".ufb"), _of_uff),
}
"""by the suffix of the file; all others are text"""
