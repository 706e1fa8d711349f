"""Run a model: the time loop in stints, with results written and progress shown between them."""

import os
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..results.results import Results
from .arrays import Array, Index
from .errors import ConvergenceError, about
from .history.dyadic import Lookahead
from .lower.lower import LoweredModel
from .model.model import Model
from .model.settings import Settings
from .output.file import ResultsFile, check_folder
from .output.recorder import Recorder
from .progress import Progress
from .start.initial import initialize
from .step.loop import advance
from .step.record import record
from .step.system import Inputs, Run, State, Workspace

STINT = 0.1
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
    ConvergenceError where Newton's method fails and ResultsError for a file that cannot be written;
    the file then holds the steps before the failure, as it does after an interrupt.
    """
    if settings is not None:
        model = replace(model, settings=settings)
    if output is not None:
        check_folder(Path(output))
    with about(model.path):
        initial = initialize(model)
    lowered, state, work = initial.lowered, initial.state, initial.work
    file = ResultsFile(Path(output) if output is not None else None, lowered)
    file.note(
        degrees_of_freedom=initial.degrees_of_freedom,
        opening=initial.assembly_error.opening,
        opening_at=initial.assembly_error.opening_at,
        velocity_misfit=initial.assembly_error.velocity,
        velocity_misfit_at=initial.assembly_error.velocity_at,
        moved=initial.moved,
        velocity_correction=initial.velocity_correction,
        removed=initial.removed,
        truncation=lowered.truncation,
    )
    started = time.perf_counter()
    _march(lowered, state, work, file, progress)
    file.note(finished=True, seconds=time.perf_counter() - started)
    return file.results()


def _march(
    lowered: LoweredModel, state: State, work: Workspace, file: ResultsFile, progress: bool
) -> None:
    done, total, stint = 0, lowered.n_steps, 16
    lookahead = Lookahead(lowered.system.elastic)
    with Recorder(file, lowered) as recorder, Progress("simulating", total, shown=progress) as bar:
        run = Run(system=lowered.system, state=state, work=work, output=recorder.output)
        record(run, 0)
        recorder.keep(0, recorder.rows(0, 1))
        while done < total:
            started = time.perf_counter()
            rows = recorder.rows(done + 1, lookahead.room(done, min(stint, total - done)))
            taken, residual = advance(run, signals(lowered, done + 1, rows))
            recorder.keep(done + 1, rows[:taken])
            done += taken
            bar.advance(taken)
            if taken < len(rows):
                raise failure(lowered, done + 1, residual, work)
            lookahead.look(state)
            if time.perf_counter() - started < 0.5 * STINT:
                stint *= 2


def signals(lowered: LoweredModel, first: int, rows: Index) -> Inputs:
    """Loads and drives at the steps first, first + 1, ..., which the loop records in the rows."""
    n = len(rows)
    t = lowered.h * np.arange(first, first + n, dtype=np.float64)
    load = [signal.samples(t, lowered.h) for signal in lowered.load_signals]
    drive = [np.array([signal(time) for time in t.tolist()]) for signal in lowered.drives]
    return Inputs(load=_columns(load, n), drive=_columns(drive, n), row=rows, ahead=0)


def _columns(signals: list[Array], n: int) -> Array:
    return np.array(signals).reshape(len(signals), n).T.copy()


def failure(lowered: LoweredModel, step: int, residual: float, work: Workspace) -> ConvergenceError:
    name, opening = _worst_joint(lowered, work)
    return ConvergenceError(
        step,
        step * lowered.h,
        residual,
        lowered.model.settings.tolerance,
        name,
        opening,
        lowered.model.path,
    )


def _worst_joint(lowered: LoweredModel, work: Workspace) -> tuple[str, float]:
    couplings = lowered.system.couplings
    opening = np.abs(work.couplings.phi) * (couplings.compliant == 0)
    if not opening.any():
        return "", 0.0
    row = int(np.argmax(opening))
    return lowered.coupling_names[lowered.coupling_of(row)], float(opening[row])
