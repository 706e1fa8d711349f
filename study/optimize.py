"""Parameters of a model for which an output of its runs is least or largest, within limits.

    minimize  f(p)    subject to    low_i <= g_i(p) <= high_i    and the bounds of p

Derivatives are differences of runs, made on all cores, or come of dual numbers. The search sees
parameters by their own sizes, the objective by its slope at the start, and limits by their own
sizes, so that units do not matter.

Source: docs/theory.md, Optimization.
"""

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..files import require_no_input
from ..files.arrays import Array
from ..inputs import InputError, dotted, read_part
from ..solver import Model
from .differences import DIFFERENCE_STEPS
from .errors import StudyError
from .goals import DEFAULT_RUNS, Goals, OptimizeTable
from .one_model import StudyParameter, read_study_of_one_model
from .optimize_problem import OptimizeProblem, SearchStoppedError, Trial
from .optimum import OptimizedConstraint, OptimizedParameter, Optimum
from .parameter import Parameter, family_of
from .parametrized import Parametrized
from .search import Ending, differential_evolution, slsqp
from .search_axis import SearchAxis
from .stationarity import Stationarity, stationarity

MOST_STARTS = 4
"""of a local search, each from where the last one ended"""
WORTHWHILE_GAIN = 1e-4
"""improvement over the size of the objective, for which a search is begun again"""
NEIGHBOR_STEP = 1e-2
"""of the size of a parameter, to points beside an optimum, none of which may be better"""
NEGLIGIBLE_GAIN = 1e-9
"""of the first slope, below which an objective that falls to 0 has no more worth"""
LEAST_SLOPE = 1e-2
"""of the first slope, below which it counts as none"""
LEAST_ELASTICITY = 1e-3
"""of the objective, in per cent for one per cent of a parameter, below which it counts as flat"""
GLOBAL_SHARE = 0.7
"""of the runs, that a global search leaves a local one the rest of"""
RUNS_AT_START = 2 * len(DIFFERENCE_STEPS) + 2
"""for each parameter"""


def optimize(path: str | os.PathLike[str], output: str | os.PathLike[str] | None = None) -> Optimum:
    """Optimize the parameters of a study file as its table [optimize] asks for.

    Parameters
    ----------
    path : path
        A study file with `model`, `parameters`, `outputs` and [optimize], as docs/studies.md
        describes it. A parameter begins at its number, the mean of its normal distribution, or the
        value of the model file; uniform and log_uniform ranges are bounds, the latter with steps in
        the logarithm.
    output : path, optional
        The model file with the optimized values, by default none.

    Returns
    -------
    Optimum
        Also where no optimum was found: `state` says so.

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
    ... parameters."bodies.ball.velocity.2".uniform = [0, 20]
    ... outputs.end = "final position:ball:z"
    ... optimize.minimize = "(end - 1)**2"
    ... '''
    >>> with TemporaryDirectory() as name:
    ...     folder = Path(name)
    ...     write_model(model, folder / "ball.toml")
    ...     text = (folder / "ball.toml").read_text()
    ...     written = (folder / "ball.toml").write_text(
    ...         text.replace("mass", "velocity = [0, 0, 2]\\nmass", 1)
    ...     )
    ...     written = (folder / "throw.toml").write_text(study)
    ...     found = optimize(folder / "throw.toml")
    >>> found.converged, round(found.parameters[0].value, 3)
    (True, 6.0)
    """
    study = read_study_of_one_model(path)
    try:
        if study.file.optimize is None:
            raise StudyError("expected the table [optimize], found none")
        target = None if output is None else Path(output).absolute()
        if target is not None:
            require_no_input(target, study.inputs, "an input of the search")
        goals = Goals(study.file.optimize, study.file.outputs)
        found = _optimum(study.parametrized, study.parameters, goals)
        if target is not None:
            study.write(target, found.values)
    except StudyError as error:
        raise StudyError(f"{study.path}: {error}") from error
    return found


def optimize_model(
    model: Model | Callable[..., Model],
    parameters: Mapping[str, str | Parameter],
    outputs: Mapping[str, str] | None = None,
    *,
    minimize: str | None = None,
    maximize: str | None = None,
    constraints: Mapping[str, tuple[float | None, float | None]] | None = None,
    method: str = "local",
    runs: int = DEFAULT_RUNS,
    seed: int = 0,
    derivatives: str = "differences",
) -> Optimum:
    """Optimize parameters of a model in memory, or of a function that makes one.

    Parameters
    ----------
    model : Model or callable
        Or a function that makes it, with the parameters as keywords.
    parameters : mapping of Parameter
        By names of your own; a text is the key of a parameter without bounds.
    outputs : mapping of str, optional
        By name, as in study files.
    minimize, maximize : str
        One of them: the name of an output, an output, or arithmetic of outputs and parameters.
    constraints : mapping of (low, high), optional
        Of what `minimize` takes: its limits, None where there is none; two equal ones are an
        equality.
    method : {"local", "global"}
        "local" goes downhill from the start, "global" looks in all of the bounds first.
    runs : int
        How many it may make.
    seed : int
        Of the random numbers of a global search.
    derivatives : {"differences", "dual"}
        By two runs for each parameter, or by one run with dual numbers.

    Returns
    -------
    Optimum

    Raises
    ------
    StudyError
        Names the argument; also where the model does not run at the start.

    Examples
    --------
    >>> from duhamel.solver import Model, RigidBody, Settings
    >>> from duhamel.study import Parameter, optimize_model
    >>> def fall(mass: float) -> Model:
    ...     ball = RigidBody(mass, [0.1] * 3)
    ...     settings = Settings(t_end=1.0, step=0.1)
    ...     return Model({"ball": ball}, gravity=(0, 0, -10), settings=settings)
    >>> found = optimize_model(
    ...     fall,
    ...     {"mass": Parameter(start=3.0, bounds=(1.0, 5.0))},
    ...     minimize="mass",
    ...     constraints={"max energy:kinetic": (100.0, None)},
    ... )
    >>> found.converged, round(found.value, 6), round(found.constraints[0].multiplier, 6)
    (True, 2.0, 0.02)
    """
    tables: dict[str, Any] = {
        "minimize": minimize,
        "maximize": maximize,
        "constraints": [
            {"output": name}
            | {
                key: float(end)
                for key, end in zip(("min", "max"), ends, strict=True)
                if end is not None
            }
            for name, ends in (constraints or {}).items()
        ],
        "method": method,
        "runs": runs,
        "seed": seed,
        "derivatives": derivatives,
    }
    try:
        table = read_part(
            {key: one for key, one in tables.items() if one is not None}, OptimizeTable
        )
    except InputError as error:
        raise StudyError(f"optimize: {error}") from error
    family, starts = family_of(model, parameters)
    return _optimum(family, starts, Goals(table, outputs or {}))


def _optimum(
    family: Parametrized, parameters: Mapping[str, StudyParameter], goals: Goals
) -> Optimum:
    if shared := sorted(goals.outputs.keys() & parameters.keys()):
        raise StudyError(f"outputs.{dotted([shared[0]])}: is the name of a parameter too")
    axes = [SearchAxis.of(name, parameter) for name, parameter in parameters.items()]
    table = goals.table
    if table.method == "global":
        for axis in axes:
            if not np.isfinite(axis.high - axis.low):
                raise StudyError(
                    f"parameters.{dotted([axis.name])}: a global search takes bounds, "
                    "{uniform = [..]}: found none"
                )
    # Differences at the end come on top of the search.
    least = RUNS_AT_START * len(axes) + 2
    if table.runs < least + 2 * len(axes):
        raise StudyError(
            f"optimize.runs: expected at least {least + 2 * len(axes)} for {len(axes)} parameters, "
            f"found {table.runs}"
        )
    problem = OptimizeProblem(family, axes, goals, table.runs - 2 * len(axes))
    try:
        problem.begin()
    except SearchStoppedError as error:
        raise StudyError(f"cannot begin: {error}") from error
    first_slope = _largest_slope(problem, problem.start)
    ending = _search(problem, first_slope)
    return _report(problem, ending, first_slope)


def _search(problem: OptimizeProblem, first_slope: float) -> Ending:
    """The search that is asked for, and others from where it ended while that is worth it."""
    begin, told = problem.start, ""
    try:
        if problem.goals.table.method == "global":
            with problem.some_runs(GLOBAL_SHARE):
                told = f"{_global(problem, begin)}; "
            begin = problem.best_point
            problem.rescale(begin)
        for _ in range(MOST_STARTS):
            before = problem.best
            ending = slsqp(problem, begin)
            if not problem.best.is_feasible:
                slsqp(problem, problem.best_point, of_violation=True)
                if not problem.best.is_feasible:
                    break
            elif before.is_feasible and _gain(problem, before) <= max(
                WORTHWHILE_GAIN * abs(before.objective), NEGLIGIBLE_GAIN * first_slope
            ):
                ended = problem.best
                problem.many(_beside(problem.best_point))
                if _gain(problem, ended) <= NEIGHBOR_STEP * _least_slope(ended, first_slope):
                    return ending._replace(told=told + ending.told)
            begin = problem.best_point
            problem.rescale(begin)
    except SearchStoppedError as error:
        return Ending(False, str(error))
    return Ending(False, told + ending.told)


def _gain(problem: OptimizeProblem, before: Trial) -> float:
    """By how much the best is better than one before."""
    return abs(problem.best.objective - before.objective)


def _least_slope(at: Trial, first_slope: float) -> float:
    """The slope of an objective that is as good as none."""
    return max(LEAST_SLOPE * first_slope, LEAST_ELASTICITY * abs(at.objective))


def _beside(inner: Array) -> list[Array]:
    """Points a small step away, which tell a maximum or a saddle, where slopes are none too."""
    steps = NEIGHBOR_STEP * np.eye(len(inner))
    return [*(inner + steps), *(inner - steps)]


def _global(problem: OptimizeProblem, begin: Array) -> str:
    try:
        return differential_evolution(problem, begin).told
    except SearchStoppedError as error:
        return f"differential evolution: {error}"


def _largest_slope(problem: OptimizeProblem, inner: Array) -> float:
    """Of the objective, in its own unit for the size of a parameter."""
    slopes = problem.slopes(inner)[problem.is_objective]
    return float(np.abs(slopes).max(initial=0.0)) * problem.objective_scale


def _report(problem: OptimizeProblem, ending: Ending, first_slope: float) -> Optimum:
    problem.has_ended = True
    best, start, goals = problem.best, problem.trials[0], problem.goals
    inner = problem.best_point
    units = problem.units
    try:
        holds = stationarity(problem, inner)
        if not best.is_feasible:
            holds = holds._replace(multipliers=0.0 * holds.multipliers)
    except SearchStoppedError as error:
        ending = Ending(False, f"{ending.told}; {error}")
        holds = Stationarity(np.inf, np.zeros(len(problem.limit_rows)), np.zeros(len(inner), int))
    left = holds.left * problem.objective_scale
    is_flat = left <= _least_slope(best, first_slope)
    told = ending.told
    if not problem.moves[:, problem.is_objective].any():
        is_flat = False
        told += "; no parameter changes the objective"
    elif ending.converged and not is_flat:
        told += (
            f"; yet a slope of {left:.2g} for the size of a parameter is left, as where the "
            "objective jumps or is noisy"
        )
    return Optimum(
        goals.table.objective,
        units.get(goals.table.objective, ""),
        goals.table.sign < 0.0,
        start.objective,
        best.objective,
        tuple(
            OptimizedParameter(axis.name, axis.start, best.values[axis.name], bool(side))
            for axis, side in zip(problem.axes, holds.bound.tolist(), strict=True)
        ),
        tuple(_constraints(problem, start, best, holds, units)),
        {name: (start.outputs[name], best.outputs[name]) for name in goals.outputs},
        units,
        ending.converged and is_flat and best.is_feasible,
        told,
        0.0 if best.is_feasible else best.violation,
        problem.runs,
        problem.failed,
        problem.failure,
        tuple(problem.trials),
        tuple(_remarks(problem)),
        best.warnings,
    )


def _constraints(
    problem: OptimizeProblem,
    start: Trial,
    best: Trial,
    holds: Stationarity,
    units: Mapping[str, str],
) -> list[OptimizedConstraint]:
    limits, made = problem.goals.limits, []
    for n, table in enumerate(problem.goals.table.constraints):
        multiplier, scale_of_0 = 0.0, 1.0
        for k, limit in enumerate(limits):
            if limit.constraint == n:
                if limit.value == 0.0:
                    scale_of_0 = problem.scales[k]
                of_rows = holds.multipliers[problem.limit_rows == k].sum()
                multiplier += float(of_rows) * problem.objective_scale / problem.scales[k]
        made.append(
            OptimizedConstraint(
                table.output,
                units.get(table.output, ""),
                -np.inf if table.min is None else table.min,
                np.inf if table.max is None else table.max,
                float(start.constraints[n]),
                float(best.constraints[n]),
                multiplier,
                scale_of_0,
            )
        )
    return made


def _remarks(problem: OptimizeProblem) -> list[str]:
    made = [
        f"by {name} something switches within the run: differences are taken over 1 % of it"
        for name in problem.uneven
    ]
    made += problem.switch_notes
    made += [
        f"{axis.name} changes neither the objective nor a constraint"
        for axis, moves in zip(problem.axes, problem.moves, strict=True)
        if not moves.any()
    ]
    return made
