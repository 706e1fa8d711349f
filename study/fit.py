"""Parameters of a model for which its runs are nearest to measured series.

    minimize  sum over series and samples of ((y(t - shift; p) - measured) / sigma)^2

within the bounds of the parameters. J, the derivatives of the residuals at the optimum, gives the
covariance (J^T J)^-1 of the parameters, times the mean square of the residuals where sigma is not
known. Standard deviations and correlations hold as far as the model does, and y is nearly linear
in the parameters within them.

Source: docs/theory.md, Fits.
"""

import os
from pathlib import Path

import numpy as np

from ..files import renamed_when_whole, require_no_input
from ..inputs import toml_of
from .errors import StudyError
from .fit_problem import FitProblem
from .measured_series import read_series
from .model_fit import ModelFit
from .one_model import StudyOfOneModel, read_study_of_one_model
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
    axes = [SearchAxis.of(name, parameter) for name, parameter in study.parameters.items()]
    problem = FitProblem(study.parametrized, axes, series)
    problem.begin(table.shift)
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
    # Written last: a fit that fails leaves no file.
    made = problem.fit(found.x, found.active_mask, found.status > 0)
    if output is not None:
        tables = study.plan.moved(output.parent).document_at(
            {one.name: one.value for one in made.parameters if one.is_key}
        )
        with renamed_when_whole(output, failure=StudyError) as temporary:
            temporary.write_text(toml_of(tables), encoding="utf-8")
    return made
