"""`duhamel export`: results for ParaView, for tables, for MATLAB, loads for Abaqus and Nastran."""

from enum import StrEnum
from math import isfinite
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from ..arguments import ResultsFile, time_or_worst
from ..failures import errors_in_one_line, one_line

if TYPE_CHECKING:
    from ...results import Results

MOST = 200
"""frames of a film unless more are asked for"""


class Format(StrEnum):
    VTK = "vtk"
    CSV = "csv"
    MAT = "mat"
    ABAQUS = "abaqus"
    NASTRAN = "nastran"


SUFFIXES = {
    Format.VTK: ".vtkhdf",
    Format.CSV: ".csv",
    Format.MAT: ".mat",
    Format.ABAQUS: ".inp",
    Format.NASTRAN: ".bdf",
}
"""of files that are written"""

Folder = Annotated[
    Path, typer.Argument(metavar="DIR", help="Made if it is not there.", show_default=False)
]
Quantities = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="QUANTITY",
        help="For csv, as velocity:hub:x or 'force:*'; all that was recorded unless given.",
        show_default=False,
    ),
]
To = Annotated[
    Format,
    typer.Option("--to", help="ParaView, tables, MATLAB, or loads for Abaqus or Nastran."),
]
At = Annotated[
    str | None,
    typer.Option(
        "--at",
        metavar="SECONDS",
        help="The instant of loads, or worst, that of the largest load.",
        show_default=False,
    ),
]
BodyNames = Annotated[
    list[str] | None,
    typer.Option("--body", metavar="NAME", help="For loads; all flexible bodies unless given."),
]
Start = Annotated[float | None, typer.Option("--from", metavar="SECONDS", help="From this time.")]
End = Annotated[float | None, typer.Option("--until", metavar="SECONDS", help="Up to this time.")]
Frames = Annotated[
    int | None,
    typer.Option(min=1, help=f"Steps for vtk, evenly over time: {MOST} unless given."),
]
All = Annotated[bool, typer.Option("--all", help="Every recorded step for vtk.")]
Magnified = Annotated[
    float | None,
    typer.Option("--magnify", metavar="NUMBER", help="Elastic displacements for vtk, times this."),
]


def export(
    results_file: ResultsFile,
    folder: Folder,
    quantities: Quantities = None,
    to: To = Format.VTK,
    start: Start = None,
    end: End = None,
    frames: Frames = None,
    every: All = False,
    magnify: Magnified = None,
    at: At = None,
    bodies: BodyNames = None,
) -> None:
    """Write results for other programs into a folder.

    vtk: bodies as they move and deform, frames and contacts with their forces, for ParaView
    (VTKHDF). csv: tables, of all that was recorded or of the quantities that are named. mat: all
    that was recorded, for MATLAB. abaqus, nastran: forces and moments on flexible bodies at an
    instant with the inertia that balances them, as decks for static analyses.
    """
    _require_sense(to, quantities, frames, every, magnify)
    when = _instant(to, at, bodies, start, end)
    begin = perf_counter()
    from ... import files, results
    from ...files.progress import Progress, Work
    from ...results.steps import window

    with errors_in_one_line(results, files), Progress(Work("writing")):
        read = results.Results.read(results_file)
        for path in folder.glob(f"*{SUFFIXES[to]}"):
            files.require_no_input(path, [results_file])
        rows = window(read.time, start, end)
        stem = results_file.stem
        if to is Format.VTK:
            written = _write_vtk(read, folder, stem, rows, frames, every, magnify)
        elif to is Format.CSV:
            written = results.write_csv(read, folder, quantities or (), rows)
        elif to is Format.ABAQUS or to is Format.NASTRAN:
            program: Literal["abaqus", "nastran"] = "abaqus" if to is Format.ABAQUS else "nastran"
            written = results.write_loads(read, folder, stem, program, bodies or (), when)
        else:
            written = (results.write_mat(read, folder / f"{stem}.mat", rows),)
    for path in written:
        typer.echo(one_line(f"{path}: {path.stat().st_size / 1e6:.3g} MB"))
    typer.echo(one_line(f"{len(written)} files, {perf_counter() - begin:.1f} s"))


def _require_sense(
    to: Format, quantities: list[str] | None, frames: int | None, every: bool, magnify: float | None
) -> None:
    """Refuse what would be passed over."""
    if quantities and to is not Format.CSV:
        raise typer.BadParameter(f"quantities go with --to csv, found --to {to}")
    if (frames is not None or every or magnify is not None) and to is not Format.VTK:
        raise typer.BadParameter(f"--frames, --all and --magnify go with --to vtk, found --to {to}")
    if magnify is not None and not isfinite(magnify):
        raise typer.BadParameter(f"--magnify: expected a number, found {magnify}")
    if frames is not None and every:
        raise typer.BadParameter("expected one of --frames and --all")


def _instant(
    to: Format,
    at: str | None,
    bodies: list[str] | None,
    start: float | None,
    end: float | None,
) -> "float | Literal['worst']":
    """The time of loads [s], or "worst"."""
    if to not in (Format.ABAQUS, Format.NASTRAN):
        if at is not None or bodies:
            raise typer.BadParameter(f"--at and --body go with --to abaqus or nastran, found {to}")
    elif start is not None or end is not None:
        raise typer.BadParameter("loads are those of an instant: --at, not --from and --until")
    return time_or_worst(at)


def _write_vtk(
    read: "Results",
    folder: Path,
    stem: str,
    rows: slice,
    most: int | None,
    every: bool,
    magnify: float | None,
) -> tuple[Path, ...]:
    from ...results import write_vtk
    from ...results.steps import evenly

    there = rows.stop - rows.start
    steps = evenly(read.time, rows, there if every else most or MOST)
    if len(steps) < there and most is None:
        typer.echo(f"{len(steps)} of {there} steps, evenly over time: --frames or --all for more")
    return write_vtk(read, folder, stem, steps, 1.0 if magnify is None else magnify)
