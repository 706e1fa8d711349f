"""Parameters of a model for which its runs are nearest to measured series.

    minimize  sum over series and samples of ((y(t - shift; p) - measured) / sigma)^2

within the bounds of the parameters. J, the derivatives of the residuals at the optimum, gives the
covariance (J^T J)^-1 of the parameters, times the mean square of the residuals where sigma is not
known. Standard deviations and correlations hold as far as the model does, and y is nearly linear
in the parameters within them.

Source: docs/theory.md, Fits.
"""

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from ..files import require_no_input
from ..solver import Model
from .dual_slopes import check_method
from .errors import StudyError
from .fit_problem import FitProblem
from .measured_series import MeasuredSeries, check_times, read_series
from .model_fit import ModelFit
from .one_model import StudyOfOneModel, StudyParameter, read_study_of_one_model
from .parameter import Parameter, family_of
from .parametrized import Parametrized
from .search_axis import SHIFT_NAME, SearchAxis

MOST_SEARCH_STEPS = 50
"""slow searches go along a bound, or where the series tell nothing"""


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
        return _of_study(study, None if output is None else Path(output).absolute())
    except StudyError as error:
        raise StudyError(f"{study.path}: {error}") from error


def fit_model(
    model: Model | Callable[..., Model],
    parameters: Mapping[str, str | Parameter],
    series: Mapping[str, tuple[ArrayLike, ArrayLike]],
    *,
    sigma: float | Mapping[str, float] | None = None,
    shift: bool = False,
    derivatives: str = "differences",
) -> ModelFit:
    """Fit parameters of a model in memory, or of a function that makes one, to measured series.

    Parameters
    ----------
    model : Model or callable
        Or a function that makes it, with the parameters as keywords.
    parameters : mapping of Parameter
        By names of your own; a text is the key of a parameter without bounds.
    series : mapping of (time, values)
        By the quantity of the run that each is compared with: times [s] and values (n,).
    sigma : float or mapping of float, optional
        The standard deviation of the noise, of all series or by quantity.
    shift : bool
        Whether the time of all series may be shifted.
    derivatives : {"differences", "dual"}
        By two runs for each parameter, or by one run with dual numbers.

    Returns
    -------
    ModelFit

    Raises
    ------
    StudyError
        Names the argument; also where the model does not run at the start.

    Examples
    --------
    >>> import numpy as np
    >>> from duhamel.solver import Model, RigidBody, Settings
    >>> from duhamel.study import fit_model
    >>> ball = RigidBody(2.0, [0.1] * 3)
    >>> model = Model({"ball": ball}, gravity=(0, 0, -10), settings=Settings(t_end=1.0, step=0.1))
    >>> t = np.linspace(0.0, 1.0, 11)
    >>> fall = {"position:ball:z": (t, -9.81 * t**2 / 2)}
    >>> found = fit_model(model, {"g": "simulation.gravity.2"}, fall)
    >>> round(found.parameters[0].value, 6)
    -9.81
    """
    family, starts = family_of(model, parameters)
    if not series:
        raise StudyError("series: expected times and values by quantity, found none")
    if isinstance(sigma, Mapping) and sigma.keys() != series.keys():
        raise StudyError(f"sigma: expected one for each of {', '.join(series)}, or one number")
    deviations = sigma if isinstance(sigma, Mapping) else dict.fromkeys(series, sigma)
    measured = [
        _series(quantity, time, values, deviations[quantity])
        for quantity, (time, values) in series.items()
    ]
    check_method(derivatives)
    return _fitted(family, starts, measured, shift, derivatives)


def _series(
    quantity: str, time: ArrayLike, values: ArrayLike, sigma: float | None
) -> MeasuredSeries:
    t, y = np.asarray(time, dtype=float), np.asarray(values, dtype=float)
    if t.ndim != 1 or t.shape != y.shape or not np.isfinite([t, y]).all():
        raise StudyError(
            f"series {quantity!r}: expected times and values (n,) that are finite, found "
            f"{t.shape} and {y.shape}"
        )
    if sigma is not None and not 0.0 < sigma < np.inf:
        raise StudyError(f"series {quantity!r}: expected sigma above 0, found {sigma}")
    check_times(t, f"series {quantity!r}")
    return MeasuredSeries(f"series {quantity!r}", quantity, t, y, float(sigma or 0.0))


def _of_study(study: StudyOfOneModel, output: Path | None) -> ModelFit:
    table = study.file.fit
    if table is None or not table.series:
        raise StudyError("expected the table [fit] with [[fit.series]], found none")
    series = [
        read_series(one, study.path.parent, f"fit.series.{n}") for n, one in enumerate(table.series)
    ]
    if output is not None:
        files = [*study.inputs, *(study.path.parent / one.file for one in table.series)]
        require_no_input(output, files, "an input of the fit")
    made = _fitted(study.parametrized, study.parameters, series, table.shift, table.derivatives)
    # Written last: a fit that fails leaves no file.
    if output is not None:
        study.write(output, made.values)
    return made


def _fitted(
    family: Parametrized,
    parameters: Mapping[str, StudyParameter],
    series: Sequence[MeasuredSeries],
    shift: bool,
    derivatives: str,
) -> ModelFit:
    # Import here: takes a second, and no other study needs it.
    from scipy.optimize import least_squares

    if SHIFT_NAME in parameters:
        raise StudyError(f"parameters.{SHIFT_NAME}: is the time shift: expected another name")
    if len({one.sigma > 0.0 for one in series}) != 1:
        raise StudyError("fit.series: expected sigma of all series or of none")
    axes = [SearchAxis.of(name, parameter) for name, parameter in parameters.items()]
    problem = FitProblem(family, axes, series, derivatives)
    problem.begin(shift)
    axes = problem.axes
    start = np.array([axis.inner(axis.begin) for axis in axes])
    bounds = np.array([[axis.inner(end) for end in (axis.low, axis.high)] for axis in axes]).T
    found = least_squares(
        problem.residuals,
        start,
        problem.jacobian,
        bounds,
        x_scale="jac",
        max_nfev=MOST_SEARCH_STEPS,
    )
    return problem.fit(found.x, found.active_mask, found.status > 0)
