"""The goals of a search and their derivatives, by runs of its model."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..files.arrays import Array
from ..results import Results, SeriesError
from ..solver import simulate
from .central_differences import central_differences
from .differences import DIFFERENCE_STEPS, slopes_of
from .dual_slopes import DIFFERENCES_INSTEAD, DUAL_NUMBERS, exact_slopes, runs_with_derivatives
from .errors import StudyError
from .goals import Goals
from .parametrized import Parametrized
from .runs import runs_at
from .search_axis import JACOBIAN_STEP, SearchAxis
from .simulation import Simulation

FIRST_STEP = 0.25
"""of the first step of a search, over the size of the parameters"""
STEP_ASYMMETRY = 1e-6
"""of a step, by which the other one about a point may differ"""
UNEVEN_SHARE = 1e-3
"""of the largest slope of a goal, from which scatter is more than rounding"""
LARGEST_MISS = 1e-6
"""of a limit, by which it may be missed"""


class SearchStoppedError(Exception):
    """A search cannot go on; the message says why."""


class Trial(NamedTuple):
    """A point of a search: parameters, the objective as asked for, constraints (c,), and the
    largest part of a limit by which one is missed; failure: why there is no run; outputs: by name;
    warnings: limits of the method that the run has passed.
    """

    values: Mapping[str, float]
    objective: float
    constraints: Array
    violation: float
    failure: str = ""
    outputs: Mapping[str, float] = MappingProxyType({})
    warnings: tuple[str, ...] = ()

    @property
    def is_feasible(self) -> bool:
        return self.violation <= LARGEST_MISS


class OptimizeProblem:
    """What a search minimizes: numbers of runs by parameters that are counted by their own size.

    numbers: the vector of goals at a point, divided by their scales: first those of the objective,
    of which the largest counts, then limits, which are kept where they are not above 0.
    """

    def __init__(
        self, family: Parametrized, axes: Sequence[SearchAxis], goals: Goals, most_runs: int
    ) -> None:
        self._family, self.axes, self.goals, self._most_runs = family, axes, goals, most_runs
        self.runs, self.failed = 0, 0
        self._share = ""
        self.has_ended = False
        """whether runs are made for the report alone, beyond those of the search"""
        self.switch_notes: list[str] = []
        self.failure = ""
        """of the first run that failed"""
        self.trials: list[Trial] = []
        self._points: list[Array] = []
        self._known: dict[bytes, Array | None] = {}
        self._slopes: dict[bytes, Array] = {}
        self._objective_scale = 1.0
        self._steps = np.full(len(axes), JACOBIAN_STEP)

    def begin(self) -> None:
        """Make the run at the start, and choose steps of differences; `StudyError` without it."""
        values = self.values(self.start)
        try:
            results = simulate(self._family.make(values))
        except Simulation().failures as error:
            raise StudyError(f"the model does not run at the start: {error}") from error
        self.runs += 1
        self.goals.begin(results, self._family.look_up(values))
        first = self._vector(values, results)
        if isinstance(first, str):
            raise StudyError(first)
        self._lengths = [len(part) for part in first]
        self._rows = np.repeat(np.arange(len(first)), self._lengths)
        self._n_terms = len(first) - len(self.goals.limits)
        raw = np.concatenate(first)
        self._known[self.start.tobytes()] = raw
        self._last: tuple[bytes, Results | Exception] = self.start.tobytes(), results
        self.moves = np.zeros((len(self.axes), len(self._rows)), dtype=bool)
        """whether a parameter has moved a number (n, m)"""
        # Derivatives without steps need none to be chosen.
        self._dual = self.goals.table.derivatives == DUAL_NUMBERS
        exact = self._exact(self.start) if self._dual else None
        self.uneven = list[str]()
        if exact is None:
            self._steps[:] = JACOBIAN_STEP
            self.uneven = self._choose_steps(raw)
        else:
            self._slopes[self.start.tobytes()] = exact
        sizes = np.abs(self._raw_slopes(self.start)).max(axis=1)
        size = float(sizes[self.is_objective].max())
        self._objective_scale = size / FIRST_STEP or float(np.abs(raw).max()) or 1.0
        # A limit of 0 says nothing of its size, and a start there nothing but its rounding.
        self.scales = [
            abs(limit.value)
            or float(sizes[(rows := self.limit_rows == n)].max())
            or float(np.abs(raw[rows]).max())
            or 1.0
            for n, limit in enumerate(self.goals.limits)
        ]
        self._keep(self.start, values, results, first)
        self.units = self.goals.units(results)

    @contextmanager
    def some_runs(self, share: float) -> Iterator[None]:
        """Let a search make a share of the runs alone."""
        most = self._most_runs
        self._most_runs, self._share = int(share * most), f", {100.0 * share:.0f} % of them here"
        try:
            yield
        finally:
            self._most_runs, self._share = most, ""

    def rescale(self, inner: Array) -> None:
        """Count the objective by its slope here."""
        size = float(np.abs(self._raw_slopes(inner)[self.is_objective]).max(initial=0.0))
        self._objective_scale = size / FIRST_STEP or self._objective_scale

    @property
    def start(self) -> Array:
        return np.array([axis.inner(axis.start) for axis in self.axes])

    @property
    def bounds(self) -> Array:
        """(2, n)"""
        return np.array(
            [
                [axis.inner(end) if np.isfinite(end) else end for end in (axis.low, axis.high)]
                for axis in self.axes
            ]
        ).T

    @property
    def is_objective(self) -> NDArray[np.bool_]:
        return self._rows < self._n_terms

    @property
    def is_equality(self) -> NDArray[np.bool_]:
        return self._of_limits([limit.is_equality for limit in self.goals.limits], False) > 0.0

    @property
    def limit_rows(self) -> NDArray[np.intp]:
        """The limit that each row of numbers is of, below 0 for the objective."""
        return self._rows - self._n_terms

    @property
    def objective_scale(self) -> float:
        return self._objective_scale

    def values(self, inner: Array) -> dict[str, float]:
        return {
            axis.name: axis.within(axis.outer(x))
            for axis, x in zip(self.axes, inner.tolist(), strict=True)
        }

    def numbers(self, inner: Array) -> Array | None:
        """(m,), or none where the run failed."""
        (found,) = self.many([inner])
        return found

    def many(self, points: Sequence[Array]) -> list[Array | None]:
        """The numbers at several points, whose runs are made at once."""
        new = {one.tobytes(): one for one in points if one.tobytes() not in self._known}
        values = [self.values(one) for one in new.values()]
        for inner, at, run in zip(new.values(), values, self._runs(values), strict=True):
            self._last = inner.tobytes(), run
            self._keep(inner, at, run, self._vector(at, run))
        return [
            None if (raw := self._known[p.tobytes()]) is None else self._scaled(raw) for p in points
        ]

    def slopes(self, inner: Array) -> Array:
        """The derivatives of the numbers (m, n)."""
        self.many([inner])
        return self._raw_slopes(inner) / self._scales[:, None]

    @property
    def best(self) -> Trial:
        """The best trial: within the limits, or else nearest to them."""
        return self.trials[self._best]

    @property
    def best_point(self) -> Array:
        """Where it was made, as searches count parameters."""
        return self._points[self._best]

    @property
    def _best(self) -> int:
        def rank(n: int) -> tuple[bool, float]:
            one, raw = self.trials[n], self._known[self._points[n].tobytes()]
            if raw is None or not one.is_feasible:
                return True, one.violation
            return False, float(raw[self.is_objective].max())

        return min(range(len(self.trials)), key=rank)

    @property
    def _scales(self) -> Array:
        return self._of_limits(self.scales, self._objective_scale)

    def _of_limits(self, values: Sequence[float], objective: float) -> Array:
        """A number of each limit, and one of the objective, for each row."""
        return np.repeat([*([objective] * self._n_terms), *values], self._lengths).astype(float)

    def _scaled(self, raw: Array) -> Array:
        limits = self._of_limits([limit.sign * limit.value for limit in self.goals.limits], 0.0)
        found: Array = (raw - limits) / self._scales
        return found

    def _keep(
        self,
        inner: Array,
        values: dict[str, float],
        run: Results | Exception,
        found: list[Array] | str,
    ) -> None:
        """Remember a point of the search, with what users know of it."""
        n = len(self.goals.table.constraints)
        self._points.append(inner.copy())
        if isinstance(found, str) or isinstance(run, Exception):
            self._known[inner.tobytes()] = None
            self.trials.append(Trial(values, np.nan, np.full(n, np.nan), np.inf, str(found)))
            return
        raw = np.concatenate(found)
        self._known[inner.tobytes()] = raw
        known, look_up = self.goals.known(run), self._family.look_up(values)
        missed = np.where(self.is_equality, np.abs(scaled := self._scaled(raw)), scaled)
        self.trials.append(
            Trial(
                values,
                self.goals.objective(known, look_up),
                self.goals.constraints(known, look_up),
                float(missed[~self.is_objective].max(initial=0.0)),
                outputs=known,
                warnings=tuple(run.validity.brief()),
            )
        )

    def _vector(self, values: Mapping[str, float], run: Results | Exception) -> list[Array] | str:
        """The numbers of each goal, or why there are none."""
        if isinstance(run, Exception):
            return str(run) or type(run).__name__
        try:
            found = self.goals.numbers(run, self._family.look_up(values))
        except (SeriesError, StudyError) as error:  # as a division by 0 that the start had not
            return str(error)
        if not all(np.isfinite(part).all() for part in found):
            return "an output has no number"
        return found

    def _raw_slopes(self, inner: Array) -> Array:
        key = inner.tobytes()
        if key not in self._slopes:
            exact = self._exact(inner) if self._dual else None
            self._slopes[key] = self._differences(inner) if exact is None else exact
        return self._slopes[key]

    def _exact(self, inner: Array) -> Array | None:
        """By dual numbers; none where something switches, from where on differences are taken."""
        key, values = inner.tobytes(), self.values(inner)
        if self._known[key] is None:
            return None
        run = self._last[1] if self._last[0] == key else self._runs([values])[0]
        if isinstance(run, Exception):
            return None
        self._count(runs_with_derivatives(len(self.axes)))

        def numbers(one: Results, at: Mapping[str, float]) -> Array:
            found = self._vector(at, one)
            if isinstance(found, str):
                raise SearchStoppedError(found)
            return np.concatenate(found)

        scales = {axis.name: axis.scale for axis in self.axes}
        try:
            found = exact_slopes(self._family, values, scales, run, numbers, self._lengths)
        except StudyError as error:
            raise SearchStoppedError(str(error)) from error
        if found is None:
            self._dual, self.switch_notes = False, [DIFFERENCES_INSTEAD]
            # What switches is uneven, as differences at the start would have told.
            self._steps[:] = DIFFERENCE_STEPS[0]
            return None
        self.moves |= found.T != 0.0
        slopes: Array = found * [axis.slope(values[axis.name]) for axis in self.axes]
        return slopes

    def _differences(self, inner: Array) -> Array:
        """Central differences; one-sided where a run on one side fails, or a bound is near."""
        values, base = self.values(inner), self._known[inner.tobytes()]
        if base is None:
            raise SearchStoppedError(f"a run failed: {self.failure}")
        try:
            slopes, changes = central_differences(
                self.axes, values, base, self._numbers_of_runs, self._steps.tolist()
            )
        except StudyError as error:
            raise SearchStoppedError(str(error)) from error
        self.moves |= changes.T > 0.0
        return slopes

    def _numbers_of_runs(self, points: Sequence[Mapping[str, float]]) -> list[Array | str]:
        found = [self._vector(at, run) for at, run in zip(points, self._runs(points), strict=True)]
        return [part if isinstance(part, str) else np.concatenate(part) for part in found]

    def _choose_steps(self, base: Array) -> list[str]:
        """Wide steps of the parameters by which goals switch; their names.

        base: the numbers at the start. Of each goal the one that is largest there is looked at.
        """
        ends_of_goals = np.cumsum(self._lengths)
        tops = np.array(
            [
                end - length + int(np.argmax(base[end - length : end]))
                for end, length in zip(ends_of_goals.tolist(), self._lengths, strict=True)
            ]
        )
        widths = DIFFERENCE_STEPS
        uneven = []
        points, places = [], []
        start = {axis.name: axis.start for axis in self.axes}
        for i, axis in enumerate(self.axes):
            for j, width in enumerate(widths.tolist()):
                high, low = axis.ends(axis.start, width)
                above, below = high - axis.start, low - axis.start
                if np.isclose(above, -below, rtol=STEP_ASYMMETRY):
                    points += [start | {axis.name: high}, start | {axis.name: low}]
                    places.append((i, j, (1.0, -1.0, 0.0), high - low))
                # Otherwise cut off at a bound. At it, one side is as good to second order.
                elif (not below and high < axis.high) or (not above and low > axis.low):
                    step = above or below
                    points += [start | {axis.name: axis.start + part * step} for part in (0.5, 1.0)]
                    places.append((i, j, (4.0, -1.0, -3.0), step))
        ends = [
            np.full(len(tops), np.nan) if isinstance(one, str) else one[tops]
            for one in self._numbers_of_runs(points)
        ]
        differences = np.full((len(self.axes), len(widths), len(self._lengths)), np.nan)
        for (i, j, weights, width), first, last in zip(places, ends[::2], ends[1::2], strict=True):
            slope = self.axes[i].slope(start[self.axes[i].name]) / width
            differences[i, j] = slope * (np.array(weights) @ [first, last, base[tops]])
        slopes = [slopes_of(one) for one in differences]
        # Rounding scatters too, of what hardly moves.
        sizes = np.max([np.nan_to_num(np.abs(one.value)) for one in slopes], axis=0)
        for i, (axis, one) in enumerate(zip(self.axes, slopes, strict=True)):
            if (one.switches & (one.error > UNEVEN_SHARE * sizes)).any():
                self._steps[i] = widths[0]
                uneven.append(axis.name)
        return uneven

    def _runs(self, points: Sequence[Mapping[str, float]]) -> list[Results | Exception]:
        self._count(len(points))
        found = runs_at(self._family, points)
        for one in found:
            if isinstance(one, Exception):
                self.failed += 1
                self.failure = self.failure or str(one)
        return found

    def _count(self, runs: int) -> None:
        if self.runs + runs > self._most_runs and not self.has_ended:
            raise SearchStoppedError(f"the limit of {self.goals.table.runs} runs{self._share}")
        self.runs += runs
