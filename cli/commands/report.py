"""`duhamel report`: a page of HTML from results."""

from pathlib import Path
from time import perf_counter
from typing import Annotated

import typer

from ..arguments import ResultsFile
from ..failures import errors_in_one_line, one_line
from .animate import shown

Page = Annotated[
    Path | None, typer.Option("--output", "-o", metavar="FILE.html", show_default=False)
]
Title = Annotated[str, typer.Option(metavar="TEXT", help="The name of the results, unless given.")]
Field = Annotated[
    str,
    typer.Option(
        metavar="von_mises|displacement|velocity",
        help="The colors of the animation: the first of them that is known, unless given.",
        show_default=False,
    ),
]


def report(
    results_file: ResultsFile, output: Page = None, title: Title = "", field: Field = ""
) -> None:
    """Write a page about a run, for any browser: RESULTS.html beside the file, unless given.

    It holds all that it needs: the motion in space to turn and play, plots to zoom, validity,
    peaks, contacts, balances, bodies, statistics, the model, and where everything comes from.
    """
    start = perf_counter()
    from ... import view
    from ...results import RecoveryError, Results

    target = output or results_file.with_suffix(".html")
    if field not in ("", *view.REPORT_FIELDS):
        expected = ", ".join(view.REPORT_FIELDS)
        raise typer.BadParameter(f"--field: expected one of {expected}, found {field!r}")
    with errors_in_one_line(view):
        try:
            with shown("parts") as on_part:
                view.write_report(Results.read(results_file), target, title, field, on_part)
        except RecoveryError as error:
            raise view.PictureError(str(error)) from error
    megabytes, seconds = target.stat().st_size / 1e6, perf_counter() - start
    typer.echo(one_line(f"{target}: {megabytes:.1f} MB, {seconds:.1f} s"))
