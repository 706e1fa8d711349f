"""Run a model: the compiled loop in stints, with results written and progress shown between them."""

import os
import time
from pathlib import Path

import numpy as np

from ..results.results import Results
from ..results.source import Writer
from .arrays import Array, Index
from .errors import ConvergenceError, about
from .history.dyadic import Lookahead
from .lower.lower import CompiledModel
from .model.model import Model
from .output.columns import make_output
from .output.recorder import Recorder
from .output.writer import check_output, make_writer, read_back
from .progress import Progress
from .start.initial import begin
from .step.jit import is_cached
from .step.loop import advance, record
from .step.system import Inputs, State, Workspace

STINT = 0.1
"""seconds that the loop runs before it returns, for progress and interrupts"""


def simulate(
    model: Model, output: str | os.PathLike[str] | None = None, progress: bool = False
) -> Results:
    """Integrate the motion of a model from t = 0 to t_end.

    output: the results file, by default none (results stay in memory); progress: show a bar. Raises
    ModelError for a model that cannot start, ConvergenceError where Newton's method fails and
    ResultsError for a file that cannot be written; the file then holds the steps before the
    failure, as it does after an interrupt.
    """
    return _run(model, None if output is None else Path(output), progress)


def start(model: Model) -> Results:
    """The results of the start alone: one row, at t = 0. Raises ModelError as `simulate` does."""
    return _run(model, None, progress=False, steps=0)


def _run(model: Model, output: Path | None, progress: bool, steps: int | None = None) -> Results:
    if output is not None:
        check_output(output, model)
    with (
        about(model.path),
        Progress("compiling (first run only)", shown=progress and not is_cached()),
    ):
        beginning = begin(model)
        compiled, state, work = beginning.compiled, beginning.state, beginning.work
        compile_loop(compiled, state, work)
        total = compiled.n_steps if steps is None else steps
        writer = make_writer(output, beginning, total)
    started = time.perf_counter()
    _march(compiled, state, work, writer, total, progress)
    writer.note(finished=True, seconds=time.perf_counter() - started)
    return read_back(output, writer, model)


def _march(
    compiled: CompiledModel,
    state: State,
    work: Workspace,
    writer: Writer,
    total: int,
    progress: bool,
) -> None:
    system, quaternions = compiled.system, compiled.frame_quaternions
    done, stint = 0, 16
    lookahead = Lookahead(system.elastic)
    with (
        Recorder(writer, compiled) as recorder,
        Progress("simulating", total, shown=progress) as bar,
    ):
        output = recorder.output
        record(system, quaternions, 0, state, work, output)
        recorder.keep(0, recorder.rows(0, 1))
        while done < total:
            started = time.perf_counter()
            rows = recorder.rows(done + 1, lookahead.room(done, min(stint, total - done)))
            taken, residual = advance(
                system, quaternions, signals(compiled, done + 1, rows), state, work, output
            )
            recorder.keep(done + 1, rows[:taken])
            done += taken
            bar.advance(taken)
            if taken < len(rows):
                raise failure(compiled, done + 1, residual, work)
            lookahead.look(state)
            if time.perf_counter() - started < 0.5 * STINT:
                stint *= 2


def compile_loop(compiled: CompiledModel, state: State, work: Workspace) -> None:
    """Call the loop for no steps at all, so that it is compiled or loaded."""
    none = signals(compiled, 1, np.empty(0, dtype=np.int64))
    advance(
        compiled.system, compiled.frame_quaternions, none, state, work, make_output(compiled, 0)
    )


def signals(compiled: CompiledModel, first: int, rows: Index) -> Inputs:
    """Loads and drives at the steps first, first + 1, ..., which the loop records in the rows."""
    n = len(rows)
    t = compiled.h * np.arange(first, first + n, dtype=np.float64)
    load = [signal.samples(t, compiled.h) for signal in compiled.load_signals]
    drive = [np.array([signal(time) for time in t.tolist()]) for signal in compiled.drives]
    return Inputs(_columns(load, n), _columns(drive, n), rows, ahead=0)


def _columns(signals: list[Array], n: int) -> Array:
    return np.array(signals).reshape(len(signals), n).T.copy()


def failure(
    compiled: CompiledModel, step: int, residual: float, work: Workspace
) -> ConvergenceError:
    name, opening = _worst_joint(compiled, work)
    return ConvergenceError(
        step,
        step * compiled.h,
        residual,
        compiled.model.tolerance,
        name,
        opening,
        compiled.model.path,
    )


def _worst_joint(compiled: CompiledModel, work: Workspace) -> tuple[str, float]:
    couplings = compiled.system.couplings
    opening = np.abs(work.phi) * (couplings.compliant == 0)
    if not opening.any():
        return "", 0.0
    row = int(np.argmax(opening))
    return compiled.coupling_names[compiled.coupling_of(row)], float(opening[row])
