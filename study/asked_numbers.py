"""The numbers that are asked for of each of several runs, one after the other."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..files.arrays import Array
from ..results import Results
from .errors import StudyError
from .outputs import is_series, sampled_over, values


class AskedNumbers:
    """Outputs, then the samples of quantities over time.

    outputs: by name; series: the abscissas of quantities over time or frequency, by name, those of
    the first run.
    """

    def __init__(self, outputs: Mapping[str, str], series: Mapping[str, Array]) -> None:
        self.outputs = {name: text for name, text in outputs.items() if name not in series}
        self.series = series
        self._words = {name: outputs[name] for name in series}
        self._n = len(self.outputs) + sum(map(len, series.values()))
        self.failure = ""
        """of the last run that failed"""

    @classmethod
    def of(cls, results: Results, outputs: Mapping[str, str]) -> "AskedNumbers":
        if not outputs:
            raise StudyError("outputs: expected at least one, found none")
        series = {
            name: sampled_over(results, f"outputs.{name}", text)[0]
            for name, text in outputs.items()
            if is_series(text)
        }
        return cls(outputs, series)

    def numbers(self, results: Results) -> Array:
        """(m,) of a run; series at the times of the first run."""
        found = [np.array(list(values(results, self.outputs).values()), dtype=float)]
        for name, abscissa in self.series.items():
            own, column = sampled_over(results, f"outputs.{name}", self._words[name])
            same = np.array_equal(own, abscissa)
            found.append(column if same else np.interp(abscissa, own, column))
        return np.concatenate(found)

    def of_run(self, run: Results | Exception) -> Array:
        """The numbers of a run; none of one that failed."""
        if isinstance(run, Results):
            return self.numbers(run)
        self.failure = str(run)
        return np.full(self._n, np.nan)

    def split(self, numbers: NDArray[Any]) -> tuple[NDArray[Any], dict[str, NDArray[Any]]]:
        """Numbers (m, ...) as those of outputs, and of each quantity over time by name."""
        lengths = [len(self.outputs), *map(len, self.series.values())]
        first, *parts = np.split(numbers, np.cumsum(lengths)[:-1])
        return first, dict(zip(self.series, parts, strict=True))
