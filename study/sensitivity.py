"""Derivatives of what a run gives by the parameters of its model."""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..files.arrays import Array
from ..inputs import dotted
from ..solver import Model, simulate
from .asked_numbers import AskedNumbers
from .differences import DIFFERENCE_STEPS, LEAST_STEPS, DifferenceSlopes, slopes_of
from .errors import StudyError
from .one_model import read_study_of_one_model
from .outputs import is_series, is_stepwise, units
from .parametrized import Parametrized, of_function, of_model
from .runs import runs_at

SENSITIVITY_METHODS = ("differences",)
SWITCH_NOTE = "switches within the run: the error is that of the widest difference"


@dataclass(frozen=True, eq=False)
class SeriesDerivative:
    """A quantity over time with its derivatives, see `sensitivities` for an example.

    abscissa (n,) [s or Hz]; value (n,); derivative, error (n, parameters), per unit of each.
    """

    abscissa: Array
    value: Array
    derivative: Array
    error: Array


@dataclass(frozen=True, eq=False)
class Sensitivities:
    """Outputs of a run and their derivatives by parameters, see `sensitivities` for an example.

    parameters: the values at which they were taken, by name; outputs: by name, as in study files;
    units: of the outputs; value (outputs,); derivative, error (outputs, parameters), in SI units;
    series: quantities over time, by their words; notes: what is to be known of them.
    """

    parameters: Mapping[str, float]
    outputs: Mapping[str, str]
    units: Mapping[str, str]
    value: Array
    derivative: Array
    error: Array
    series: Mapping[str, SeriesDerivative]
    notes: tuple[str, ...]

    @property
    def elasticity(self) -> Array:
        """p / y dy/dp (outputs, parameters): per cent of an output for one of a parameter."""
        p = np.array(list(self.parameters.values()))
        with np.errstate(divide="ignore", invalid="ignore"):
            found: Array = self.derivative * p / self.value[:, None]
        return found


def sensitivities(
    model: Model | Callable[..., Model],
    parameters: Mapping[str, str] | Mapping[str, float] | Sequence[str],
    outputs: Mapping[str, str] | Sequence[str],
    method: str = "differences",
    *,
    scales: Mapping[str, float] | None = None,
) -> Sensitivities:
    """Derivatives of outputs of a run by parameters of its model.

    By central differences with steps of 1e-2 to 1e-6 of each parameter. The error is the scatter of
    neighboring steps. Superelements are read once. That is ten runs for each parameter.

    Parameters
    ----------
    model : Model or callable
        Or a function that makes it, with the parameters as keywords.
    parameters : mapping or sequence of str
        Keys of a model file, as "bodies.hub.mass" or "contacts.floor.stiffness", or those by names
        of your own. Of a function: their values by name.
    outputs : mapping or sequence of str
        As in study files, as "max |displacement:beam.tip:hub.rim:y|"; a quantity alone, as
        "angle:pivot:z", is taken over time.
    method : {"differences"}
    scales : mapping of float, optional
        The size by which steps of a parameter are counted, by default its value. A parameter that
        is 0 needs it.

    Returns
    -------
    Sensitivities

    Raises
    ------
    StudyError
        For a key that there is not, or is no number; an output that there is not; and a parameter
        with which the model cannot run on either side.

    Notes
    -----
    Where a contact, a stop, a limit or friction switches, a run with fixed steps has another slope
    than the motion. Steps then scatter: the widest difference is taken, and a note says so.

    Examples
    --------
    >>> from duhamel.solver import Model, RigidBody, Settings
    >>> ball = RigidBody(2.0, [0.1] * 3)
    >>> model = Model({"ball": ball}, gravity=(0, 0, -10), settings=Settings(t_end=1.0, step=0.1))
    >>> found = sensitivities(model, {"g": "simulation.gravity.2"}, ["final position:ball:z"])
    >>> found.derivative.round(6).tolist()
    [[0.5]]
    """
    _check_method(method)
    if isinstance(model, Model):
        family = of_model(model, parameters)  # type: ignore[arg-type]
    else:
        family = of_function(model, parameters)  # type: ignore[arg-type]
    named = outputs if isinstance(outputs, Mapping) else {text: text for text in outputs}
    return by_differences(family, named, scales or {})


def sensitivities_of(path: str | os.PathLike[str], method: str = "differences") -> Sensitivities:
    """The derivatives of the outputs of a study file by its parameters.

    As `sensitivities` takes them, at the values that the study file gives its parameters, the means
    of their normal distributions, or else those of the model file. `StudyError` names the file.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from duhamel.solver import Model, RigidBody, Settings, write_model
    >>> ball = RigidBody(2.0, [0.1] * 3)
    >>> model = Model({"ball": ball}, gravity=(0, 0, -10), settings=Settings(t_end=1.0, step=0.1))
    >>> study = '''
    ... model = "ball.toml"
    ... parameters."simulation.gravity.2" = -10
    ... outputs.height = "final position:ball:z"
    ... '''
    >>> with TemporaryDirectory() as name:
    ...     write_model(model, Path(name) / "ball.toml")
    ...     written = (Path(name) / "gravity.toml").write_text(study)
    ...     found = sensitivities_of(Path(name) / "gravity.toml")
    >>> found.derivative.round(6).tolist()
    [[0.5]]
    """
    _check_method(method)
    study = read_study_of_one_model(path)
    for name, output in study.file.outputs.items():
        if is_series(output):
            raise StudyError(
                f"{study.path}: outputs.{dotted([name])}: {output!r} is over time: expected one "
                f"number of it, as 'final {output}'"
            )
    # The deviation of a parameter whose mean is 0 is its size.
    scales = {
        name: parameter.deviation
        for name, parameter in study.parameters.items()
        if parameter.deviation and not parameter.value
    }
    try:
        return by_differences(study.parametrized, study.file.outputs, scales)
    except StudyError as error:
        raise StudyError(f"{study.path}: {error}") from error


def by_differences(
    family: Parametrized, outputs: Mapping[str, str], scales: Mapping[str, float]
) -> Sensitivities:
    """The derivatives of a family of models, as `sensitivities` describes them."""
    if unknown := sorted(scales.keys() - family.values.keys()):
        raise StudyError(f"scales.{dotted([unknown[0]])}: no parameter has this name")
    sizes = {name: _scale(name, value, scales) for name, value in family.values.items()}
    # First: it tells what is wrong with the model or the outputs, and warns as runs do.
    results = simulate(family.make(family.values))
    asked = AskedNumbers.of(results, outputs)
    base = asked.numbers(results)
    slopes = [_slopes(family, name, scale, asked) for name, scale in sizes.items()]
    value, over_time = asked.split(base)
    derivative, derivatives = asked.split(np.stack([one.value for one in slopes], axis=1))
    error, errors = asked.split(np.stack([one.error for one in slopes], axis=1))
    error[[is_stepwise(text) for text in asked.outputs.values()]] = np.inf
    series = {
        name: SeriesDerivative(abscissa, over_time[name], derivatives[name], errors[name])
        for name, abscissa in asked.series.items()
    }
    return Sensitivities(
        dict(family.values),
        asked.outputs,
        units(results, asked.outputs),
        value,
        derivative,
        error,
        series,
        (*_switching(family, slopes, asked), *_without_derivative(value, asked)),
    )


def _slopes(family: Parametrized, name: str, scale: float, asked: AskedNumbers) -> DifferenceSlopes:
    """The derivatives of all numbers by a parameter; `StudyError` where no run can be made."""
    asked.failure = ""
    found = _differences(family, name, scale, asked)
    if np.isfinite(found).any(axis=1).sum() < LEAST_STEPS and asked.failure:
        raise StudyError(
            f"parameters.{dotted([name])}: the model does not run on both sides of "
            f"{family.values[name]:.9g}: {asked.failure}"
        )
    return slopes_of(found)


def _switching(
    family: Parametrized, slopes: Sequence[DifferenceSlopes], asked: AskedNumbers
) -> Iterator[str]:
    """Lines about outputs whose differences by a parameter scatter."""
    for name, one in zip(family.values, slopes, strict=True):
        of_outputs, of_series = asked.split(one.switches)
        switching = [*of_outputs.tolist(), *(part.any() for part in of_series.values())]
        for output, switches in zip((*asked.outputs, *asked.series), switching, strict=True):
            if switches:
                yield f"{output} by {name}: {SWITCH_NOTE}"


def _without_derivative(value: Array, asked: AskedNumbers) -> Iterator[str]:
    """Lines about outputs that have no derivative."""
    for (output, text), number in zip(asked.outputs.items(), value.tolist(), strict=True):
        if not np.isfinite(number):
            yield f"{output} has no number in this run"
        elif is_stepwise(text):
            yield f"{output} is one of the recorded times, or a count: its error is not known"


def _check_method(method: str) -> None:
    if method not in SENSITIVITY_METHODS:
        raise StudyError(f"method: expected {' or '.join(SENSITIVITY_METHODS)}, found {method!r}")


def _scale(name: str, value: float, scales: Mapping[str, float]) -> float:
    scale = abs(scales.get(name, value))
    if not 0.0 < scale < np.inf:
        raise StudyError(
            f"parameters.{dotted([name])}: expected a scale above 0 for its steps, found "
            f"{scale:.6g}: the value is {value:.6g}"
        )
    return float(scale)


def _differences(family: Parametrized, name: str, scale: float, asked: AskedNumbers) -> Array:
    """D of each step and number (5, m); no numbers where a run failed."""
    value = family.values[name]
    ends = np.array([value + DIFFERENCE_STEPS * scale, value - DIFFERENCE_STEPS * scale])
    points = [{**family.values, name: end} for end in ends.ravel().tolist()]
    numbers = np.array([asked.of_run(run) for run in runs_at(family, points)])
    above, below = np.split(numbers, 2)
    # By the difference of what was really put in: steps of 1e-6 are rounded.
    found: Array = (above - below) / (ends[0] - ends[1])[:, None]
    return found
