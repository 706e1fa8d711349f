"""Many runs at once, on threads: while one takes its steps, Python serves the others."""

import warnings
from collections.abc import Iterable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from contextlib import nullcontext
from threading import Lock
from typing import Literal, NamedTuple, overload

from ..files.cores import usable_cores
from ..files.kept_warnings import kept_warnings
from ..results.results import Results
from .control import RUN_CONTROL, SECONDS_PER_LOOK, RunControl
from .model.model import Model
from .simulation import simulate

MOST_NAMED = 5
"""runs that the message of a failure names"""

# Libraries of FMUs need not bear several threads.
_fmus = Lock()


class _Outcome(NamedTuple):
    """What a run gave, and the warnings that belong to it."""

    found: Results | Exception
    warnings: Sequence[Warning]


@overload
def simulate_many(
    models: Iterable[Model], *, workers: int | None = None, failures: Literal["raise"] = "raise"
) -> list[Results]: ...


@overload
def simulate_many(
    models: Iterable[Model], *, workers: int | None = None, failures: Literal["keep"]
) -> list[Results | Exception]: ...


def simulate_many(
    models: Iterable[Model],
    *,
    workers: int | None = None,
    failures: Literal["raise", "keep"] = "raise",
) -> list[Results] | list[Results | Exception]:
    """Integrate the motions of many models in memory, several at once.

    The results are to the bit those of `simulate`. Each run has one thread; the threads take their
    steps side by side, and prepare their runs one after the other. A run that fails stops no other.
    Runs of models with FMUs wait for one another.

    Parameters
    ----------
    models : iterable of Model
    workers : int, optional
        The number of threads, by default one for each core.
    failures : "raise" or "keep"
        What becomes of runs that fail: an exception once all have ended, or the exception of each
        in place of its results.

    Returns
    -------
    list of Results
        In the order of the models.

    Raises
    ------
    ExceptionGroup
        For runs that failed, with what `simulate` raises for each; a note names the run.
    ValueError
        For a number of workers below 1.

    Warns
    -----
    ValidityWarning
        As `simulate`, once all runs have ended, in their order; each names its run.

    Examples
    --------
    >>> from duhamel.solver import Model, RigidBody, Settings
    >>> ball, settings = RigidBody(1.0, [0.1, 0.1, 0.1]), Settings(t_end=1.0, step=0.1)
    >>> models = [Model({"ball": ball}, gravity=(0, 0, -g), settings=settings) for g in (5, 10)]
    >>> [run.body("ball").velocity[-1, 2].round(6).item() for run in simulate_many(models)]
    [-5.0, -10.0]
    """
    if workers is None:
        workers = usable_cores()
    if workers < 1:
        raise ValueError(f"workers: expected 1 or more, got {workers}")
    if failures not in ("raise", "keep"):
        raise ValueError(f"failures: expected 'raise' or 'keep', got {failures!r}")
    given = list(models)
    outcomes = _outcomes(given, workers)
    names = [_name(i, len(given), model) for i, model in enumerate(given, start=1)]
    for name, outcome in zip(names, outcomes, strict=True):
        for warning in outcome.warnings:
            warnings.warn(f"{name}: {warning}", type(warning), stacklevel=2)
        if isinstance(outcome.found, Exception):
            outcome.found.add_note(f"in {name}")
    found = [outcome.found for outcome in outcomes]
    if failures == "keep":
        return found
    return _all_results(names, found)


def _all_results(names: Sequence[str], found: Sequence[Results | Exception]) -> list[Results]:
    """The results of all runs; an `ExceptionGroup` of those that failed."""
    failed = {n: one for n, one in zip(names, found, strict=True) if isinstance(one, Exception)}
    if failed:
        named = ", ".join(list(failed)[:MOST_NAMED])
        more = "" if len(failed) <= MOST_NAMED else f" and {len(failed) - MOST_NAMED} more"
        raise ExceptionGroup(f"runs failed: {named}{more}", list(failed.values()))
    return [one for one in found if isinstance(one, Results)]


def _name(number: int, n: int, model: Model) -> str:
    return f"run {number} of {n}" + (f" ({model.path})" if model.path else "")


def _outcomes(models: Sequence[Model], workers: int) -> list[_Outcome]:
    """The outcomes of all runs; none goes on after an interrupt."""
    control = RunControl()
    with ThreadPoolExecutor(workers, thread_name_prefix="simulate_many") as pool:
        runs: list[Future[_Outcome]] = [pool.submit(_run, model, control) for model in models]
        try:
            while wait(runs, SECONDS_PER_LOOK).not_done:
                pass
        except BaseException:
            control.stop()
            pool.shutdown(cancel_futures=True)
            raise
    return [run.result() for run in runs]


def _run(model: Model, control: RunControl) -> _Outcome:
    RUN_CONTROL.set(control)
    with kept_warnings() as kept, _fmus if model.fmus else nullcontext():
        try:
            return _Outcome(simulate(model), kept)
        except Exception as failure:
            return _Outcome(failure, kept)
