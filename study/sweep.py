"""Run the open cases of a study, and write its summary."""

from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from dataclasses import replace

from ..files.outputs import in_words
from ..results import SeriesError
from .case import Case
from .errors import StudyError
from .processes import on_processes
from .study_file import Study, check_outputs
from .summary import Row, write_summary, write_units
from .workers import Report, in_process, on_cluster

OnBegin = Callable[[int, int], None]
"""called before any case runs with how many will, and about how many bytes they write; 0 if that
is not known
"""
OnFinished = Callable[[Row], None]
"""called with a case when it is finished, or is up to date"""


def sweep(
    study: Study,
    workers: int | None = None,
    scheduler: str | None = None,
    force: bool = False,
    on_finished: OnFinished = lambda row: None,
    on_begin: OnBegin = lambda cases, size: None,
) -> tuple[Row, ...]:
    """Run the cases of a study that are missing or out of date, and write FOLDER/summary.csv.

    Parameters
    ----------
    study : Study
    workers : int, optional
        Processes on this machine, one for each core by default; 0 runs all in this process.
    scheduler : str, optional
        The address of a Dask scheduler, whose workers see the folder under the same path.
    force : bool
        Run all cases.
    on_finished : callable
        Called with the `Row` of each case that is finished, or up to date.
    on_begin : callable
        Called before any case runs, with how many will run and about how many bytes they write,
        0 if that is not known.

    Returns
    -------
    tuple of Row
        Of all cases, in their order; those that failed have a message.

    Raises
    ------
    StudyError
        For faults of the study that show before any case runs.
    ClusterError
        Where Dask is not installed, or its scheduler cannot be reached.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from duhamel.study import read_study, read_summary
    >>> model = '''
    ... [bodies.ball]
    ... mass = 1.0
    ... inertia = [0.1, 0.1, 0.1]
    ... [simulation]
    ... t_end = 0.1
    ... step = 0.01
    ... '''
    >>> study = '''
    ... model = "ball.toml"
    ... parameters."bodies.ball.mass" = [1.0, 2.0]
    ... outputs.height = "max position:ball:z"
    ... '''
    >>> with TemporaryDirectory() as name:
    ...     folder = Path(name)
    ...     written = (folder / "ball.toml").write_text(model)
    ...     written = (folder / "masses.toml").write_text(study)
    ...     rows = sweep(read_study(folder / "masses.toml"), workers=0)
    ...     summary = read_summary(folder / "masses" / "summary.csv")
    >>> [row.status for row in rows], summary.parameters["bodies.ball.mass"]
    (['done', 'done'], [1.0, 2.0])
    """
    check_outputs(study)
    made = set() if force else {case.name for case in study.cases if study.kind.is_made(case)}
    todo = [case for case in study.cases if case.name not in made]
    if todo:
        _check(study)
        on_begin(len(todo), len(todo) * study.kind.size(study.base))
        _write_sources(study)
    # In the order of the study, whatever the order in which workers finish.
    rows = {case.name: Row(case) for case in study.cases}

    def finish(case: Case, report: Report) -> None:
        row = replace(_row(study, case, report), reused=case.name in made)
        rows[case.name] = row
        on_finished(row)

    try:
        for case in study.cases:
            if case.name in made:
                finish(case, Report())
        # Closed at once on errors and Ctrl-C, so that no worker goes on.
        with closing(_reports(study, todo, workers, scheduler)) as reports:
            for case, report in reports:
                finish(case, report)
    finally:
        # Also of a study that was stopped: what is done need not be run again.
        write_summary(study.summary, study, list(rows.values()))
        write_units(study, list(rows.values()))
    return tuple(rows.values())


def _row(study: Study, case: Case, report: Report) -> Row:
    if report.failure:
        return Row(case, "failed", message=report.failure, warnings=report.warnings)
    try:
        numbers = study.kind.numbers(case, study.outputs)
    except SeriesError as error:
        return Row(case, "failed", message=str(error), warnings=report.warnings)
    return Row(case, "done", numbers, warnings=report.warnings)


def _reports(
    study: Study, todo: Sequence[Case], workers: int | None, scheduler: str | None
) -> Generator[tuple[Case, Report], None, None]:
    if not todo:
        return
    if workers == 0:
        yield from in_process(study.kind, todo)
    elif scheduler is None:
        yield from on_processes(study.kind, todo, workers)
    else:
        yield from on_cluster(study.kind, todo, scheduler)


def _check(study: Study) -> None:
    try:
        study.kind.check(study.base, study.outputs)
    except study.kind.failures as error:
        raise StudyError(f"{study.path}: the base file does not run by itself: {error}") from error
    except StudyError as error:
        raise StudyError(f"{study.path}: {error}") from error


def _write_sources(study: Study) -> None:
    try:
        study.folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StudyError(f"{study.folder}: cannot be written: {in_words(error)}") from error
    for case in study.cases:
        try:
            case.source.write_text(case.text, encoding="utf-8")
        except (OSError, UnicodeEncodeError) as error:
            # No half-written case stays behind.
            case.source.unlink(missing_ok=True)
            raise StudyError(f"{case.source}: cannot be written: {in_words(error)}") from error
