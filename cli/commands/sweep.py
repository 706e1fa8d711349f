"""`duhamel sweep`."""

from pathlib import Path
from time import perf_counter
from typing import Annotated

import typer

from ..arguments import TOML_SUFFIX, file_argument, output_option
from ..failures import errors_in_one_line, one_line
from .plot import plot_summary

StudyFile = Annotated[
    Path, file_argument("STUDY.toml", "A model or body, and values of its parameters.", TOML_SUFFIX)
]
StudyFolder = Annotated[
    Path | None, output_option("FOLDER", "The cases: STUDY beside the study file.")
]
Workers = Annotated[
    int | None,
    typer.Option(
        min=0,
        help="Processes on this machine, as many as cores unless given; 0: none but this one.",
    ),
]
Scheduler = Annotated[
    str | None,
    typer.Option(metavar="tcp://HOST:PORT", help="Of a Dask cluster that sees the same files."),
]
Plotted = Annotated[
    bool, typer.Option("--plot", help="Also draw the outputs over the parameters: summary.png.")
]
Force = Annotated[bool, typer.Option("--force", help="Also the cases that are up to date.")]


def sweep(
    study_file: StudyFile,
    output: StudyFolder = None,
    workers: Workers = None,
    scheduler: Scheduler = None,
    force: Force = False,
    plot: Plotted = False,
) -> None:
    """Run a model, or preprocess a body, for many values of its parameters.

    Each case is a file of its own, with what was made of it beside it; summary.csv has a row for
    each. A second call makes only what is missing, failed, or was made from other inputs.
    """
    if scheduler is not None and workers is not None:
        raise typer.BadParameter(
            "a scheduler brings its own workers: expected one of --workers and --scheduler"
        )
    start = perf_counter()
    from ... import study
    from ..sweep import failures, shown_cases, tell_size, told

    with errors_in_one_line(study):
        plan = study.read_study(study_file, output)
    with errors_in_one_line(study), shown_cases(len(plan.cases)) as finished:
        rows = study.sweep(plan, workers, scheduler, force, finished, tell_size(plan.folder))
    failed = list(failures(rows))
    for line in failed:
        typer.echo(one_line(line), err=True)
    seconds = perf_counter() - start
    typer.echo(one_line(f"{plan.summary}: {len(rows)} cases, {told(rows)}, {seconds:.1f} s"))
    if plot:
        plot_summary(plan.summary, [], None, None)
    # Last, for the cases that did not fail are told and drawn all the same.
    if failed:
        raise typer.Exit(1)
