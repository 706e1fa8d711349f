"""`duhamel plot`: results over time, over frequency, against one another, and fields."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from ..arguments import Gravities, time_or_worst
from ..completion import files as completed
from ..failures import errors_in_one_line, one_line

if TYPE_CHECKING:
    from ...results.transforms import Window
    from ...view import Curve, Run

CSV = ".csv"
"""suffix of summaries of studies"""
FILES = (".h5", ".hdf5", ".nc", CSV)
"""suffixes of files; other arguments are quantities"""
SECOND_COLUMN = 2
"""that of a measured curve unless another is named"""
COMPARED = "compared"
"""behind the name of the first of several files, in that of their picture"""

Arguments = Annotated[
    list[str],
    typer.Argument(
        metavar="FILE... [QUANTITY[,QUANTITY]]...",
        help="RESULTS.h5 of `duhamel run`, several in one picture, or summary.csv of `sweep`; then "
        "a panel each, as angular_velocity:hub:z, 'acceleration:*:z', 'srs(acceleration:hub:z, "
        "q=10)', or 'position:tip:y against position:tip:x'.",
        show_default=False,
        autocompletion=completed(*FILES),
    ),
]
Picture = Annotated[
    Path | None,
    typer.Option("--output", "-o", metavar="FILE.png|svg|pdf", show_default=False),
]
Title = Annotated[
    str | None,
    typer.Option(metavar="TEXT", help="Above the picture: the name of the file, unless given."),
]
Start = Annotated[
    float | None,
    typer.Option("--from", metavar="SECONDS", help="From this time, spectra too."),
]
End = Annotated[
    float | None,
    typer.Option("--to", "--until", metavar="SECONDS", help="Up to this time, spectra too."),
]
Names = Annotated[
    str | None,
    typer.Option(metavar="NAME,NAME", help="Of several files, in the legend."),
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
    start: Start = None,
    end: End = None,
    names: Names = None,
    size: Size = None,
    field: Fields = None,
    at: At = None,
    overlay: Overlays = None,
) -> None:
    """Draw results over time: RESULTS.png beside the results file, unless given.

    Of a study, summary.csv, draw the outputs, or those that are named, over its parameters.

    Each further argument is a panel: a quantity, or several joined by commas; a star in a name
    stands for anything. Without them: what moved, what pushed, the energies and their balance. A
    quantity that does not exist lists those that do. What is made of quantities, in quotes:
    srs(QUANTITY), fourier, psd, cumulative_rms, octaves, cfc, lowpass, highpass, bandpass, g.
    Several files are drawn in one picture.

    With --field the surfaces of bodies at a time, colored by stress, displacement or velocity.
    """
    files, quantities = _sorted(arguments)
    if any(file.suffix.lower() == CSV for file in files):
        if len(files) > 1:
            raise typer.BadParameter("the summary of a study is drawn alone, without other files")
        plot_summary(files[0], quantities, output, title)
        return
    from ... import results, view
    from ...files.outputs import clash

    window, inches, time = _window(start, end), _inches(size), _time(at, field)
    if field and (quantities or len(files) > 1 or inches is not None):
        raise typer.BadParameter("--field: expected one file, no quantities and no --size")
    _check_overlays(overlay, quantities)
    with errors_in_one_line(results, view):
        runs = view.runs_of(files, names.split(",") if names else ())
        target = output or _target(files, "field" if field else COMPARED)
        if found := clash([target], dict.fromkeys(files, "the results file")):
            raise view.PictureError(f"{found}, which the picture would replace")
        heading = _heading(files) if title is None else title
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
        if path.suffix.lower() in FILES or (":" not in text and _is_file(path)):
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
            path, _, column = text.partition(":") if not _is_file(Path(text)) else (text, "", "")
            chosen = int(column) if column.isdigit() else column or SECOND_COLUMN
            times, values = solver.Recorded(path, chosen).points
            name = f"{Path(path).name}, {column}" if column else Path(path).name
            at = n if len(drawn) > 1 else 0
            drawn[at] = view.overlaid(drawn[at], name, times, values, window)
    return drawn


def _target(files: Sequence[Path], what: str) -> Path:
    """FILE.png beside the first file, FILE-WHAT.png where it is not the picture of one run."""
    first = files[0]
    if len(files) == 1 and what == COMPARED:
        return first.with_suffix(".png")
    return first.with_name(f"{first.stem}-{what}.png")


def _time(at: str | None, field: Sequence[str] | None) -> "float | Literal['worst']":
    """The time of a field [s], or "worst"."""
    if at is not None and not field:
        raise typer.BadParameter("--at goes with --field")
    return time_or_worst(at)


def _heading(files: Sequence[Path]) -> str:
    return files[0].stem if len(files) == 1 else ""


def _window(start: float | None, end: float | None) -> "Window | None":
    if start is None and end is None:
        return None
    window = -float("inf") if start is None else start, float("inf") if end is None else end
    if not window[0] < window[1]:
        raise typer.BadParameter(f"expected --from below --to, found {start} and {end}")
    return window


def _inches(size: str | None) -> tuple[float, float] | None:
    if size is None:
        return None
    try:
        width, height = (float(part) for part in size.lower().split("x"))
    except ValueError:
        width = height = 0.0
    if not (1.0 <= width <= 100.0 and 1.0 <= height <= 100.0):
        raise typer.BadParameter(
            f"--size: expected WIDTHxHEIGHT from 1 to 100 inches, as 8x5, found {size!r}"
        )
    return width, height


def plot_summary(
    summary: Path, names: Sequence[str], output: Path | None, title: str | None
) -> None:
    """Draw the summary of a study: SUMMARY.png beside it, unless given."""
    from ... import study, view
    from ...files.outputs import clash
    from ..variation import draw

    target = output or summary.with_suffix(".png")
    with errors_in_one_line(study, view):
        if found := clash([target], {summary: "the summary"}):
            raise view.PictureError(f"{found}, which the picture would replace")
        draw(summary, [name for text in names for name in text.split(",")], target, title)
    typer.echo(one_line(target))
