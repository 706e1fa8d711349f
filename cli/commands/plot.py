"""`duhamel plot`: results over time, over frequency, against one another, and fields."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..arguments import (
    RESULTS_SUFFIXES,
    FromTime,
    Gravities,
    Title,
    ToTime,
    beside,
    output_option,
    size_of,
    time_or_worst,
)
from ..completion import files as completed
from ..failures import errors_in_one_line, one_line

if TYPE_CHECKING:
    from ...results.transforms import Window
    from ...view import Curve, Run

SUMMARY_SUFFIX = ".csv"
# Other arguments are quantities.
FILE_SUFFIXES = (*RESULTS_SUFFIXES, SUMMARY_SUFFIX)
# That of a measured curve unless another is named: the first holds times.
SECOND_COLUMN = 2

Arguments = Annotated[
    list[str],
    typer.Argument(
        metavar="FILE... [QUANTITY[,QUANTITY]]...",
        help="RESULTS.h5 of `duhamel run`, several in one picture, or summary.csv of `sweep`; then "
        "a panel each, as angular_velocity:hub:z, 'acceleration:*:z', 'srs(acceleration:hub:z, "
        "q=10)', or 'position:tip:y against position:tip:x'.",
        autocompletion=completed(*FILE_SUFFIXES),
    ),
]
Picture = Annotated[Path | None, output_option("FILE.png|svg|pdf")]
Names = Annotated[
    str | None, typer.Option(metavar="NAME,NAME", help="Of several files, in the legend.")
]
Size = Annotated[
    str | None, typer.Option(metavar="WIDTHxHEIGHT", help="Of the picture in inches, as 8x5.")
]
Fields = Annotated[
    list[str] | None,
    typer.Option(
        "--field",
        metavar="FIELD:BODY",
        help="A picture of bodies instead: von_mises:rod, displacement:rod or velocity:rod; of "
        "several ones, or 'von_mises:*'.",
    ),
]
Overlays = Annotated[
    list[str] | None,
    typer.Option(
        "--overlay",
        metavar="FILE.csv[:COLUMN]",
        help="A measured curve: a column by name or number, the second unless given, over the "
        "first, in the units of the panel. Several: all in one panel, or one for each panel.",
    ),
]
At = Annotated[
    str | None,
    typer.Option(metavar="SECONDS|worst", help="The time of a field: worst, unless given."),
]


def plot(
    arguments: Arguments,
    output: Picture = None,
    title: Title = None,
    gravities: Gravities = False,
    start: FromTime = None,
    end: ToTime = None,
    names: Names = None,
    size: Size = None,
    field: Fields = None,
    at: At = None,
    overlay: Overlays = None,
) -> None:
    """Draw results over time: RESULTS.png beside the results file, unless given.

    Of a study, summary.csv, draw the outputs, or those that are named, over its parameters.

    Each further argument is a panel: a quantity, or several joined by commas; a star in a name
    stands for anything. Spectra are of the times that --from and --to leave. Without quantities:
    what moved, what pushed, the energies and their balance. A
    quantity that does not exist lists those that do. What is made of quantities, in quotes:
    srs(QUANTITY), fourier, psd, cumulative_rms, octaves, cfc, lowpass, highpass, bandpass, g.
    Several files are drawn in one picture.

    With --field the surfaces of bodies at a time, colored by stress, displacement or velocity.
    """
    files, quantities = _sorted(arguments)
    if any(file.suffix.lower() == SUMMARY_SUFFIX for file in files):
        if len(files) > 1:
            raise typer.BadParameter("the summary of a study is drawn alone, without other files")
        plot_summary(files[0], quantities, output, title)
        return
    from ... import files as outputs
    from ... import results, view

    window = _window(start, end)
    inches = size_of(size, float, 1.0, 100.0, "inches, as 8x5")
    if at is not None and not field:
        raise typer.BadParameter("--at goes with --field")
    time = time_or_worst(at)
    if field and (quantities or len(files) > 1 or inches is not None):
        raise typer.BadParameter("--field: expected one file, no quantities and no --size")
    _check_overlays(overlay, quantities)
    what = "field" if field else "compared" if len(files) > 1 else ""
    target = output or beside(files[0], ".png", what)
    with errors_in_one_line(outputs, results, view):
        runs = view.runs_of(files, names.split(",") if names else ())
        outputs.require_no_input(target, files, "the results file", "picture")
        heading = title if title is not None else files[0].stem if len(files) == 1 else ""
        if field:
            of_bodies = [part for text in field for part in text.split(",")]
            figure = view.draw_body_fields(runs[0].results, of_bodies, time, window, heading)
        else:
            panels = _panels(runs, quantities, gravities, window)
            if overlay:
                panels = _with_overlays(panels, overlay, window)
            figure = view.draw(runs[0].results.time, panels, heading)
        if inches is not None:
            figure.set_size_inches(*inches)
        view.save(figure, target)
    typer.echo(one_line(target))


def _sorted(arguments: Sequence[str]) -> tuple[list[Path], list[str]]:
    """The files among the arguments, of which the first is one, and the quantities."""
    files, quantities = [Path(arguments[0])], []
    for text in arguments[1:]:
        path = Path(text)
        # A results file may have any suffix, but every quantity with a name has a colon.
        if path.suffix.lower() in FILE_SUFFIXES or (":" not in text and _is_file(path)):
            files.append(path)
        else:
            quantities.append(text)
    return list(dict.fromkeys(files)), quantities


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def _panels(
    runs: "Sequence[Run]", quantities: Sequence[str], gravities: bool, window: "Window | None"
) -> "list[list[Curve]]":
    from ... import view

    if quantities:
        return [view.panel(runs, text, gravities, window) for text in quantities]
    if len(runs) == 1 and window is None and not gravities:
        return view.overview(runs[0].results)
    # Of several runs the first one chooses, so that all are compared in the same quantities.
    shown = view.overview_quantities(runs[0].results)
    return [view.panel(runs, ",".join(panel), gravities, window) for panel in shown]


def _check_overlays(overlay: Sequence[str] | None, quantities: Sequence[str]) -> None:
    if overlay and not quantities:
        raise typer.BadParameter("--overlay: expected quantities, beside which it is drawn")
    if overlay and len(quantities) > 1 and len(overlay) != len(quantities):
        raise typer.BadParameter(
            f"--overlay: expected one panel, or one for each of {len(quantities)} panels, found "
            f"{len(overlay)}"
        )


def _with_overlays(
    panels: "Sequence[list[Curve]]", overlays: Sequence[str], window: "Window | None"
) -> "list[list[Curve]]":
    """The panels with measured curves: all in the only panel, or one in each."""
    from ... import solver, view

    drawn = list(panels)
    with errors_in_one_line(solver):
        for n, text in enumerate(overlays):
            # A file whose own name has a colon is taken as it is.
            path, _, column = text.partition(":") if not _is_file(Path(text)) else (text, "", "")
            chosen = int(column) if column.isdigit() else column or SECOND_COLUMN
            times, values = solver.Recorded(path, chosen).points
            name = f"{Path(path).name}, {column}" if column else Path(path).name
            at = n if len(drawn) > 1 else 0
            drawn[at] = view.overlaid(drawn[at], name, times, values, window)
    return drawn


def _window(start: float | None, end: float | None) -> "Window | None":
    if start is None and end is None:
        return None
    window = -float("inf") if start is None else start, float("inf") if end is None else end
    if not window[0] < window[1]:
        raise typer.BadParameter(f"expected --from below --to, found {start} and {end}")
    return window


def plot_summary(
    summary: Path, names: Sequence[str], output: Path | None, title: str | None
) -> None:
    """Draw the summary of a study: SUMMARY.png beside it, unless given."""
    from ... import files, study, view
    from ..variation import draw

    target = output or beside(summary, ".png")
    with errors_in_one_line(files, study, view):
        files.require_no_input(target, [summary], "the summary", "picture")
        draw(summary, [name for text in names for name in text.split(",")], target, title)
    typer.echo(one_line(target))
