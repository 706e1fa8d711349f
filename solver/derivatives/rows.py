"""Results along a direction: what a run would record if it followed its derivatives straight.

    y(r) = y + r dy,      for all numbers of a run together

Whatever is made of results, as a spectrum or a largest value, has its derivative by the chain rule
from these: that of r at 0. No run is made for it.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...results.batches import STORED_ENERGIES, Batch, Energies, EventRows
from ...results.contents import Contents
from ...results.quantity import Quantity
from ...results.source import ALL_ROWS, Selection, Source
from ...results.space import Space
from ..arrays import Array, Index
from ..lower.allocation import make_output
from ..lower.lower import LoweredModel
from .run import DualRun


class NotedSource:
    """A source that notes the quantities that are read of it."""

    def __init__(self, source: Source) -> None:
        self._source = source
        self.quantities: dict[str, Quantity] = {}

    def __getattr__(self, name: str) -> Any:
        return getattr(self._source, name)

    def read(self, selections: Sequence[Selection], rows: slice = ALL_ROWS) -> list[Array]:
        recorded = {quantity.name for quantity in self._source.contents().quantities}
        asked = {quantity.name: quantity for quantity, _ in selections}
        # Those of which there are no entries are not recorded.
        self.quantities |= {name: one for name, one in asked.items() if name in recorded}
        return self._source.read(selections, rows)

    def arrays_of(self, lowered: LoweredModel) -> tuple[str, ...]:
        """The arrays of `Output` from which the quantities are taken that were read."""
        output = _NotedOutput(make_output(lowered, 1))
        batch = Batch(np.zeros(1, dtype=np.int64), lowered.h, output, Energies(0.0, 0.0))
        axes = self._source.contents().axes
        for quantity in self.quantities.values():
            quantity.take(batch, axes)
        return tuple(output.noted)


class _NotedOutput:
    def __init__(self, output: Any) -> None:
        self._output, self.noted = output, dict[str, None]()

    def __getattr__(self, name: str) -> Any:
        self.noted[name] = None
        return getattr(self._output, name)


class MovedSource:
    """The source of a run, with its rows and events moved along a derivative.

    number: of the derivative, from 0; -1: values alone; distance: r. All else is that of the
    source.
    """

    def __init__(self, source: Source, run: DualRun, number: int, distance: float) -> None:
        self._source, self._run = source, run
        self._number, self._distance = number, distance
        output = _MovedOutput(self)
        energies = [float(getattr(output, name)[0]) for name in STORED_ENERGIES]
        start = Energies(energies[0], sum(energies[1:], energies[0]))
        self._batch = Batch(run.steps, run.lowered.h, output, start)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._source, name)

    def moved(self, array: Array) -> Array:
        """Numbers (..., 1 + k) as values along the derivative."""
        values: Array = array[..., 0]
        if self._number < 0:
            return values
        return values + self._distance * array[..., 1 + self._number]

    def contents(self) -> Contents:
        return self._source.contents()

    def space(self) -> Space | None:
        return self._source.space()

    def read(self, selections: Sequence[Selection], rows: slice = ALL_ROWS) -> list[Array]:
        contents, found = self._source.contents(), []
        recorded = {quantity.name for quantity in contents.quantities}
        for quantity, entries in selections:
            if quantity.name not in recorded:  # of no entries
                found.append(np.zeros((len(self._run.steps[rows]), 0)))
                continue
            values = quantity.take(self._batch, contents.axes)[rows]
            found.append(np.array(values if entries is None else values[:, entries]))
        return found

    def events(self) -> EventRows:
        return EventRows(self._run.owners, self.moved(self._run.events))

    @property
    def arrays(self) -> Mapping[str, Array]:
        return self._run.arrays


class _MovedOutput:
    """The rows of a run, each array moved when it is asked for."""

    def __init__(self, source: MovedSource) -> None:
        self._source = source

    def __getattr__(self, name: str) -> Array | Index:
        found = self._source.arrays[name]
        return self._source.moved(found) if found.dtype == np.float64 else found
