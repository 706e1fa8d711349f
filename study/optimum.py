"""What a search found, and what holds there."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from .optimize_problem import LARGEST_MISS, Trial

ACTIVE_MARGIN = 1e-3
"""of a limit, from which a constraint is as tight as it may be"""


@dataclass(frozen=True)
class OptimizedParameter:
    """A parameter of a search, see `optimize` for an example.

    start, value: of it; at_bound: whether its range keeps it there.
    """

    name: str
    start: float
    value: float
    at_bound: bool


@dataclass(frozen=True)
class OptimizedConstraint:
    """What a search kept within limits, see `optimize` for an example.

    output, unit: of it; low, high: its limits, infinite where there is none; start, value: of it;
    multiplier: by how much the objective gets better for each unit that the limit gives way, of an
    equality for each unit that it grows; scale_of_0: the size by which a limit of 0 is counted,
    how much the parameters change the output.
    """

    output: str
    unit: str
    low: float
    high: float
    start: float
    value: float
    multiplier: float
    scale_of_0: float

    @property
    def is_missed(self) -> bool:
        """Whether it is beyond a limit, by more than rounding."""
        over = max(self.value - self.high, self.low - self.value)
        return over > LARGEST_MISS * self._size(self.high if self.value > self.high else self.low)

    @property
    def is_active(self) -> bool:
        """Whether it is at a limit."""
        ends = [end for end in (self.low, self.high) if abs(end) < float("inf")]
        return any(abs(self.value - end) <= ACTIVE_MARGIN * self._size(end) for end in ends)

    def _size(self, limit: float) -> float:
        return abs(limit) or self.scale_of_0


@dataclass(frozen=True, eq=False)
class Optimum:
    """The best point that a search found, see `optimize` for an example.

    objective: as asked for; unit: of it; maximize; start, value: of the objective; parameters;
    constraints; outputs: by name, at the start and at the end, with units; converged: whether no
    step from here makes it better, as far as slopes tell; ended: why the search did; violation:
    the largest part of a limit by which one is missed, 0 if all are kept; runs, failed: how many
    were made, and gave nothing; failure: of the first of these; trials: the points in their order;
    remarks: what else is to be known; warnings: limits of the method that the last run has passed.
    """

    objective: str
    unit: str
    maximize: bool
    start: float
    value: float
    parameters: tuple[OptimizedParameter, ...]
    constraints: tuple[OptimizedConstraint, ...]
    outputs: Mapping[str, tuple[float, float]]
    units: Mapping[str, str]
    converged: bool
    ended: str
    violation: float
    runs: int
    failed: int
    failure: str
    trials: tuple[Trial, ...]
    remarks: tuple[str, ...]
    warnings: tuple[str, ...]

    @property
    def is_feasible(self) -> bool:
        """Whether all limits are kept."""
        return self.violation == 0.0

    @property
    def values(self) -> dict[str, float]:
        """The parameters by name."""
        return {one.name: one.value for one in self.parameters}

    @property
    def state(self) -> str:
        """In one line what was found, and why the search ended."""
        if not self.is_feasible:
            return (
                f"no point within all limits was found: the least miss is {self.violation:.3g} of "
                f"a limit ({self.ended})"
            )
        if self.converged:
            return f"optimum, of points nearby ({self.ended})"
        return f"not known to be an optimum: the search ended before ({self.ended})"

    @property
    def notes(self) -> Iterator[str]:
        """Lines about the end of the search, and what else is to be known."""
        yield self.state
        if self.failed:
            yield f"{self.failed} of {self.runs} runs failed, the first one: {self.failure}"
        for one in self.constraints:
            if one.is_missed:
                low, high = one.low, one.high
                limit = f"max = {high:.6g}" if one.value > high else f"min = {low:.6g}"
                yield f"{one.output} is {one.value:.6g}: {limit} is missed"
        yield from self.remarks
        for parameter in self.parameters:
            if parameter.at_bound:
                yield f"{parameter.name} is at a bound, {parameter.value:.6g}"
        yield from self.warnings
