"""Signals that were recorded: columns of text files, as of CSV."""

from collections.abc import Iterator, Mapping
from dataclasses import field
from functools import cached_property
from typing import Annotated, Any

import numpy as np

from ...inputs import Shown
from ...superelement import sha256
from ..arrays import Array
from ..errors import ModelError
from ..schema.entry import Entry, FieldSpec, entry
from ..schema.paths import FilePath
from ..schema.tables import declared
from ..schema.values import Positive
from .columns import column_of, number_of_column
from .curves import Piecewise, Spline, Table
from .pieces import Pieces
from .signal import SIGNAL_FORMS, Smooth


def _column(value: Any) -> str | int:
    if isinstance(value, bool) or not isinstance(value, str | int):
        raise TypeError
    if value == "" or (isinstance(value, str) and not value.isprintable()):
        raise ValueError
    return value


_COLUMN = Annotated[Any, Shown(lambda: {"type": ["string", "integer"]})]
Column = Annotated[
    str | int, FieldSpec("the name of a column, or its number, from 1 on", _column, _COLUMN)
]


@entry(eq=True)
class _Recorded(Piecewise, Entry):
    """A column over another: scale x column at the times time_scale x time + shift."""

    file: FilePath
    column: Column
    scale: float = 1.0
    time: Column = 1
    time_scale: Positive = 1.0
    shift: float = 0.0
    points: tuple[Array, Array] = field(init=False, repr=False, compare=False)
    """times [s] and values (n,)"""
    digest: str = field(init=False, repr=False, compare=False)
    """the SHA-256 of the file"""

    def validate(self) -> None:
        if number_of_column(self.file, self.time) == number_of_column(self.file, self.column):
            raise ModelError(f"file: {self.file}: time and column are both {self.column!r}")
        # Read when the entry is made: errors of the file come before a run, with their line.
        times = column_of(self.file, self.time, increasing=True)
        if len(times) < 2:
            raise ModelError(f"file: {self.file}: expected two or more rows, found {len(times)}")
        values = column_of(self.file, self.column)
        at, scaled = self.time_scale * times + self.shift, self.scale * values
        if not (np.diff(at) > 0.0).all() or not np.isfinite(scaled).all():
            raise ModelError(f"file: {self.file}: scale, time_scale or shift are too large")
        # kept, so that the signal stays as it was read
        object.__setattr__(self, "points", (at, scaled))
        object.__setattr__(self, "digest", sha256(self.file))

    @cached_property
    def curve(self) -> Table | Spline:
        raise NotImplementedError

    @property
    def end(self) -> float:
        """The time of the last row."""
        return float(self.points[0][-1])

    @property
    def breaks(self) -> tuple[float, ...]:
        return self.curve.breaks

    @property
    def pieces(self) -> Pieces:
        return self.curve.pieces

    def values_at(self, t: Array) -> Array:
        return self.curve.values_at(t)


@SIGNAL_FORMS.in_files("file")
@entry(eq=True)
class Recorded(_Recorded):
    r"""A column of a text file over its time, linear between the rows, constant outside.

        f = scale x column    at    time_scale x time + shift

    Parameters
    ----------
    file : path
        Its columns are separated by commas, semicolons, tabs or blanks. The first line may name
        them; # begins a comment.
    column : str or int
        A name, or a number from 1 on.
    scale : float
    time : str or int
        The column of the time.
    time_scale : float
    shift : float [s]

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder) / "shaker.csv"
    ...     written = path.write_text("t, a\n0, 0\n1, 4\n")
    ...     Recorded(path, "a", scale=9.81)(0.5)
    19.62
    """

    @cached_property
    def curve(self) -> Table:
        times, values = self.points
        return Table(times, values)

    def slope(self, t: float) -> float:
        """The derivative, at a point that after it."""
        return self.curve.slope(t)


@SIGNAL_FORMS.in_files("file", flag="spline")
@entry(eq=True)
class RecordedSpline(Smooth, _Recorded):
    r"""The natural cubic spline through a column of a text file; it can drive joints.

    The parameters are those of `Recorded`, the curve is that of `Spline`.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder) / "shaker.csv"
    ...     written = path.write_text("t, a\n0, 0\n1, 4\n2, 0\n")
    ...     RecordedSpline(path, "a")(1.0)
    4.0
    """

    @cached_property
    def curve(self) -> Spline:
        times, values = self.points
        return Spline(times, values)

    def derivatives_at(self, t: Array) -> tuple[Array, Array]:
        return self.curve.derivatives_at(t)


def records_of(part: Any) -> Iterator[Recorded | RecordedSpline]:
    """The recorded signals in a model, or in a part of one."""
    if isinstance(part, Recorded | RecordedSpline):
        yield part
    elif isinstance(part, Entry):
        for key, _ in declared(type(part)):
            yield from records_of(getattr(part, key.name))
    elif isinstance(part, Mapping):
        yield from records_of(tuple(part.values()))
    elif isinstance(part, tuple):
        for item in part:
            yield from records_of(item)
