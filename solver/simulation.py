"""Simulations: the time loop in batches of steps, with output and progress between them."""

import os
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path

import numpy as np

from ..files.blas import one_blas_thread
from ..files.kept_warnings import warn
from ..files.progress import Progress, Work
from ..results.batches import Energies
from ..results.file import FileWriter
from ..results.results import Results
from ..results.source import Writer
from .arrays import Array, Index
from .checkpoint.carried import FMUS_PREFIX, Arrays, carried, with_prefix
from .control import RUN_CONTROL, RunControl
from .cosimulation.exchange import Exchange
from .cosimulation.start import start_beside
from .diagnosis import likely_cause
from .errors import (
    ConvergenceError,
    MissedContactError,
    ModelError,
    OutOfRangeError,
    StateError,
    ValidityWarning,
    about,
)
from .history.dyadic import DyadicConvolution
from .lower.allocation import allocate
from .lower.lower import LoweredModel, lower
from .model.model import Model
from .model.settings import Settings
from .output.branches import Branches
from .output.columns import check_request
from .output.inputs import signal_warnings
from .output.keeper import (
    FileKeeper,
    NoKeeper,
    checkpoint_of,
    forget_checkpoint,
    read_checkpoint,
    settle_checkpoint,
    start_of,
)
from .output.passages import check_passages, check_resolution
from .output.recorder import NO_ENERGIES, Recorder
from .output.validity import ValidityMonitor, check_range, interface_out_of_range
from .output.writer import check_output, make_writer, read_back, recorded_every, resume_writer
from .phases import Phases
from .plausibility import severe_warnings
from .schema.entry import LARGEST_NUMBER
from .signals.signal import values_of
from .start.initial import InitialState, initialize, lower_to_start
from .start.removed import RemovedRows
from .step.events import is_full
from .step.record import record
from .step.system import Inputs, Run, State, Workspace

BATCH_SECONDS = 0.1
"""seconds that the loop runs before it returns, for progress and interrupts"""


def simulate(
    model: Model,
    settings: Settings | None = None,
    *,
    output: str | os.PathLike[str] | None = None,
    progress: bool = False,
    resume: bool = False,
    force: bool = False,
    anyway: bool = False,
) -> Results:
    """Integrate the motion of a model from t = 0 to t_end.

    The steps before a failure or an interrupt are in the file, or in OUTPUT.partial if earlier
    results are there: these stay until a run has ended well.

    Parameters
    ----------
    model : Model
    settings : Settings, optional
        By default those of the model.
    output : path, optional
        The results file; by default results stay in memory.
    progress : bool
        Report progress on stderr, as a bar or as lines.
    resume : bool
        Continue the last run to that file from the state that it kept (`Settings.checkpoint`). The
        results are to the bit those of a run that was never interrupted; t_end may be another.
    force : bool
        Continue even if model, versions or machine differ from that run. The former name is
        `anyway`.

    Returns
    -------
    Results

    Raises
    ------
    ModelError
        For a model that cannot start, or whose redundant constraints are needed later.
    ConvergenceError
        Where Newton's method fails.
    OutOfRangeError
        Where a body deforms too far for linear elasticity.
    MissedContactError
        Where a ball passes through a shape in one step.
    StateError
        For a state that does not belong to the model, or is damaged or missing.
    ResultsError
        For a file that cannot be written.

    Warns
    -----
    ValidityWarning
        For each limit of the method that the run has passed (`Results.validity`).

    Examples
    --------
    >>> from duhamel.solver import Model, RigidBody, Settings
    >>> ball = RigidBody(1.0, [0.1, 0.1, 0.1])
    >>> model = Model({"ball": ball}, gravity=(0, 0, -10), settings=Settings(t_end=1.0, step=0.1))
    >>> simulate(model).body("ball").velocity[-1].round(6).tolist()
    [0.0, 0.0, -10.0]
    """
    if settings is not None:
        model = replace(model, settings=settings)
    path = None if output is None else Path(output)
    if not resume:
        return _run(model, path, progress)
    if path is None:
        raise StateError("resume: expected the file of the results as output, got none")
    return _resume(model, path, progress, force or anyway)


def start(model: Model) -> Results:
    """The results of the start alone: one row, at t = 0.

    Parameters
    ----------
    model : Model

    Returns
    -------
    Results

    Raises
    ------
    ModelError
        As `simulate`.

    Examples
    --------
    >>> from duhamel.solver import Model, RigidBody, Settings
    >>> ball = RigidBody(1.0, [0.1, 0.1, 0.1])
    >>> start(Model({"ball": ball}, settings=Settings(t_end=1.0, step=0.1))).time.tolist()
    [0.0]
    """
    return _run(model, None, progress=False, steps=0)


def _run(model: Model, output: Path | None, progress: bool, steps: int | None = None) -> Results:
    if output is not None:
        check_output(output, model)
    with about(model.path), one_blas_thread():
        lowered, source = lower_to_start(model)
        # Compilation takes many seconds: all that can be refused is refused before.
        check_request(lowered)
        initial = initialize(model, lowered, source)
        restartable = output is not None and model.settings.checkpoint is not None
        initial, exchange = start_beside(initial, lowered, source, restartable=restartable)
    with exchange:
        return _run_from(initial, exchange, output, progress, steps)


def _run_from(
    initial: InitialState,
    exchange: Exchange,
    output: Path | None,
    progress: bool,
    steps: int | None,
) -> Results:
    with about(initial.lowered.model.path), one_blas_thread():
        total = initial.lowered.n_steps if steps is None else steps
        check_range(initial.lowered, initial.state, 0)
        # The stack level is that of the caller of `simulate`.
        _warn(start_warnings(initial), stacklevel=5)
        monitor = ValidityMonitor(initial.lowered)
        writer = make_writer(output, initial, total, monitor)
        # A state beside the new file would be taken for that of the new run.
        forget_checkpoint(writer)
    prepared = PreparedRun(
        *(initial.lowered, initial.state, initial.work, initial.removed),
        *(exchange, monitor, writer, total),
    )
    return _finish(prepared, progress)


def _resume(model: Model, output: Path, progress: bool, force: bool) -> Results:
    """Go on with a run from the state that it kept."""
    check_output(output, model)
    kept = read_checkpoint(output)
    identity, step = kept.identity, kept.snapshot.step
    with about(model.path), one_blas_thread():
        if not force:
            identity.check_model(model)
        lowered = lower(model, frozenset(kept.without), identity.horizon)
        if not force:
            identity.check_system(lowered)
        recorded = (
            step % recorded_every(kept.snapshot, lowered) == 0 or step == identity.horizon.steps
        )
        # At the very time of the state there is nothing to do, unless its row has been recorded as
        # the last.
        if lowered.n_steps < step or (lowered.n_steps == step and not recorded):
            of_state = f"the time of the state, {step * lowered.h:.9g} s"
            least = f"{of_state}, or more" if recorded else f"more than {of_state}"
            raise ModelError(f"simulation: t_end: expected {least}, got {model.settings.t_end:.9g}")
        state, work = allocate(lowered)
        own, beside = kept.snapshot.split(FMUS_PREFIX)
        own.put_back(carried(state=state, work=work))
        # Rows that were left out are checked in the model that has all of them.
        removed = RemovedRows(lower(model) if kept.without else lowered, sorted(kept.without))
        exchange = Exchange(lowered, restartable=model.settings.checkpoint is not None)
    with exchange:
        with about(model.path), one_blas_thread():
            exchange.bind(state, work)
            exchange.resume(beside)
            monitor = ValidityMonitor(lowered)
            writer = resume_writer(output, lowered, kept, monitor)
        prepared = PreparedRun(
            *(lowered, state, work, removed, exchange, monitor, writer, lowered.n_steps, True),
            *start_of(kept),
        )
        return _finish(prepared, progress)


def start_warnings(initial: InitialState) -> Iterator[str]:
    """Lines about a model at its start: how it begins, what looks wrong, what steps miss of it."""
    yield from initial.warnings
    yield from severe_warnings(initial.lowered.model)
    yield from signal_warnings(initial.lowered)


@dataclass(frozen=True, eq=False)
class PreparedRun:
    """A run that is ready to be integrated up to a step, from its start, or `resumed`.

    first, start: the step and the energies at the start of a run that is resumed.
    """

    lowered: LoweredModel
    state: State
    work: Workspace
    removed: RemovedRows
    exchange: Exchange
    monitor: ValidityMonitor
    writer: Writer
    total: int
    resumed: bool = False
    first: int = 0
    start: Energies = NO_ENERGIES

    def keeper(self) -> "FileKeeper | nullcontext[NoKeeper]":
        writer = self.writer
        if self.lowered.model.settings.checkpoint is None or not isinstance(writer, FileWriter):
            return nullcontext(NoKeeper())
        live = carried(state=self.state, work=self.work)
        return FileKeeper(writer, self.lowered, live, self.begin(), self._beside)

    def _beside(self) -> Arrays:
        """What FMUs carry on, by the names of a state."""
        return with_prefix(FMUS_PREFIX, self.exchange.saved())

    def begin(self) -> int:
        """The step at which it starts, before it has taken any."""
        return self.first if self.resumed else int(self.state.step[0])


def _finish(prepared: PreparedRun, progress: bool) -> Results:
    writer, started = prepared.writer, time.perf_counter()
    try:
        waited = integrate(prepared, progress)
        taken = int(prepared.state.taken[0])
        seconds = time.perf_counter() - started - waited
        writer.note(finished=True, seconds=seconds, steps=taken)
        settle_checkpoint(writer)
        writer.finish()
    except (ConvergenceError, MissedContactError, ModelError, OutOfRangeError) as error:
        # Where the rows before the failure are, is known here alone.
        error.args = (f"{error}{writer.where()}",)
        raise
    except KeyboardInterrupt as interrupt:
        raise KeyboardInterrupt(f"interrupted {_left(prepared)}") from interrupt
    finally:
        writer.leave()
    results = read_back(writer, prepared.lowered.model)
    _warn([*prepared.exchange.warnings(), *results.validity.brief()], stacklevel=6)
    return results


def _left(prepared: PreparedRun) -> str:
    """Where a run stopped before its end, and what is left of it."""
    lowered, writer = prepared.lowered, prepared.writer
    t, t_end = int(prepared.state.step[0]) * lowered.h, lowered.model.settings.t_end
    stopped = f"at t = {t:.6g} s of {t_end:.6g} s"
    if not isinstance(writer, FileWriter) or not writer.place.exists():
        return f"{stopped}; nothing is kept"
    rows = writer.where() or f"; its {writer.committed.rows} rows are in {writer.place}"
    state = checkpoint_of(writer.place)
    if state.exists():
        return f"{stopped}{rows}, and its last state beside them: --continue goes on from that"
    return f"{stopped}{rows}; without [simulation] checkpoint it cannot go on from there"


def _warn(lines: Iterable[str], stacklevel: int) -> None:
    for line in lines:
        warn(line, ValidityWarning, stacklevel=stacklevel)


def integrate(prepared: PreparedRun, progress: bool = False) -> float:
    """Take the steps of a run that are left, with the rows that it records.

    Returns the seconds for which the run was held (`RunControl`).
    """
    exchange, state, work, total = prepared.exchange, prepared.state, prepared.work, prepared.total
    lowered = exchange.lowered
    # A batch begins small, and grows until the loop runs for BATCH_SECONDS.
    begin, done, batch = prepared.begin(), int(state.step[0]), 16 * lowered.ratio
    writer = prepared.writer
    branches, monitor = Branches(lowered), prepared.monitor
    control, waited = RUN_CONTROL.get() or RunControl(), 0.0
    convolution = DyadicConvolution(lowered.system.elastic)
    with (
        prepared.keeper() as keeper,
        Recorder(writer, lowered, state, work, prepared.start) as recorder,
        _validity_written_at_end(prepared, begin),
        Progress(Work("simulating", total), shown=progress) as shown,
    ):
        phases = Phases(lowered, state, work, recorder.output)
        if not prepared.resumed:
            run = Run(system=lowered.system, state=state, work=work, output=recorder.output)
            record(run, 0)
            exchange.keep(recorder.output, np.zeros(1, dtype=np.int64), np.array([done]))
            recorder.keep_start(done)
        shown.advance(done, free=True)
        keeper.step_taken(done, recorder)
        # A file has checks from its first rows on; results in memory are read at the end alone.
        checked = -inf
        control.place = writer.place if isinstance(writer, FileWriter) else None
        while done < total:
            waited += control.obey(recorder.flush)
            started = time.perf_counter()
            n = keeper.steps_until_due(done, min(branches.most_steps(batch), total - done))
            stride, n = phases.begin(convolution.steps_until_due(done, n))
            steps = done + stride * np.arange(1, n + 1)
            rows = recorder.rows(steps, stride)
            inputs = signals(lowered, steps[0], rows, stride)
            taken, residual, failed = exchange.advance(phases, inputs, stride, recorder.output)
            check_passages(lowered, state, work, done + stride * taken)
            check_resolution(lowered, state, done + stride * taken)
            # The loop returns early when its list of events is full: no failure.
            full = is_full(state.contacts)  # of events, which the recorder takes
            # Checks read extremes of all bodies: not in every batch.
            if time.perf_counter() - checked > writer.pause:
                writer.check(monitor.values(state, done + stride * taken - begin))
                checked = time.perf_counter()
            recorder.keep(steps[:taken], rows[:taken], stride)
            done += stride * taken
            shown.advance(stride * taken)
            # In this order: a body out of range is a better cause of a failure than the residual.
            check_range(lowered, state, done)
            branches.check(work, done)
            if failed and not full:
                cause = monitor.cause(state, done - begin)
                raise failure(lowered, state, work, done + 1, residual, cause)
            prepared.removed.check(work, done * lowered.h)
            # After all checks: a state that is taken back must not have convolved its loads.
            convolution.update(state)
            keeper.step_taken(done, recorder)
            # Each batch costs Python as much as some steps, so that few are to be short.
            taken_seconds = time.perf_counter() - started
            if taken_seconds < 0.5 * BATCH_SECONDS:
                batch *= 16 if taken_seconds < BATCH_SECONDS / 32 else 2
    return waited


@contextmanager
def _validity_written_at_end(prepared: PreparedRun, begin: int) -> Iterator[None]:
    """The validity of a run is written when it ends, in whatever way."""
    try:
        yield
    finally:
        taken = int(prepared.state.step[0]) - begin
        prepared.writer.check(prepared.monitor.values(prepared.state, taken))


def signals(lowered: LoweredModel, first: int, rows: Index, stride: int = 1) -> Inputs:
    """Loads, drives and motors at steps from the first on, a stride apart, which the loop records
    in the rows.
    """
    n = len(rows)
    t = lowered.h * np.arange(first, first + stride * n, stride, dtype=np.float64)
    load = [nan_if_overflowing(signal.samples(t, lowered.h)) for signal in lowered.load_signals]
    drive = [values_of(signal, t) for signal in lowered.drives]
    motor = [nan_if_overflowing(signal.samples(t, lowered.h)) for signal in lowered.motor_signals]
    return Inputs(
        load=_columns(load, n),
        drive=_columns(drive, n),
        motor=_columns(motor, n),
        row=rows,
        ahead=0,
    )


def _columns(samples: list[Array], n: int) -> Array:
    return np.array(samples).reshape(len(samples), n).T.copy()


def nan_if_overflowing(samples: Array) -> Array:
    """Samples in which what would overflow is no number, which stops the step that meets it."""
    return np.where(np.abs(samples) <= LARGEST_NUMBER, samples, np.nan)


def failure(
    lowered: LoweredModel, state: State, work: Workspace, step: int, residual: float, cause: str
) -> ConvergenceError:
    """The error of a step in which Newton's method failed; cause: where one is known already."""
    # before the next puts the state back
    # Before `likely_cause`, which puts the state back to the last good step.
    worst, far = _worst_joint(lowered, work), interface_out_of_range(lowered, state)
    cause = cause or likely_cause(lowered, state, work, step * lowered.h) or far
    return ConvergenceError(
        step,
        step * lowered.h,
        residual,
        lowered.model.settings.tolerance,
        worst,
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
