"""`duhamel modes`, `duhamel frf` and `duhamel campbell`."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from .arguments import ModelFile
from .failures import errors_in_one_line, one_line

WELL_WITHIN = 0.75
"""of the band of a superelement: there a response needs no remark"""

LinearOutput = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        metavar="FILE",
        help="A picture, or a table: FILE.csv.",
        show_default=False,
    ),
]
From = Annotated[
    list[str],
    typer.Option(
        "--from", metavar="INPUT", help="load:1, force:FRAME:y, torque:BODY:z, drive:JOINT, ..."
    ),
]
To = Annotated[list[str], typer.Option("--to", metavar="QUANTITY", help="As `plot` names them.")]
Band = Annotated[
    tuple[float, float] | None,
    typer.Option(metavar="FROM TO", help="Frequencies [Hz].", show_default=False),
]
Points = Annotated[
    int, typer.Option(min=2, max=100_000, help="Frequencies of the band, beside resonances.")
]
Deforming = Annotated[
    list[str] | None,
    typer.Option(
        "--bodies",
        metavar="dynamic|static|rigid",
        help="How flexible bodies deform; several are drawn together.",
        show_default="dynamic",
    ),
]
Static = Annotated[bool, typer.Option("--static", help="Static influence coefficients instead.")]
ModeCount = Annotated[int, typer.Option("-n", "--modes", min=1, max=10_000, help="How many.")]
Spins = Annotated[
    tuple[float, float, int],
    typer.Option("--spin", metavar="FROM TO COUNT", help="Speeds in rad/s."),
]
Orders = Annotated[
    str, typer.Option(metavar="ORDER,ORDER", help="Engine orders: times a revolution.")
]


def modes(model_file: ModelFile, n: ModeCount = 12, output: LinearOutput = None) -> None:
    """Modes of a model about its equilibrium: frequencies, damping, and shapes as a picture."""
    from rich.console import Console

    from .. import solver, superelement, view
    from .linear_report import modes_csv, modes_picture, modes_table

    with errors_in_one_line(solver, superelement, view):
        _require_no_model(output, model_file)
        model = solver.read_model(model_file)
        linear = solver.linearize(model)
        found = linear.modes(n)
        title = _linear_title(model_file, linear.spin)
        Console().print(modes_table(title, found))
        _tell_validity(model, linear.validity(found))
        if output is not None:
            _write(output, modes_csv(found), lambda: modes_picture(title, linear, found))


def frf(
    model_file: ModelFile,
    inputs: From,
    outputs: To,
    band: Band = None,
    points: Points = 400,
    bodies: Deforming = None,
    static: Static = False,
    output: LinearOutput = None,
) -> None:
    """Frequency responses of a model: MODEL-frf.png beside the model file, unless given."""
    from rich.console import Console

    from .. import solver, superelement, view
    from .linear_report import band_of, grid, response_csv, response_picture, static_table

    target = output or model_file.with_name(f"{model_file.stem}-frf.png")
    with errors_in_one_line(solver, superelement, view):
        _require_no_model(target, model_file)
        model = solver.read_model(model_file)
        linear = solver.linearize(model)
        if static:
            response = linear.static(inputs, outputs)
            Console().print(static_table(response))
            _tell_validity(model, linear.validity())
            if output is not None:
                _write(output, response_csv({"": response}), None)
            return
        if band is not None and not 0.0 < band[0] < band[1] < float("inf"):
            raise typer.BadParameter(f"--band: expected 0 < FROM < TO, found {band[0]} {band[1]}")
        known = linear.known_modes()
        if band is None and known is None:
            raise typer.BadParameter("--band: needed where a body is known by a kernel alone")
        bands = [body.superelement.kernel.band for body in model.flexible_bodies.values()]
        limit = min((WELL_WITHIN * width for width in bands if width), default=float("inf"))
        frequencies = grid(band or band_of(known, limit), points, known)  # type: ignore[arg-type]
        kinds = bodies or ["dynamic"]
        responses = {
            f", {kind}" if len(kinds) > 1 else "": linear.frf(inputs, outputs, frequencies, kind)  # type: ignore[arg-type]
            for kind in kinds
        }
        _tell_validity(model, linear.validity(None, frequencies))
        title = _linear_title(model_file, linear.spin)
        _write(target, response_csv(responses), lambda: response_picture(title, responses))


def campbell(
    model_file: ModelFile,
    spin: Spins,
    n: ModeCount = 8,
    orders: Orders = "1",
    output: LinearOutput = None,
) -> None:
    """Frequencies over the spin: MODEL-campbell.png beside the model file, unless given.

    About the axis and the center of the steady_rotation of the model.
    """
    import numpy as np
    from rich.console import Console

    from .. import solver, superelement, view
    from .linear_report import campbell_picture, campbell_rows, campbell_tables, crossing_lines

    target = output or model_file.with_name(f"{model_file.stem}-campbell.png")
    try:
        wanted = [float(order) for order in orders.split(",") if order.strip()]
    except ValueError as error:
        raise typer.BadParameter(f"--orders: expected numbers, found {orders!r}") from error
    first, last, count = spin
    if not 0.0 <= first < last < float("inf") or count < 2:
        raise typer.BadParameter("--spin: expected 0 <= FROM < TO and COUNT >= 2")
    with errors_in_one_line(solver, superelement, view):
        _require_no_model(target, model_file)
        model = solver.read_model(model_file)
        spins = np.linspace(first, last, count).tolist()
        diagram = solver.campbell(model, spins, n, progress=True)
        for table in campbell_tables(model_file.stem, diagram):
            Console().print(table)
        for line in crossing_lines(diagram, wanted):
            typer.echo(one_line(line))
        _tell_validity(model, diagram.validity)
        _write(
            target,
            campbell_rows(diagram),
            lambda: campbell_picture(model_file.stem, diagram, wanted),
        )


def _tell_validity(model: Any, validity: Any) -> None:
    """The table of validity where bodies deform, and a line on stderr for each limit passed.

    Before it, as in runs, a line for each body whose moduli are given at a frequency.
    """
    from ..solver import given_moduli

    for line in given_moduli(model):
        typer.echo(one_line(line))
    if validity.checks:
        typer.echo(str(validity))
    for warning in validity.warnings:
        typer.echo(one_line(f"warning: {model.path}: {warning}"), err=True)


def _linear_title(model_file: Path, spin: float) -> str:
    return f"{model_file.stem}, at {spin:.6g} rad/s" if spin else model_file.stem


def _require_no_model(target: Path | None, model_file: Path) -> None:
    from .. import view
    from ..files.outputs import clash

    if target is not None and (found := clash([target], {model_file: "the model file"})):
        raise view.PictureError(f"{found}, which the output would replace")


def _write(target: Path, rows: list[list[str]], picture: Callable[[], Any] | None) -> None:
    """A table where the suffix is .csv, else a picture."""
    from .. import files, view
    from ..files.outputs import in_words

    if target.suffix.lower() == ".csv":
        try:
            files.write_rows(target, rows)
        except OSError as error:
            raise view.PictureError(f"{target}: cannot be written: {in_words(error)}") from error
    elif picture is None:
        raise view.PictureError(f"{target}: expected a table, .csv")
    else:
        view.save(picture(), target)
    typer.echo(one_line(target))
