"""`duhamel report`: a page of HTML from results."""

from pathlib import Path
from time import perf_counter
from typing import Annotated

import typer

from ..arguments import ResultsFile, Title, beside, output_option
from ..failures import errors_in_one_line, one_line
from ..progress import shown_parts

Page = Annotated[Path | None, output_option("FILE.html")]
Field = Annotated[
    str,
    typer.Option(
        metavar="von_mises|displacement|velocity|pressure",
        help="The colors of the animation: the first of them that is known, unless given.",
        show_default=False,
    ),
]


def report(
    results_file: ResultsFile, output: Page = None, title: Title = None, field: Field = ""
) -> None:
    """Write a page about a run, for any browser: RESULTS.html beside the file, unless given.

    It holds all that it needs: the motion in space to turn and play, plots to zoom, validity,
    peaks, contacts, balances, bodies, statistics, the model, and where everything comes from.
    """
    start = perf_counter()
    from ... import view
    from ...results import RecoveryError, Results

    target = output or beside(results_file, ".html")
    if field not in ("", *view.REPORT_FIELDS):
        expected = ", ".join(view.REPORT_FIELDS)
        raise typer.BadParameter(f"--field: expected one of {expected}, found {field!r}")
    with errors_in_one_line(view):
        try:
            with shown_parts("parts") as on_part:
                view.write_report(Results.read(results_file), target, title or "", field, on_part)
        except RecoveryError as error:
            raise view.PictureError(str(error)) from error
    megabytes, seconds = target.stat().st_size / 1e6, perf_counter() - start
    typer.echo(one_line(f"{target}: {megabytes:.1f} MB, {seconds:.1f} s"))
