"""The residuals of a fit and their derivatives, by runs of its model."""

from collections.abc import Mapping, Sequence

import numpy as np

from ..files.arrays import Array
from ..results import Results
from ..solver import simulate
from .central_differences import central_differences
from .covariance import covariance_of
from .dual_slopes import DIFFERENCES_INSTEAD, DUAL_NUMBERS, exact_slopes, runs_with_derivatives
from .errors import StudyError
from .measured_series import MeasuredSeries
from .model_fit import FittedParameter, ModelFit
from .one_model import StudyParameter
from .outputs import sampled_over, unit_of
from .parametrized import Parametrized
from .runs import runs_at
from .search_axis import JACOBIAN_STEP, SHIFT_NAME, SearchAxis

TIME_ROUNDING = 1e-9
"""of times in files, relative to the end of a run"""
LEAST_SPARE_TIME = 1e-6
"""of a run, in which series may be shifted"""


class FitProblem:
    """Residuals and their derivatives, as the search asks for them."""

    def __init__(
        self,
        family: Parametrized,
        axes: list[SearchAxis],
        series: Sequence[MeasuredSeries],
        derivatives: str,
    ) -> None:
        self._derivatives, self._notes = derivatives, dict[str, None]()
        self._family, self.axes, self._series = family, axes, series
        # Without sigma each series by its own size: one in rad must not outweigh one in m.
        self._weights = [
            1.0 / (one.sigma or float(np.sqrt(np.mean(one.values**2))) or 1.0) for one in series
        ]
        self._n = sum(len(one.time) for one in series)
        self.runs = 0
        self._last: tuple[dict[str, float], Results | Exception] | None = None
        """values and outcome of the last run"""

    def begin(self, shift: bool) -> None:
        """Make the run at the start, within which all samples must lie, shifted or not.

        `StudyError` where there is no run at the start, or a series lies beyond it.
        """
        values = {axis.name: axis.begin for axis in self.axes}
        results = simulate(self._family.make(values))
        self._last = values, results
        low, high = -np.inf, np.inf
        for one in self._series:
            time, _ = self._sampled(results, one)
            end = time[-1] * (1.0 + TIME_ROUNDING)
            if one.time[0] < time[0] or one.time[-1] > end:
                raise StudyError(
                    f"{one.name}: is measured from {one.time[0]:.6g} s to {one.time[-1]:.6g} s, "
                    f"and the run goes from {time[0]:.6g} s to {time[-1]:.6g} s"
                )
            low, high = max(low, one.time[-1] - end), min(high, one.time[0] - time[0])
        self._units = [unit_of(results, one.quantity) for one in self._series]
        if not shift:
            return
        # Beyond, samples would have nothing to be compared with.
        if not high - low > LEAST_SPARE_TIME * end:
            raise StudyError(
                f"fit.{SHIFT_NAME}: expected series that begin after the run, or end before it: "
                "leave out their first samples, or take a later t_end"
            )
        self.axes.append(SearchAxis.of(SHIFT_NAME, StudyParameter(0.0, bounds=(low, high))))

    def residuals(self, inner: Array) -> Array:
        return self._residuals_of(self._run(self._values(inner)), self._shift(inner))

    def jacobian(self, inner: Array) -> Array:
        values, shift = self._values(inner), self._shift(inner)
        run = self._run(values)
        if isinstance(run, Exception):
            raise StudyError(f"the model does not run at {values}: {run}")
        axes = [axis for axis in self.axes if axis.name != SHIFT_NAME]

        def residuals_at(points: Sequence[Mapping[str, float]]) -> list[Array | str]:
            runs = self._runs(points)
            parts = [self._residuals_of(run, shift) for run in runs]
            return [
                part if np.isfinite(part).all() else f"{run}"
                for part, run in zip(parts, runs, strict=True)
            ]

        base, steps = self._residuals_of(run, shift), [JACOBIAN_STEP] * len(axes)
        found = self._exact(run, values, shift) if self._derivatives == DUAL_NUMBERS else None
        if found is None:
            found, _ = central_differences(axes, values, base, residuals_at, steps)
        if len(axes) < len(self.axes):
            by_shift = self._by_shift(run, shift) * self.axes[-1].scale
            found = np.column_stack([found, by_shift])
        return found

    def _exact(self, run: Results, values: Mapping[str, float], shift: float) -> Array | None:
        axes = [axis for axis in self.axes if axis.name != SHIFT_NAME]
        self.runs += runs_with_derivatives(len(axes))
        found = exact_slopes(
            self._family,
            values,
            {axis.name: axis.scale for axis in axes},
            run,
            lambda one, _: self._residuals_of(one, shift),
            [len(one.time) for one in self._series],
        )
        if found is None:
            self._notes[DIFFERENCES_INSTEAD] = None
            return None
        return found * [axis.slope(values[axis.name]) for axis in axes]

    def fit(self, inner: Array, active: Array, converged: bool) -> ModelFit:
        run = self._run(self._values(inner))
        residuals, J = self.residuals(inner), self.jacobian(inner)
        outer = [
            axis.at_bound(side) if side else axis.outer(x)
            for axis, x, side in zip(self.axes, inner.tolist(), active.tolist(), strict=True)
        ]
        slopes = np.array([a.slope(x) for a, x in zip(self.axes, outer, strict=True)])
        # By the parameters themselves, not as the search scales them.
        found = covariance_of(J / slopes, residuals, noise_is_known=bool(self._series[0].sigma))
        parameters = tuple(
            FittedParameter(axis.name, axis.start, value, deviation, bool(at_bound))
            for axis, value, deviation, at_bound in zip(
                self.axes, outer, found.deviations.tolist(), active.tolist(), strict=True
            )
        )
        fitted, rms, first = [], [], 0
        for one, weight in zip(self._series, self._weights, strict=True):
            own = residuals[first : first + len(one.time)] / weight
            fitted.append(one.values + own)
            rms.append(float(np.sqrt(np.mean(own**2))))
            first += len(one.time)
        return ModelFit(
            parameters,
            found.correlation,
            found.rank,
            tuple(self._series),
            tuple(fitted),
            tuple(self._units),
            np.array(rms),
            self.runs,
            converged,
            (*(run.validity.brief() if isinstance(run, Results) else ()), *self._notes),
        )

    def _values(self, inner: Array) -> dict[str, float]:
        pairs = zip(self.axes, inner.tolist(), strict=True)
        return {axis.name: axis.outer(x) for axis, x in pairs if axis.name != SHIFT_NAME}

    def _shift(self, inner: Array) -> float:
        return self.axes[-1].outer(float(inner[-1])) if self.axes[-1].name == SHIFT_NAME else 0.0

    def _residuals_of(self, run: Results | Exception, shift: float) -> Array:
        """(n,), infinite of a run that failed: the search then takes a shorter step."""
        if isinstance(run, Exception):
            return np.full(self._n, np.inf)
        return np.concatenate(
            [
                weight * (np.interp(one.time - shift, *self._sampled(run, one)) - one.values)
                for one, weight in zip(self._series, self._weights, strict=True)
            ]
        )

    def _by_shift(self, run: Results, shift: float) -> Array:
        columns = []
        for one, weight in zip(self._series, self._weights, strict=True):
            time, values = self._sampled(run, one)
            columns.append(-weight * np.interp(one.time - shift, time, np.gradient(values, time)))
        return np.concatenate(columns)

    def _sampled(self, run: Results, one: MeasuredSeries) -> tuple[Array, Array]:
        return sampled_over(run, f"{one.name}.quantity", one.quantity, base="s")

    def _run(self, values: Mapping[str, float]) -> Results | Exception:
        # The search asks for the residuals, and then for the derivatives there.
        if self._last is None or self._last[0] != values:
            self._last = dict(values), self._runs([values])[0]
        return self._last[1]

    def _runs(self, points: Sequence[Mapping[str, float]]) -> list[Results | Exception]:
        self.runs += len(points)
        return runs_at(self._family, points)
