"""Derivatives of what a run gives by the parameters of its model."""

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..files.arrays import Array
from ..inputs import dotted
from ..results import Results
from ..solver import Model, simulate
from .asked_numbers import AskedNumbers
from .differences import DIFFERENCE_STEPS, LEAST_STEPS, DifferenceSlopes, slopes_of
from .dual_slopes import dual_slopes
from .errors import StudyError
from .one_model import read_study_of_one_model
from .outputs import is_series, is_stepwise, units
from .parametrized import Parametrized, of_function, of_model
from .runs import runs_at

SWITCH_NOTE = "switches within the run: the error is that of the widest difference"
SCATTER_NOTE = "the exact derivative varies by {:.2g} % with where in their steps forces switch"
MAX_SCATTER = 1e-3
"""error of a derivative over itself, from where on differences are tried beside it"""


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

    "differences": central differences with steps of 1e-2 to 1e-6 of each parameter. The error is
    the scatter of neighboring steps. That is ten runs for each parameter. "dual": one run with dual
    numbers, for all parameters together. Superelements are read once.

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
    method : {"differences", "dual"}
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
        with which the model cannot run on either side; by dual numbers, what has none.

    Notes
    -----
    Where a contact, a stop, a limit or friction switches, a run with fixed steps has another slope
    than the motion. Steps then scatter: the widest difference is taken, and a note says so. Dual
    numbers are then taken at five values nearby too, whose scatter is the error. Where it exceeds a
    thousandth, differences are tried, and of both that with the smaller error is taken.

    Examples
    --------
    >>> from duhamel.solver import Model, RigidBody, Settings
    >>> ball = RigidBody(2.0, [0.1] * 3)
    >>> model = Model({"ball": ball}, gravity=(0, 0, -10), settings=Settings(t_end=1.0, step=0.1))
    >>> found = sensitivities(model, {"g": "simulation.gravity.2"}, ["final position:ball:z"])
    >>> found.derivative.round(6).tolist()
    [[0.5]]
    """
    take = _taking(method)
    if isinstance(model, Model):
        family = of_model(model, parameters)  # type: ignore[arg-type]
    else:
        family = of_function(model, parameters)  # type: ignore[arg-type]
    if not family.values:
        raise StudyError("parameters: expected at least one, found none")
    named = outputs if isinstance(outputs, Mapping) else {text: text for text in outputs}
    return take(family, named, scales or {})


def sensitivities_of(path: str | os.PathLike[str], method: str | None = None) -> Sensitivities:
    """The derivatives of the outputs of a study file by its parameters.

    As `sensitivities` takes them, at the values that the study file gives its parameters, the means
    of their normal distributions, or else those of the model file. method: by default that of the
    study file. `StudyError` names the file.

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
    study = read_study_of_one_model(path)
    take = _taking(method or study.file.sensitivity.method)
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
        return take(study.parametrized, study.file.outputs, scales)
    except StudyError as error:
        raise StudyError(f"{study.path}: {error}") from error


def by_differences(
    family: Parametrized, outputs: Mapping[str, str], scales: Mapping[str, float]
) -> Sensitivities:
    """The derivatives of a family of models by central differences."""
    sizes = _scales(family, scales)
    # First: it tells what is wrong with the model or the outputs, and warns as runs do.
    results = simulate(family.make(family.values))
    asked = AskedNumbers.of(results, outputs)
    found = [_slopes(family, name, scale, asked) for name, scale in sizes.items()]
    value = np.stack([one.value for one in found], axis=1)
    error = np.stack([one.error for one in found], axis=1)
    return _sensitivities(family, results, asked, value, error, _switching(family, found, asked))


def by_dual_numbers(
    family: Parametrized, outputs: Mapping[str, str], scales: Mapping[str, float]
) -> Sensitivities:
    """The derivatives of a family of models by dual numbers, where they scatter by differences."""
    sizes = _scales(family, scales)
    results = simulate(family.make(family.values))
    asked = AskedNumbers.of(results, outputs)
    value, error, found = dual_slopes(family, sizes, asked, results)
    notes = list(found)
    for j, (name, scale) in enumerate(sizes.items()):
        scattering = error[:, j] > MAX_SCATTER * np.abs(value[:, j])
        if not scattering.any():
            continue
        # Where exact derivatives scatter, small steps may well agree on one of them.
        try:
            other = _slopes(family, name, scale, asked, scattering)
        except StudyError:  # valid on one side alone
            notes += _scattering(name, value[:, j], error[:, j], scattering, ~scattering, asked)
            continue
        better = scattering & (other.error < error[:, j])
        notes += _scattering(name, value[:, j], error[:, j], scattering, better, asked)
        value[better, j], error[better, j] = other.value[better], other.error[better]
    return _sensitivities(family, results, asked, value, error, notes)


SLOPE_METHODS = {"differences": by_differences, "dual": by_dual_numbers}


def _sensitivities(
    family: Parametrized,
    results: Results,
    asked: AskedNumbers,
    slopes: Array,
    errors_of_slopes: Array,
    notes: Iterable[str],
) -> Sensitivities:
    value, over_time = asked.split(asked.numbers(results))
    derivative, derivatives = asked.split(slopes)
    error, errors = asked.split(errors_of_slopes)
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
        (*notes, *_without_derivative(value, asked)),
    )


def _slopes(
    family: Parametrized,
    name: str,
    scale: float,
    asked: AskedNumbers,
    switching: NDArray[np.bool_] | None = None,
) -> DifferenceSlopes:
    """The derivatives of all numbers by a parameter; `StudyError` where no run can be made."""
    asked.failure = ""
    found = _differences(family, name, scale, asked)
    if np.isfinite(found).any(axis=1).sum() < LEAST_STEPS and asked.failure:
        raise StudyError(
            f"parameters.{dotted([name])}: the model does not run on both sides of "
            f"{family.values[name]:.9g}: {asked.failure}"
        )
    return slopes_of(found, switching)


def _switching(
    family: Parametrized, slopes: Sequence[DifferenceSlopes], asked: AskedNumbers
) -> Iterator[str]:
    """Lines about outputs whose differences by a parameter scatter."""
    for name, one in zip(family.values, slopes, strict=True):
        for output, switches in zip(*_of_each(asked, one.switches), strict=True):
            if switches.any():
                yield f"{output} by {name}: {SWITCH_NOTE}"


def _scattering(
    name: str,
    value: Array,
    error: Array,
    scattering: NDArray[np.bool_],
    better: NDArray[np.bool_],
    asked: AskedNumbers,
) -> Iterator[str]:
    """Lines about outputs whose exact derivatives by a parameter scatter."""
    outputs, of_each = _of_each(asked, np.stack([value, error, scattering, better], axis=-1))
    for output, numbers in zip(outputs, of_each, strict=True):
        scatters = numbers[:, 2] > 0.0
        replaced = scatters & (numbers[:, 3] > 0.0)
        if not scatters.any():
            continue
        largest = np.abs(numbers[scatters, 0]).max()
        share = numbers[scatters, 1].max() / largest if largest else np.inf
        taken = "; differences are taken" if replaced.any() else ""
        yield f"{output} by {name}: {SCATTER_NOTE.format(100.0 * share)}{taken}"


def _of_each(asked: AskedNumbers, numbers: NDArray[Any]) -> tuple[list[str], list[NDArray[Any]]]:
    """The outputs and quantities over time, and the numbers (m, ...) of each."""
    of_outputs, of_series = asked.split(numbers)
    return [*asked.outputs, *asked.series], [*of_outputs[:, None], *of_series.values()]


def _without_derivative(value: Array, asked: AskedNumbers) -> Iterator[str]:
    """Lines about outputs that have no derivative."""
    for (output, text), number in zip(asked.outputs.items(), value.tolist(), strict=True):
        if not np.isfinite(number):
            yield f"{output} has no number in this run"
        elif is_stepwise(text):
            yield f"{output} is one of the recorded times, or a count: its error is not known"


def _taking(method: str) -> Callable[..., Sensitivities]:
    """What takes derivatives by a method."""
    if method not in SLOPE_METHODS:
        raise StudyError(f"method: expected {' or '.join(SLOPE_METHODS)}, found {method!r}")
    return SLOPE_METHODS[method]


def _scales(family: Parametrized, scales: Mapping[str, float]) -> dict[str, float]:
    if unknown := sorted(scales.keys() - family.values.keys()):
        raise StudyError(f"scales.{dotted([unknown[0]])}: no parameter has this name")
    return {name: _scale(name, value, scales) for name, value in family.values.items()}


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
