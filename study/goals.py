"""What a search improves and what it must keep, as numbers of each run that move smoothly.

A goal is an output, or arithmetic of outputs, parameters and keys. The largest value of a motion
has a kink wherever another peak becomes the largest. A goal that must stay below a limit, or become
small, and grows with such a peak is therefore taken at each sample instead: each must stay below
the limit, and each moves smoothly. Of long runs it is taken once for each of many parts of the
time.

Source: docs/theory.md, Optimization.
"""

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple

import numpy as np
from pydantic import Field

from ..files.arrays import Array
from ..inputs import Table, quoted, rule
from ..results import Results
from .errors import StudyError
from .expressions import LookUp, arguments_of, evaluate, names_in
from .outputs import (
    PEAK_REDUCTIONS,
    is_series,
    is_stepwise,
    reduction_of,
    samples_of,
    units,
    values,
)

MOST_PARTS = 1000
"""of the time; more samples than that share a part with their neighbors"""
DEFAULT_RUNS = 1000


class ConstraintTable(Table):
    """A limit in a study file: what stays between min and max, or is both where they are equal."""

    output: str
    min: float | None = None
    max: float | None = None

    @rule
    def _has_a_limit(self) -> None:
        if self.min is None and self.max is None:
            raise ValueError("expected min, max or both, found none")
        if self.min is not None and self.max is not None and self.min > self.max:
            raise ValueError(f"expected min up to max, found {self.min:g} above {self.max:g}")


class OptimizeTable(Table):
    """What a search improves, within which limits, and how.

    minimize, maximize: the name of an output, an output, or arithmetic; method: "local" goes
    downhill from the start, "global" looks in all of the bounds first, with random numbers from
    `seed`; runs: how many it may make; derivatives: by two runs for each parameter, or by one run
    with dual numbers.
    """

    minimize: str | None = None
    maximize: str | None = None
    constraints: tuple[ConstraintTable, ...] = ()
    method: Literal["local", "global"] = "local"
    runs: int = Field(default=DEFAULT_RUNS, ge=1)
    seed: int = Field(default=0, ge=0)
    derivatives: Literal["differences", "dual"] = "differences"

    @rule
    def _has_one_goal(self) -> None:
        if len(found := self.given("minimize", "maximize")) != 1:
            raise ValueError(
                f"expected one of minimize and maximize, found {' and '.join(found) or 'none'}"
            )

    @property
    def objective(self) -> str:
        return self.minimize or self.maximize or ""

    @property
    def sign(self) -> float:
        """1 of what becomes small, -1 of what becomes large."""
        return 1.0 if self.maximize is None else -1.0


class Limit(NamedTuple):
    """sign goal <= sign value, or goal = value; of the constraint of a number."""

    constraint: int
    sign: float
    value: float
    is_equality: bool


@dataclass(frozen=True)
class Goal:
    """Arithmetic that is to become small, times a sign; peak: the output that is taken by parts."""

    key: str
    text: str
    sign: float
    peak: str = ""
    limit: Limit | None = None


class Goals:
    """The goals of a search as a vector of numbers: those of the objective, then limits.

    limits: those that the later ones are of, in their order.
    """

    def __init__(self, table: OptimizeTable, outputs: Mapping[str, str]) -> None:
        self.table = table
        self.outputs = dict(outputs)
        # The largest of several is taken as several too.
        largest = "max" if table.sign > 0.0 else "min"
        is_output = self._named(table.objective)
        terms = [table.objective] if is_output else arguments_of(table.objective, largest)
        key = "optimize.minimize" if table.sign > 0.0 else "optimize.maximize"
        self._goals = [Goal(key, text, table.sign) for text in terms]
        self._goals += [
            Goal(f"optimize.constraints.{n}.output", one.output, limit.sign, limit=limit)
            for n, one in enumerate(table.constraints)
            for limit in _limits(n, one)
        ]
        for goal in self._goals:
            self._named(goal.text)
            for name in self._outputs_of(goal):
                if is_stepwise(self.outputs[name]):
                    raise StudyError(
                        f"{goal.key}: {self.outputs[name]!r} moves by jumps, and a search goes by "
                        "slopes"
                    )

    def begin(self, results: Results, look_up: LookUp) -> None:
        """See by the first run which peaks are taken by parts."""
        known = values(results, self.outputs)
        for n, goal in enumerate(self._goals):
            number = _number(goal, known, look_up)
            if not np.isfinite(number):
                raise StudyError(f"{goal.key}: {goal.text!r} has no number at the start")
            peak = self._peak_of(goal)
            if not peak or (goal.limit and goal.limit.is_equality):
                continue
            # Arithmetic may have no number at samples that are no peaks.
            with suppress(StudyError):
                parts = goal.sign * self._parts(goal, peak, results, known, look_up)
                # Only what grows with its peak is largest where that is.
                if parts.max() <= goal.sign * number:
                    self._goals[n] = replace(goal, peak=peak)

    @property
    def limits(self) -> list[Limit]:
        return [goal.limit for goal in self._goals if goal.limit is not None]

    def numbers(self, results: Results, look_up: LookUp) -> list[Array]:
        """Those of each goal, times its sign; `StudyError` for what is no number."""
        known = values(results, self.outputs)
        return [
            goal.sign
            * (
                self._parts(goal, goal.peak, results, known, look_up)
                if goal.peak
                else np.array([_number(goal, known, look_up)])
            )
            for goal in self._goals
        ]

    def known(self, results: Results) -> dict[str, float]:
        """The outputs of a run by name."""
        return values(results, self.outputs)

    def objective(self, known: Mapping[str, float], look_up: LookUp) -> float:
        """The objective as it is asked for, by the outputs of a run."""
        return _number(Goal("optimize", self.table.objective, 1.0), known, look_up)

    def constraints(self, known: Mapping[str, float], look_up: LookUp) -> Array:
        """What has limits, by the outputs of a run (c,)."""
        return np.array(
            [
                _number(Goal(f"optimize.constraints.{n}.output", one.output, 1.0), known, look_up)
                for n, one in enumerate(self.table.constraints)
            ]
        )

    def units(self, results: Results) -> dict[str, str]:
        """Of outputs, and of goals that are outputs; "" of arithmetic."""
        return units(results, self.outputs)

    def _named(self, text: str) -> bool:
        """Whether a goal is an output; one in its own words is added to those by name."""
        if text not in self.outputs and not is_series(text):
            self.outputs[text] = text
        return text in self.outputs

    def _peak_of(self, goal: Goal) -> str:
        """The only output of a goal that is a peak over time, or ""."""
        peaks = {
            name
            for name in self._outputs_of(goal)
            if reduction_of(self.outputs[name]) in PEAK_REDUCTIONS
        }
        return peaks.pop() if len(peaks) == 1 else ""

    def _outputs_of(self, goal: Goal) -> list[str]:
        named = [goal.text] if goal.text in self.outputs else names_in(goal.text)
        return [name for name in named if name in self.outputs]

    def _parts(
        self,
        goal: Goal,
        peak: str,
        results: Results,
        known: Mapping[str, float],
        look_up: LookUp,
    ) -> Array:
        """A goal by the peak of each part of the time."""
        parts = peaks_by_parts(results, self.outputs[peak])
        if goal.text == peak:
            return parts
        return np.array([_number(goal, {**known, peak: one}, look_up) for one in parts.tolist()])


def peaks_by_parts(results: Results, output: str) -> Array:
    """The largest samples in parts of the time, or the least of `min` (k,)."""
    samples = samples_of(results, output)
    first = np.linspace(0, len(samples), min(len(samples), MOST_PARTS), endpoint=False).astype(int)
    extreme = np.minimum if reduction_of(output) == "min" else np.maximum
    found: Array = extreme.reduceat(samples, first)
    return found


def _number(goal: Goal, known: Mapping[str, float], look_up: LookUp) -> float:
    if goal.text in known:
        return known[goal.text]

    def found(name: str) -> Any:
        return known[name] if name in known else look_up(name)

    try:
        number = evaluate(goal.text, found)
    except StudyError as error:
        names = f"; outputs are: {', '.join(known)}" if known else ""
        raise StudyError(f"{goal.key}: {error}{names}") from error
    if isinstance(number, bool) or not isinstance(number, int | float):
        raise StudyError(f"{goal.key}: expected a number, found {quoted(number)}")
    return float(number)


def _limits(n: int, table: ConstraintTable) -> Iterator[Limit]:
    if table.min is not None and table.min == table.max:
        yield Limit(n, 1.0, table.min, True)
        return
    if table.max is not None:
        yield Limit(n, 1.0, table.max, False)
    if table.min is not None:
        yield Limit(n, -1.0, table.min, False)
