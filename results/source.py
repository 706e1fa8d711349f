"""Sources of the arrays of results: memory here, or a file (file.py)."""

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from ..files.arrays import Array
from .batches import Batch, EventRows
from .contents import Contents
from .quantity import Quantity
from .space import Space

Selection = tuple[Quantity, Any]
"""a quantity, and entries of its second dimension: a number, a slice, or None for all"""
ALL_ROWS = slice(None)


class Source(Protocol):
    """A source that `Results` reads."""

    @property
    def name(self) -> str:
        """The file, for messages."""

    def contents(self) -> Contents: ...

    def model(self) -> str:
        """The text of the model file."""

    def notes(self) -> dict[str, Any]:
        """Notes of the run: step size, seconds, ..."""

    def read(self, selections: Sequence[Selection], rows: slice = ALL_ROWS) -> list[Array]:
        """The rows (n, ...) that count, or some of them."""

    def events(self) -> EventRows:
        """The contacts that have ended, and at the end of the run those that have not."""

    def checks(self) -> Array:
        """The values of the checks of validity."""

    def space(self) -> Space | None:
        """Outlines and connections; None of files before version 7."""


class Writer(Protocol):
    """A destination of the results of a run."""

    @property
    def pause(self) -> float:
        """Time between writes [s]."""

    def append(self, batch: Batch) -> None:
        """Add the first rows of the output, those of the steps of the batch, and its events."""

    def check(self, values: Array) -> None:
        """Keep the values of the checks of validity in place of earlier ones."""

    def flush(self) -> None:
        """Wait until all rows are written."""

    def abandon(self) -> bool:
        """Leave earlier results at the same path as they are; False if there are none."""

    def note(self, **notes: Any) -> None:
        """Add notes of the run."""

    def where(self) -> str:
        """The place of the rows of a run that has not ended well, for the end of a message."""

    def finish(self) -> None:
        """End a run that has gone well: its results take their place."""

    def leave(self) -> None:
        """End a run as it is."""


class Memory:
    """Results in memory, written by a run and read afterwards."""

    name = "results in memory"
    pause = float("inf")

    def __init__(self, contents: Contents, notes: Mapping[str, Any], model: str) -> None:
        self._contents, self._notes, self._model = contents, dict(notes), model
        self._batches: list[dict[str, Array]] = []
        self._events: list[EventRows] = []
        self._checks = np.full(len(contents.checks), np.nan)

    def append(self, batch: Batch) -> None:
        axes = self._contents.axes
        taken = {
            quantity.name: quantity.take(batch, axes) for quantity in self._contents.quantities
        }
        # To copy the rows of a short run takes as long as a tenth of its steps.
        if not batch.is_last:
            taken = {name: np.array(values) for name, values in taken.items()}
        self._batches.append(taken)
        self._events.append(batch.events)

    def events(self) -> EventRows:
        return EventRows.joined(self._events)

    def check(self, values: Array) -> None:
        self._checks = values.copy()

    def checks(self) -> Array:
        return self._checks.copy()

    def space(self) -> Space | None:
        return self._contents.space

    def flush(self) -> None:
        pass

    def abandon(self) -> bool:
        return False

    def note(self, **notes: Any) -> None:
        self._notes |= notes

    def where(self) -> str:
        return ""

    def finish(self) -> None:
        pass

    def leave(self) -> None:
        pass

    def contents(self) -> Contents:
        return self._contents

    def model(self) -> str:
        return self._model

    def notes(self) -> dict[str, Any]:
        return dict(self._notes)

    def read(self, selections: Sequence[Selection], rows: slice = ALL_ROWS) -> list[Array]:
        if len(self._batches) > 1:
            self._batches = [
                {
                    name: np.concatenate([b[name] for b in self._batches])
                    for name in self._batches[0]
                }
            ]
        return [self._rows(quantity, entries, rows) for quantity, entries in selections]

    def _rows(self, quantity: Quantity, entries: Any, rows: slice) -> Array:
        (batch,) = self._batches
        if quantity.name not in batch:  # of no entries
            return np.zeros((len(batch["time"][rows]), 0))
        values = batch[quantity.name][rows]
        chosen: Array = values if entries is None else values[:, entries]
        return chosen.copy()
