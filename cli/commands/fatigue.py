"""`duhamel fatigue`."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..arguments import FromTime, ResultsFile, ToTime, output_option
from ..failures import errors_in_one_line, one_line

if TYPE_CHECKING:
    from ...results import Results
    from ...results.fatigue import DamageField, WoehlerLine

SECONDS_PER_HOUR = 3600.0

Histories = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="QUANTITY",
        help="Histories of one number, as stress:rod.gauge:xx or force:hinge:x, whose unit is that "
        "of --limit.",
    ),
]
StressedBodies = Annotated[
    list[str] | None,
    typer.Option("--body", metavar="NAME", help="Bodies with stresses, of which all points count."),
]
KneeAmplitude = Annotated[
    float, typer.Option("--limit", metavar="PA", help="The amplitude at the knee.")
]
KneeCycles = Annotated[float, typer.Option("--cycles", help="The cycles to failure there.")]
LineSlope = Annotated[float, typer.Option("--slope", help="k of the Woehler line above the knee.")]
RuleName = Annotated[
    str, typer.Option("--rule", help="Miner's rule below it: elementary, haibach or original.")
]
MeanStress = Annotated[
    float, typer.Option("--mean-stress", help="The mean stress sensitivity M, 0: no effect.")
]
CriterionName = Annotated[
    str,
    typer.Option(
        "--criterion", help="Of bodies: normal (critical plane), mises (with a sign) or principal."
    ),
]
DamageFolder = Annotated[
    Path | None, output_option("DIR", "Damage of all points, as tables and for ParaView.")
]


def fatigue(
    results_file: ResultsFile,
    limit: KneeAmplitude,
    quantities: Histories = None,
    bodies: StressedBodies = None,
    cycles: KneeCycles = 1e6,
    slope: LineSlope = 5.0,
    rule: RuleName = "elementary",
    mean_stress: MeanStress = 0.0,
    criterion: CriterionName = "normal",
    start: FromTime = None,
    end: ToTime = None,
    output: DamageFolder = None,
) -> None:
    """Count the rainflow cycles of stresses, and tell how often a run can be repeated.

    The run is taken as one of many repetitions. Needs the extra fatigue (pyLife).
    """
    if not quantities and not bodies:
        raise typer.BadParameter("expected quantities or --body, found none")
    if output is not None and not bodies:
        raise typer.BadParameter("-o: expected with --body, found no body")
    from rich.console import Console

    from ... import files, results
    from ...files.progress import Progress, Work
    from ...results.exports.damage import write_damage
    from ...results.fatigue import WoehlerLine, damage_field
    from ...results.steps import window
    from ..tables import table

    written: list[Path] = []
    with errors_in_one_line(results, files):
        line = WoehlerLine(limit, cycles, slope, rule, mean_stress)  # type: ignore[arg-type]
        read = results.Results.read(results_file)
        rows = window(read.time, start, end)
        time = read.time[rows]
        of_run = float(time[-1] - time[0]) / SECONDS_PER_HOUR
        found = [
            (name, "", value) for name, value in _of_quantities(read, quantities or (), line, rows)
        ]
        for body in bodies or ():
            work = Work(f"damage of {body}", len(read.recoverable(body).points), "points")
            with Progress(work):
                field = damage_field(
                    read,
                    body,
                    line,
                    criterion,  # type: ignore[arg-type]
                    rows,
                    work.advance,
                )
            found.append((body, _place(field), float(field.damage.max())))
            if output is not None:
                written += write_damage(read, field, output, results_file.stem)
    headings = ("what", "where", "damage of a run", "runs to failure", "hours to failure")
    cells = (
        (name, place, f"{value:.4g}", _until_failure(value), _until_failure(value, of_run))
        for name, place, value in found
    )
    Console().print(table(results_file.stem, headings, cells, "ttnnn"))
    for path in written:
        typer.echo(one_line(f"{path}: {path.stat().st_size / 1e6:.3g} MB"))


def _of_quantities(
    read: "Results", quantities: list[str] | tuple[()], line: "WoehlerLine", rows: slice
) -> Iterator[tuple[str, float]]:
    """The damage of each column of quantities over the times of the run."""
    import numpy as np

    from ...results import QuantityError
    from ...results.exports.tables import named_series, of_axes
    from ...results.fatigue import damage

    for quantity in quantities:
        for text, series in named_series(read, quantity):
            # Rainflow of a spectrum would be a number without a meaning.
            if not np.array_equal(series.abscissa, read.time):
                raise QuantityError(f"{text}: expected a quantity over the times of the run")
            columns = series.values.reshape(len(series.values), -1)[rows]
            for name, history in zip(of_axes(text, series), columns.T, strict=True):
                yield name, damage(history, line)


def _place(field: "DamageField") -> str:
    worst = field.worst
    x, y, z = field.points[worst]
    node = "" if field.nodes is None else f"node {field.nodes[worst]} "
    return f"{node}at ({x:.4g}, {y:.4g}, {z:.4g}) m"


def _until_failure(damage: float, of_each: float = 1.0) -> str:
    """How many runs, or what of each, until the damage is 1."""
    return "no damage" if damage == 0.0 else f"{of_each / damage:.4g}"
