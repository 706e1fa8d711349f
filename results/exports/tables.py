"""Results as tables of comma-separated values: a row for each step, a column for each number."""

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from ...files import write_rows
from ..dimensions import Axes
from ..motion import EVENT_QUANTITIES
from ..quantity import Quantity
from ..results import Results
from ..transforms import Series, parse, series
from ..wildcards import named, of_all
from .folder import distinct, exported

Rows = Iterable[Sequence[Any]]

# About 8 MiB, so that memory does not grow with the length of a run.
BATCH_NUMBERS = 1 << 20
TIME_HEADING = "time [s]"
# Replaced by `_` in names of files.
UNSAFE_IN_FILE_NAME = re.compile(r"[^\w.,()=+-]+")


def write_csv(
    results: Results,
    folder: str | os.PathLike[str],
    quantities: Iterable[str] = (),
    rows: slice = slice(None),
) -> tuple[Path, ...]:
    """Write tables of results into a folder.

    Without quantities there is a table for each group, bodies.csv, frames.csv, ..., of variables
    by their names in the results file, as "body_velocity:hub:x [m s-1]", and events.csv. With
    quantities there is quantities.csv; those over other times or frequencies, as spectra, have
    tables of their own.

    Parameters
    ----------
    results : Results
    folder : path
    quantities : iterable of str
        As `duhamel plot` names them; `*` in a name stands for anything.
    rows : slice
        Of the recorded steps; spectra are always those of all.

    Returns
    -------
    tuple of Path

    Raises
    ------
    ExportError
        Where a file cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> import duhamel as du
    >>> m = du.Mechanism()
    >>> ball = m.add(du.RigidBody(1.0, [0.1, 0.1, 0.1]), name="ball")
    >>> results = m.simulate(1.0, step=0.5).results
    >>> with TemporaryDirectory() as folder:
    ...     (path,) = write_csv(results, folder, ["position:ball:x"])
    ...     print(path.name, path.read_text(), sep="\\n")
    quantities.csv
    time [s],position:ball:x [m]
    0.0,0.0
    0.5,0.0
    1.0,0.0
    <BLANKLINE>
    """
    wanted = tuple(quantities)
    with exported(folder) as export:
        for name, table in _named(results, wanted, rows) if wanted else _groups(results, rows):
            with export.file(f"{name}.csv") as path:
                write_rows(path, table)
    return export.paths


def _groups(results: Results, rows: slice) -> Iterator[tuple[str, Rows]]:
    """A table for each group that was recorded, and that of events."""
    contents = results.contents
    for group in dict.fromkeys(quantity.group for quantity in contents.quantities):
        quantities = [quantity for quantity in contents.quantities if quantity.group == group]
        if group:
            yield group, _recorded(results, quantities, rows)
    if events := results.events:
        yield "events", _events(results, list(events))


def _recorded(results: Results, quantities: Sequence[Quantity], rows: slice) -> Rows:
    """A header, and the time and all numbers of some variables at each step."""
    axes, time = results.contents.axes, results.time
    header = [TIME_HEADING, *(name for quantity in quantities for name in _columns(quantity, axes))]
    yield header
    first, last, _ = rows.indices(len(time))
    step = max(1, BATCH_NUMBERS // len(header))
    for start in range(first, last, step):
        some = slice(start, min(start + step, last))
        columns = [time[some].tolist()]
        for quantity in quantities:
            values = results.variable(quantity.name, some)
            columns += values.reshape(len(values), -1).T.tolist()
        yield from zip(*columns, strict=True)


def _columns(quantity: Quantity, axes: Axes) -> list[str]:
    """Headers as "joint_position:hinge.angle [rad]", in the order of the numbers of a row."""
    entries = [axes[name].names for name in quantity.dimensions[1:]]
    names = [":".join([quantity.name, *chosen]) for chosen in product(*entries)]
    units = quantity.units(axes) or (", ".join(quantity.unit),)
    for_each = len(names) // len(units)
    return [f"{name} [{units[i // for_each]}]" for i, name in enumerate(names)]


def _events(results: Results, owners: Sequence[str]) -> Rows:
    """A header, and the numbers of each time that a contact was closed."""
    names = [quantity.attribute for quantity in EVENT_QUANTITIES]
    units = [
        ", ".join(dict.fromkeys(results.unit("events", owner, name) for owner in owners))
        for name in names
    ]
    yield ["of", *(f"{name} [{unit}]" for name, unit in zip(names, units, strict=True))]
    for owner, events in results.events.items():
        for numbers in zip(*(getattr(events, name).tolist() for name in names), strict=True):
            yield [owner, *numbers]


def _named(results: Results, quantities: Iterable[str], rows: slice) -> Iterator[tuple[str, Rows]]:
    """The table of the quantities over the times of the run, and those of all others."""
    found = [pair for quantity in quantities for pair in named_series(results, quantity)]
    time = results.time
    over_time = [pair for pair in found if np.array_equal(pair[1].abscissa, time)]
    if over_time:
        yield "quantities", _joined(over_time, rows)
    others = [pair for pair in found if not np.array_equal(pair[1].abscissa, time)]
    files = distinct([UNSAFE_IN_FILE_NAME.sub("_", text) for text, _ in others])
    for file, pair in zip(files, others, strict=True):
        yield file, _joined([pair], slice(None))


def named_series(results: Results, quantity: str) -> list[tuple[str, Series]]:
    """A quantity, or all that it stands for that have it, as sensors of a kind."""
    return of_all(named(results, quantity), lambda name: [(name, series(results, name))])


def _joined(found: Sequence[tuple[str, Series]], rows: slice) -> Rows:
    """A header, and series over the same times or frequencies."""
    _, first = found[0]
    base = TIME_HEADING if first.base == "s" else "frequency [Hz]"
    header, columns = [base], [first.abscissa[rows]]
    for text, of_it in found:
        header += [f"{name} [{of_it.unit}]" for name in of_axes(text, of_it)]
        values = of_it.values[rows]
        columns += list(values.reshape(len(values), -1).T)
    yield header
    yield from zip(*(column.tolist() for column in columns), strict=True)


def of_axes(text: str, found: Series) -> list[str]:
    """The quantity for each column, as "srs(acceleration:hub:x)"."""
    if not found.axes:
        return [text]
    within, _ = parse(text)
    return [text.replace(within, f"{within}:{axis}") for axis in found.axes]
