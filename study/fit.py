"""Parameters of a model for which its runs are nearest to measured series.

    minimize  sum over series and samples of ((y(t - shift; p) - measured) / sigma)^2

within the bounds of the parameters. J, the derivatives of the residuals at the optimum, gives the
covariance (J^T J)^-1 of the parameters, times the mean square of the residuals where sigma is not
known. Standard deviations and correlations hold as far as the model does, and y is nearly linear
in the parameters within them.

Source: docs/theory.md, Fits.
"""

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import exp, log
from pathlib import Path

import numpy as np

from ..files import renamed_when_whole, require_no_input
from ..files.arrays import Array
from ..inputs import dotted, toml_of
from ..results import Results
from ..solver import simulate
from .errors import StudyError
from .measured_series import MeasuredSeries, read_series
from .one_model import StudyOfOneModel, StudyParameter, read_study_of_one_model
from .outputs import sampled_over
from .parametrized import Parametrized
from .runs import runs_at

JACOBIAN_STEP = 1e-4
"""of the scale of a parameter, for central differences: smooth runs are right to 1e-8 there"""
SHIFT_NAME = "shift"
"""the name of the parameter that moves a run over time"""
STRONG_CORRELATION = 0.95
LEAST_SINGULAR_VALUE = 1e-6
"""of the largest one of J, its columns scaled, of which differences have errors of 1e-8"""
TIME_ROUNDING = 1e-9
"""of times in files, relative to the end of a run"""
LEAST_SPARE_TIME = 1e-6
"""of a run, in which series may be shifted"""
MOST_SEARCH_STEPS = 50
"""of the search; slow ones go along a bound, or where the series tell nothing"""


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
    (n,), the run at their times; rms: of the residuals of each, in its unit; runs: how many were
    made; converged: whether the search ended by itself; warnings: limits of the method that the
    fitted run has passed.
    """

    parameters: tuple[FittedParameter, ...]
    correlation: Array
    rank: int
    series: tuple[MeasuredSeries, ...]
    fitted: tuple[Array, ...]
    rms: Array
    runs: int
    converged: bool
    warnings: tuple[str, ...]

    @property
    def notes(self) -> Iterator[str]:
        """Lines about what the data do not tell, and what else is to be known."""
        if not self.converged:
            yield f"the search has not ended after {MOST_SEARCH_STEPS} steps: begin nearer"
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
        for parameter in self.parameters:
            if parameter.at_bound:
                yield f"{parameter.name} is at a bound, {parameter.value:.6g}"


def fit(path: str | os.PathLike[str], output: str | os.PathLike[str] | None = None) -> ModelFit:
    """Fit the parameters of a study file to the measured series of its table [fit].

    Parameters
    ----------
    path : path
        A study file with `model`, `parameters` and [fit], as docs/studies.md describes it. A
        parameter begins at its number, the mean of its normal distribution, or the value of the
        model file; uniform and log_uniform ranges are bounds, the latter with steps in the
        logarithm.
    output : path, optional
        The model file with the fitted values, by default none.

    Returns
    -------
    ModelFit

    Raises
    ------
    StudyError
        Names the file and the key; also where the model does not run at the start.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from duhamel.solver import Model, RigidBody, Settings, write_model
    >>> ball = RigidBody(2.0, [0.1] * 3)
    >>> model = Model({"ball": ball}, gravity=(0, 0, -10), settings=Settings(t_end=1.0, step=0.1))
    >>> study = '''
    ... model = "ball.toml"
    ... parameters."simulation.gravity.2" = -10
    ... fit.series = [{quantity = "position:ball:z", file = "fall.csv"}]
    ... '''
    >>> with TemporaryDirectory() as name:
    ...     folder = Path(name)
    ...     write_model(model, folder / "ball.toml")
    ...     written = (folder / "gravity.toml").write_text(study)
    ...     rows = [f"{t / 10}, {-9.81 * t**2 / 200}" for t in range(11)]
    ...     written = (folder / "fall.csv").write_text("\\n".join(rows))
    ...     gravity = fit(folder / "gravity.toml").parameters[0]
    >>> round(gravity.value, 6)
    -9.81
    """
    study = read_study_of_one_model(path)
    try:
        return _fitted(study, None if output is None else Path(output).absolute())
    except StudyError as error:
        raise StudyError(f"{study.path}: {error}") from error


def _fitted(study: StudyOfOneModel, output: Path | None) -> ModelFit:
    # Import here: takes a second, and no other study needs it.
    from scipy.optimize import least_squares

    table = study.file.fit
    if table is None or not table.series:
        raise StudyError("expected the table [fit] with [[fit.series]], found none")
    series = [
        read_series(one, study.path.parent, f"fit.series.{n}") for n, one in enumerate(table.series)
    ]
    if output is not None:
        files = [study.path, study.base, *(study.path.parent / one.file for one in table.series)]
        require_no_input(output, files, "an input of the fit")
    if SHIFT_NAME in study.parameters:
        raise StudyError(f"parameters.{SHIFT_NAME}: is the time shift: expected another name")
    if len({one.sigma > 0.0 for one in series}) > 1:
        raise StudyError("fit.series: expected sigma of all series or of none")
    axes = [_Axis.of(name, parameter) for name, parameter in study.parameters.items()]
    problem = _Problem(study.parametrized, axes, series)
    problem.begin(table.shift)
    axes = problem.axes
    start = np.array([axis.inner(axis.start) for axis in axes])
    bounds = np.array([[axis.inner(end) for end in (axis.low, axis.high)] for axis in axes]).T
    found = least_squares(
        problem.residuals,
        start,
        problem.jacobian,
        bounds,
        x_scale="jac",
        max_nfev=MOST_SEARCH_STEPS,
    )
    # Written last: a fit that fails leaves no file.
    made = problem.fit(found.x, found.active_mask, found.status > 0)
    if output is not None:
        tables = study.plan.moved(output.parent).document_at(
            {one.name: one.value for one in made.parameters if one.is_key}
        )
        with renamed_when_whole(output, failure=StudyError) as temporary:
            temporary.write_text(toml_of(tables), encoding="utf-8")
    return made


@dataclass(frozen=True)
class _Axis:
    """A parameter: start, scale of its differences, bounds; by its logarithm within the search."""

    name: str
    start: float
    scale: float
    low: float
    high: float
    logarithmic: bool

    @classmethod
    def of(cls, name: str, parameter: StudyParameter) -> "_Axis":
        start, bounds = parameter.value, parameter.bounds
        low, high = bounds or (-np.inf, np.inf)
        if not low <= start <= high:
            raise StudyError(
                f"parameters.{dotted([name])}: expected a start between {low:.6g} and {high:.6g}, "
                f"found {start:.6g}"
            )
        scale = abs(start) or (high - low if bounds else 0.0)
        if not scale > 0.0:
            raise StudyError(
                f"parameters.{dotted([name])}: begins at 0: expected bounds, {{uniform = [..]}}"
            )
        # Strictly within the bounds, as the search wants its start.
        margin = 1e-9 * (high - low) if bounds else 0.0
        inside = min(max(start, low + margin), high - margin)
        return cls(name, inside, scale, low, high, parameter.logarithmic)

    def ends(self, value: float) -> tuple[float, float]:
        """Between which the difference about a value is taken."""
        step = JACOBIAN_STEP * (abs(value) if self.logarithmic else self.scale)
        # One-sided at a bound: beyond it the model may not exist.
        return min(value + step, self.high), max(value - step, self.low)

    def inner(self, value: float) -> float:
        return log(value) if self.logarithmic else value / self.scale

    def outer(self, inner: float) -> float:
        return exp(inner) if self.logarithmic else inner * self.scale

    def slope(self, value: float) -> float:
        """d value / d inner"""
        return value if self.logarithmic else self.scale


class _Problem:
    """Residuals and their derivatives, as the search asks for them."""

    def __init__(
        self, family: Parametrized, axes: list[_Axis], series: Sequence[MeasuredSeries]
    ) -> None:
        self._family, self.axes, self._series = family, axes, series
        # Without sigma each series by its own size: one in rad must not outweigh one in m.
        self._weights = [
            1.0 / (one.sigma or float(np.sqrt(np.mean(one.values**2))) or 1.0) for one in series
        ]
        self._n = sum(len(one.time) for one in series)
        self.runs, self._failure = 0, ""
        self.has_ended = False
        self._last: tuple[dict[str, float], Results | Exception] | None = None
        """values and outcome of the last run"""

    def begin(self, shift: bool) -> None:
        """Make the run at the start, within which all samples must lie, shifted or not.

        `StudyError` where there is no run at the start, or a series lies beyond it.
        """
        values = {axis.name: axis.start for axis in self.axes}
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
        if not shift:
            return
        # Beyond, samples would have nothing to be compared with.
        if not high - low > LEAST_SPARE_TIME * end:
            raise StudyError(
                f"fit.{SHIFT_NAME}: expected series that begin after the run, or end before it: "
                "leave out their first samples, or take a later t_end"
            )
        self.axes.append(_Axis.of(SHIFT_NAME, StudyParameter(0.0, bounds=(low, high))))

    def residuals(self, inner: Array) -> Array:
        return self._residuals_of(self._run(self._values(inner)), self._shift(inner))

    def jacobian(self, inner: Array) -> Array:
        values, columns = self._values(inner), []
        axes = [axis for axis in self.axes if axis.name != SHIFT_NAME]
        ends = [axis.ends(values[axis.name]) for axis in axes]
        points = [
            {**values, axis.name: end}
            for axis, both in zip(axes, ends, strict=True)
            for end in both
        ]
        parts = [self._residuals_of(run, self._shift(inner)) for run in self._runs(points)]
        for axis, (high, low), ahead, back in zip(axes, ends, parts[::2], parts[1::2], strict=True):
            columns.append((ahead - back) / (high - low) * axis.slope(values[axis.name]))
        run = self._run(values)
        if self.axes[-1].name == SHIFT_NAME and isinstance(run, Results):
            columns.append(self._by_shift(run, self._shift(inner)) * self.axes[-1].scale)
        found = np.array(columns).T
        if not np.isfinite(found).all():
            raise StudyError(f"the model does not run beside {values}: {self._failure}")
        return found

    def fit(self, inner: Array, active: Array, converged: bool) -> ModelFit:
        run = self._run(self._values(inner))
        residuals, J = self.residuals(inner), self.jacobian(inner)
        outer = [axis.outer(x) for axis, x in zip(self.axes, inner.tolist(), strict=True)]
        slopes = np.array([a.slope(x) for a, x in zip(self.axes, outer, strict=True)])
        # By the parameters themselves, not as the search scales them.
        correlation, deviations, rank = self._covariance(J / slopes, residuals)
        parameters = tuple(
            FittedParameter(axis.name, axis.start, value, deviation, bool(at_bound))
            for axis, value, deviation, at_bound in zip(
                self.axes, outer, deviations.tolist(), active.tolist(), strict=True
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
            correlation,
            rank,
            tuple(self._series),
            tuple(fitted),
            np.array(rms),
            self.runs,
            converged,
            tuple(run.validity.brief()) if isinstance(run, Results) else (),
        )

    def _covariance(self, J: Array, residuals: Array) -> tuple[Array, Array, int]:
        """Correlations (k, k), standard deviations (k,) and the rank of J."""
        k = J.shape[1]
        # With fewer samples than parameters the directions that none sees are among rows too.
        J = np.vstack([J, np.zeros((max(k - len(J), 0), k))])
        norms = np.linalg.norm(J, axis=0)
        norms[norms == 0.0] = 1.0
        _, sizes, rows = np.linalg.svd(J / norms, full_matrices=False)
        told = sizes > LEAST_SINGULAR_VALUE * sizes.max(initial=0.0)
        # The pseudo-inverse: directions that no sample sees would divide by rounding.
        scaled = rows[told].T / sizes[told]
        covariance = scaled @ scaled.T / np.outer(norms, norms)
        if not self._series[0].sigma:
            spare = len(residuals) - int(told.sum())
            covariance *= residuals @ residuals / spare if spare > 0 else np.inf
        deviations = np.sqrt(np.diag(covariance))
        with np.errstate(divide="ignore", invalid="ignore"):
            correlation = covariance / np.outer(deviations, deviations)
        # What a direction that no sample sees has a part in is not known at all.
        unseen = (np.abs(rows[~told]) > np.sqrt(LEAST_SINGULAR_VALUE)).any(axis=0)
        deviations[unseen] = np.inf
        return correlation, deviations, int(told.sum())

    def _values(self, inner: Array) -> dict[str, float]:
        pairs = zip(self.axes, inner.tolist(), strict=True)
        return {axis.name: axis.outer(x) for axis, x in pairs if axis.name != SHIFT_NAME}

    def _shift(self, inner: Array) -> float:
        return self.axes[-1].outer(float(inner[-1])) if self.axes[-1].name == SHIFT_NAME else 0.0

    def _residuals_of(self, run: Results | Exception, shift: float) -> Array:
        """(n,), infinite of a run that failed: the search then takes a shorter step."""
        if isinstance(run, Exception):
            self._failure = str(run)
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
