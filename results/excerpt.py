"""The first row of a run and some later ones, as results of their own."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..files.arrays import Array
from .batches import EventRows
from .contents import Contents
from .source import ALL_ROWS, Selection, Source
from .space import Space


class Excerpt:
    """A source with the first row of another one, and its rows from `first` to `last`.

    The first row stays because it tells where everything starts, as frames of the bare ground do.
    """

    def __init__(self, source: Source, first: int, last: int) -> None:
        self._source, self._rows = source, slice(max(first, 1), last)

    @property
    def name(self) -> str:
        return self._source.name

    def contents(self) -> Contents:
        return self._source.contents()

    def model(self) -> str:
        return self._source.model()

    def notes(self) -> dict[str, Any]:
        """Those of the run; fields that need all steps before theirs are refused by its start."""
        return {**self._source.notes(), "start": f"row {self._rows.start} of {self.name}"}

    def read(self, selections: Sequence[Selection], rows: slice = ALL_ROWS) -> list[Array]:
        opening = self._source.read(selections, slice(0, 1))
        later = self._source.read(selections, self._rows)
        return [np.concatenate(both)[rows] for both in zip(opening, later, strict=True)]

    def events(self) -> EventRows:
        return self._source.events()

    def checks(self) -> Array:
        return self._source.checks()

    def space(self) -> Space | None:
        return self._source.space()
