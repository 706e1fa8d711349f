"""A model that was fitted: its parameters, and what the series tell of them."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..files.arrays import Array
from .measured_series import MeasuredSeries
from .search_axis import SHIFT_NAME

STRONG_CORRELATION = 0.95
LARGE_RESIDUALS = 2.0
"""over sigma, which noise alone does not reach"""


@dataclass(frozen=True, eq=False)
class FittedParameter:
    """A parameter of a fit, see `fit` for an example.

    start, value : float
    deviation : float
        The standard deviation, inf where the data do not tell it.
    at_bound : bool
    """

    name: str
    start: float
    value: float
    deviation: float
    at_bound: bool

    @property
    def is_key(self) -> bool:
        """Whether it is a parameter of the study, not the shift."""
        return self.name != SHIFT_NAME


@dataclass(frozen=True, eq=False)
class ModelFit:
    """A model that was fitted to measured series, see `fit` for an example.

    parameters: in their order, with the shift [s] last if it was fitted; correlation (k, k);
    rank: of k, how many combinations of parameters the data tell; series: measured, and fitted
    (n,), the run at their times, with units; rms: of the residuals of each; runs: how many were
    made; converged: whether the search ended by itself; warnings: limits of the method that the
    fitted run has passed.
    """

    parameters: tuple[FittedParameter, ...]
    correlation: Array
    rank: int
    series: tuple[MeasuredSeries, ...]
    fitted: tuple[Array, ...]
    units: tuple[str, ...]
    rms: Array
    runs: int
    converged: bool
    warnings: tuple[str, ...]

    @property
    def values(self) -> dict[str, float]:
        """The parameters of the model by name, without the shift."""
        return {one.name: one.value for one in self.parameters if one.is_key}

    @property
    def notes(self) -> Iterator[str]:
        """Lines about what the data do not tell, and what else is to be known."""
        if not self.converged:
            yield "the search has not ended: begin nearer, or fix parameters"
        yield from self.warnings
        names = [parameter.name for parameter in self.parameters]
        if self.rank < len(names):
            yield (
                f"the series tell {self.rank} of {len(names)} combinations of the parameters: fix "
                "some, or measure more"
            )
        for i, j in zip(*np.triu_indices(len(names), 1), strict=True):
            if abs(self.correlation[i, j]) > STRONG_CORRELATION:
                yield (
                    f"{names[i]} and {names[j]} have a correlation of {self.correlation[i, j]:.3f}:"
                    " the series hardly tell them apart"
                )
        for one, rms in zip(self.series, self.rms.tolist(), strict=True):
            if one.sigma and rms > LARGE_RESIDUALS * one.sigma:
                yield (
                    f"{one.quantity}: the residuals are {rms / one.sigma:.2g} times sigma: the "
                    "model does not move as the test did, and the deviations are too small"
                )
        for parameter in self.parameters:
            if parameter.at_bound:
                yield f"{parameter.name} is at a bound, {parameter.value:.6g}"
