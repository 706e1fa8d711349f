"""`duhamel export`: results for ParaView, tables, MATLAB and decks; matrices of superelements."""

from collections.abc import Sequence
from math import isfinite
from pathlib import Path
from textwrap import fill
from time import perf_counter
from typing import Annotated

import typer

from ..arguments import FromTime, ResultsFile, time_or_worst
from ..exports import (
    EXPORT_OPTIONS,
    EXPORTS,
    SUPERELEMENT_EXPORTS,
    Asked,
    described,
    takers,
)
from ..exports.sid import DEFAULT_MODES
from ..failures import errors_in_one_line, one_line

# Characters: typer takes each line of a docstring as a paragraph of its own.
HELP_WIDTH = 93
FORMAT_NAMES = (*EXPORTS, *SUPERELEMENT_EXPORTS)

Folder = Annotated[
    Path, typer.Argument(metavar="DIR", help="Made if it is not there.", show_default=False)
]
Quantities = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="QUANTITY",
        help=f"For {takers('quantities')}, as velocity:hub:x or 'force:*'; all that was recorded "
        "unless given.",
    ),
]
To = Annotated[
    str,
    typer.Option(
        "--to",
        metavar=f"<{'|'.join(FORMAT_NAMES)}>",
        help="The format, as described above.",
        autocompletion=lambda incomplete: [
            name for name in FORMAT_NAMES if name.startswith(incomplete)
        ],
    ),
]
At = Annotated[
    str | None,
    typer.Option(
        "--at",
        metavar="SECONDS",
        help="The instant of loads, or worst, that of the largest load.",
    ),
]
BodyNames = Annotated[
    list[str] | None,
    typer.Option("--body", metavar="NAME", help="For loads; all flexible bodies unless given."),
]
# --to is the format here.
UntilTime = Annotated[
    float | None, typer.Option("--until", metavar="SECONDS", help="Up to this time.")
]
Frames = Annotated[
    int | None,
    typer.Option(min=1, help=f"Steps for {takers('film')}, evenly over time: 200 unless given."),
]
All = Annotated[bool, typer.Option("--all", help=f"Every recorded step for {takers('film')}.")]
Magnified = Annotated[
    float | None,
    typer.Option(
        "--magnify",
        metavar="NUMBER",
        help=f"Elastic displacements for {takers('film')}, times this.",
    ),
]
ModeCount = Annotated[
    int | None,
    typer.Option(
        "--modes",
        min=0,
        help=f"For {takers('modes')}, the lowest: {DEFAULT_MODES} unless given.",
    ),
]


def export(
    results_file: ResultsFile,
    folder: Folder,
    quantities: Quantities = None,
    to: To = "vtk",
    start: FromTime = None,
    end: UntilTime = None,
    frames: Frames = None,
    every: All = False,
    magnify: Magnified = None,
    at: At = None,
    bodies: BodyNames = None,
    modes: ModeCount = None,
) -> None:
    """Write results, or the matrices of a superelement, for other programs into a folder."""
    _require_sense(
        to,
        {
            "quantities": bool(quantities),
            "window": start is not None or end is not None,
            "film": frames is not None or every or magnify is not None,
            "instant": at is not None or bool(bodies),
            "modes": modes is not None,
        },
    )
    if magnify is not None and not isfinite(magnify):
        raise typer.BadParameter(f"--magnify: expected a number, found {magnify}")
    if frames is not None and every:
        raise typer.BadParameter("expected one of --frames and --all")
    when = time_or_worst(at)
    begin = perf_counter()
    if to in SUPERELEMENT_EXPORTS:
        _tell(_of_superelement(results_file, folder, to, modes), begin)
        return
    from ... import files, results
    from ...files.progress import Progress, Work
    from ...results.steps import window

    with errors_in_one_line(results, files), Progress(Work("writing")):
        read = results.Results.read(results_file)
        for path in folder.glob(f"*{EXPORTS[to].suffix}"):
            files.require_no_input(path, [results_file])
        asked = Asked(
            results=read,
            folder=folder,
            stem=results_file.stem,
            rows=window(read.time, start, end),
            quantities=quantities or (),
            frames=frames,
            every=every,
            magnify=magnify,
            at=when,
            bodies=bodies or (),
        )
        written = EXPORTS[to].write(asked)
    _tell(written, begin)


def _of_superelement(path: Path, folder: Path, to: str, modes: int | None) -> Sequence[Path]:
    """Write a superelement, and say what it has and the format has not."""
    from ... import files, results, superelement

    chosen = SUPERELEMENT_EXPORTS[to]
    with errors_in_one_line(superelement, results, files):
        e = superelement.read(path)
        for ending in chosen.endings:
            files.require_no_input(folder / f"{path.stem}{ending}", [path])
        written = chosen.write(e, folder, path.stem, modes)
    chain = None if e.modes is None else e.modes.chain
    parts = {
        "material damping": chain,
        "[rotation]": e.rotation,
        "loads and sensors": e.channels,
        "[surfaces]": e.surfaces,
        "[recovery]": e.recovery,
    }
    left_out = [n for n, part in parts.items() if part is not None and n not in chosen.keeps]
    if left_out:
        typer.echo(one_line(f"left out: {', '.join(left_out)}"))
    return written


def _tell(written: Sequence[Path], begin: float) -> None:
    for path in written:
        typer.echo(one_line(f"{path}: {path.stat().st_size / 1e6:.3g} MB"))
    files_written = f"{len(written)} file{'s' if len(written) > 1 else ''}"
    typer.echo(one_line(f"{files_written}, {perf_counter() - begin:.1f} s"))


# Typer reads the help of a command from its docstring.
export.__doc__ = f"{export.__doc__}\n\n{fill(described(), HELP_WIDTH)}"


def _require_sense(to: str, given: dict[str, bool]) -> None:
    """Refuse a format that there is not, and what it would pass over."""
    if to not in FORMAT_NAMES:
        raise typer.BadParameter(f"--to: expected one of {', '.join(FORMAT_NAMES)}, found {to!r}")
    taken = EXPORTS[to].takes if to in EXPORTS else SUPERELEMENT_EXPORTS[to].takes
    for option, is_given in given.items():
        if is_given and option not in taken:
            expected = f"{EXPORT_OPTIONS[option]} go with --to {takers(option)}"
            raise typer.BadParameter(f"{expected}, found --to {to}")
