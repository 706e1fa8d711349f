"""Simulations: the time loop in batches of steps, with output and progress between them."""

import os
import time
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..results.results import Results
from ..results.source import Writer
from .arrays import Array, Index
from .errors import ConvergenceError, ValidityWarning, about
from .history.dyadic import DyadicConvolution
from .lower.lower import LoweredModel, lower
from .model.model import Model
from .model.settings import Settings
from .output.columns import requested
from .output.recorder import Recorder
from .output.validity import Judge, check_range
from .output.writer import check_output, make_writer, read_back
from .progress import Progress
from .start.initial import InitialState, initialize
from .step.loop import advance
from .step.record import record
from .step.system import Inputs, Run, Workspace

BATCH_SECONDS = 0.1
"""seconds that the loop runs before it returns, for progress and interrupts"""


def simulate(
    model: Model,
    settings: Settings | None = None,
    *,
    output: str | os.PathLike[str] | None = None,
    progress: bool = False,
) -> Results:
    """Integrate the motion of a model from t = 0 to t_end.

    settings: by default those of the model; output: the results file, by default none (results stay
    in memory); progress: show a bar. Raises ModelError for a model that cannot start,
    ConvergenceError where Newton's method fails, OutOfRangeError where a body deforms too far for
    linear elasticity, and ResultsError for a file that cannot be written; the file then holds the
    steps before the failure, as it does after an interrupt. Warns (`ValidityWarning`) of every
    limit of the method that the run has passed: `Results.validity`.
    """
    if settings is not None:
        model = replace(model, settings=settings)
    return _run(model, None if output is None else Path(output), progress)


def start(model: Model) -> Results:
    """The results of the start alone: one row, at t = 0.

    Raises ModelError as `simulate` does.
    """
    return _run(model, None, progress=False, steps=0)


def _run(model: Model, output: Path | None, progress: bool, steps: int | None = None) -> Results:
    if output is not None:
        check_output(output, model)
    with about(model.path):
        lowered = lower(model)
        requested(lowered)  # refuses what there is not, before anything is compiled
        initial = initialize(model, lowered)
        total = initial.lowered.n_steps if steps is None else steps
        judge = Judge(initial.lowered)
        check_range(initial.lowered, initial.state, 0)
        writer = make_writer(output, initial, judge, total)
    started = time.perf_counter()
    try:
        _march(initial, writer, judge, total, progress)
        writer.note(finished=True, seconds=time.perf_counter() - started)
        writer.finish()
    finally:
        writer.leave()
    results = read_back(output, writer, model)
    for line in results.validity.brief():
        warnings.warn(line, ValidityWarning, stacklevel=3)
    return results


def _march(initial: InitialState, writer: Writer, judge: Judge, total: int, progress: bool) -> None:
    lowered, state, work = initial.lowered, initial.state, initial.work
    done, batch = 0, 16
    convolution = DyadicConvolution(lowered.system.elastic)
    with (
        Recorder(writer, lowered) as recorder,
        Progress("simulating", total, shown=progress) as bar,
    ):
        run = Run(system=lowered.system, state=state, work=work, output=recorder.output)
        record(run, 0)
        writer.check(judge.values(state, 0))
        recorder.keep(0, recorder.rows(0, 1))
        while done < total:
            started = time.perf_counter()
            n = convolution.steps_until_due(done, min(batch, total - done))
            rows = recorder.rows(done + 1, n)
            taken, residual = advance(run, signals(lowered, done + 1, rows))
            writer.check(judge.values(state, done + taken))
            recorder.keep(done + 1, rows[:taken])
            done += taken
            bar.advance(taken)
            check_range(lowered, state, done)
            if taken < len(rows):
                cause = judge.cause(state, done)
                raise failure(lowered, done + 1, residual, work, cause)
            convolution.update(state)
            if time.perf_counter() - started < 0.5 * BATCH_SECONDS:
                batch *= 2


def signals(lowered: LoweredModel, first: int, rows: Index) -> Inputs:
    """Loads and drives at the steps first, first + 1, ..., which the loop records in the rows."""
    n = len(rows)
    t = lowered.h * np.arange(first, first + n, dtype=np.float64)
    load = [signal.samples(t, lowered.h) for signal in lowered.load_signals]
    drive = [np.array([signal(t_n) for t_n in t.tolist()]) for signal in lowered.drives]
    return Inputs(load=_columns(load, n), drive=_columns(drive, n), row=rows, ahead=0)


def _columns(samples: list[Array], n: int) -> Array:
    return np.array(samples).reshape(len(samples), n).T.copy()


def failure(
    lowered: LoweredModel, step: int, residual: float, work: Workspace, cause: str
) -> ConvergenceError:
    """The error of a step in which Newton's method failed, with its likely cause or ""."""
    return ConvergenceError(
        step,
        step * lowered.h,
        residual,
        lowered.model.settings.tolerance,
        _worst_joint(lowered, work),
        lowered.model.path,
        cause,
    )


def _worst_joint(lowered: LoweredModel, work: Workspace) -> tuple[str, float]:
    """The joint that is farthest open and its opening [m or rad]; "" if none is."""
    couplings = lowered.system.couplings
    opening = np.abs(work.couplings.phi) * (couplings.compliant == 0)
    if not opening.any():
        return "", 0.0
    row = int(np.argmax(opening))
    return lowered.coupling_names[lowered.coupling_of(row)], float(opening[row])
