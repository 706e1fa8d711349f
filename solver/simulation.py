"""Run a model: the compiled loop in chunks, with results written and progress shown between them."""

import os
import time
from pathlib import Path

import numpy as np

from .compilation import CompiledModel
from .compiled import Array, is_cached
from .errors import ConvergenceError
from .initial import begin
from .loop import advance, record
from .model import Model
from .progress import Progress
from .results import Results, ResultsFile, check_folder, make_output
from .system import Inputs, State, Workspace

CHUNK_NUMBERS = 1 << 20
"""how many numbers of output a chunk may hold"""


def simulate(model: Model, output: str | os.PathLike[str] | None = None, progress: bool = False) -> Results:
    """Integrate the motion of a model from t = 0 to t_end.

    output: the results file, by default none (results stay in memory); progress: show a bar.
    Raises ModelError for a model that cannot start and ConvergenceError where Newton's method fails; the results
    file then holds the steps before the failure.
    """
    if output is not None:
        check_folder(Path(output))
    with Progress("compiling (first run only)", shown=progress and not is_cached()):
        beginning = begin(model)
        compiled, state, work = beginning.compiled, beginning.state, beginning.work
        _compile_loop(compiled, state, work)
    file = ResultsFile(Path(output) if output is not None else None, compiled)
    file.note(
        degrees_of_freedom=beginning.degrees_of_freedom,
        opening=beginning.misfit.opening,
        opening_at=beginning.misfit.opening_at,
        velocity_misfit=beginning.misfit.velocity,
        velocity_misfit_at=beginning.misfit.velocity_at,
        moved=beginning.moved,
        velocity_correction=beginning.velocity_correction,
        removed=beginning.removed,
    )
    started = time.perf_counter()
    _march(compiled, state, work, file, progress)
    file.note(finished=True, seconds=time.perf_counter() - started)
    return file.results()


def _march(compiled: CompiledModel, state: State, work: Workspace, file: ResultsFile, progress: bool) -> None:
    quaternions = compiled.frame_quaternions
    rows = _chunk_rows(compiled)
    output = make_output(compiled, rows)
    record(compiled.system, quaternions, 0, state, work, output)
    file.append(0, output, 1)
    done, total = 0, compiled.n_steps
    with Progress("simulating", total, shown=progress) as bar:
        while done < total:
            inputs = _inputs(compiled, done + 1, min(rows, total - done))
            taken = advance(compiled.system, quaternions, inputs, state, work, output)
            if taken:
                file.append(done + 1, output, taken)
            done += taken
            bar.advance(taken)
            if taken < len(inputs.load):
                raise _failure(compiled, done + 1, float(output.residual[taken]), work)


def _compile_loop(compiled: CompiledModel, state: State, work: Workspace) -> None:
    """Call the loop for no steps at all, so that it is compiled or loaded."""
    advance(compiled.system, compiled.frame_quaternions, _inputs(compiled, 1, 0), state, work, make_output(compiled, 0))


def _chunk_rows(compiled: CompiledModel) -> int:
    width = sum(array[0].size for array in make_output(compiled, 1))
    return int(np.clip(CHUNK_NUMBERS // width, 16, 1024))


def _inputs(compiled: CompiledModel, first: int, n: int) -> Inputs:
    """Signals at the steps first, first + 1, ..."""
    t = compiled.h * np.arange(first, first + n, dtype=np.float64)
    load = [signal.samples(t, compiled.h) for signal in compiled.load_signals]
    drive = [np.array([signal(time) for time in t.tolist()]) for signal in compiled.drives]
    return Inputs(_columns(load, n), _columns(drive, n))


def _columns(signals: list[Array], n: int) -> Array:
    return np.array(signals).reshape(len(signals), n).T.copy()


def _failure(compiled: CompiledModel, step: int, residual: float, work: Workspace) -> ConvergenceError:
    name, opening = _worst_joint(compiled, work)
    return ConvergenceError(step, step * compiled.h, residual, compiled.model.tolerance, name, opening)


def _worst_joint(compiled: CompiledModel, work: Workspace) -> tuple[str, float]:
    couplings = compiled.system.couplings
    opening = np.abs(work.phi) * (couplings.compliant == 0)
    if not opening.any():
        return "", 0.0
    row = int(np.argmax(opening))
    return compiled.coupling_names[compiled.coupling_of(row)], float(opening[row])
