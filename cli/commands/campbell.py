"""`duhamel campbell`."""

from typing import Annotated

import typer

from ..arguments import ModelFile, beside
from ..failures import errors_in_one_line, one_line
from ..linear import LinearOutput, ModeCount, tell_validity, write_output

Spins = Annotated[
    tuple[float, float, int],
    typer.Option("--spin", metavar="FROM TO COUNT", help="Speeds in rad/s."),
]
Orders = Annotated[
    str, typer.Option(metavar="ORDER,ORDER", help="Engine orders: times a revolution.")
]


def campbell(
    model_file: ModelFile,
    spin: Spins,
    n: ModeCount = 8,
    orders: Orders = "1",
    output: LinearOutput = None,
) -> None:
    """Frequencies over the spin: MODEL-campbell.png beside the model file, unless given.

    About the axis and the center of the steady_rotation of the model, or of its first bearing.
    """
    from rich.console import Console

    from ... import files, solver, superelement, view
    from ..linear_report import (
        campbell_picture,
        campbell_rows,
        campbell_tables,
        crossing_lines,
        threshold_lines,
    )

    target = output or beside(model_file, ".png", "campbell")
    try:
        wanted = [float(order) for order in orders.split(",") if order.strip()]
    except ValueError as error:
        raise typer.BadParameter(f"--orders: expected numbers, found {orders!r}") from error
    spins = spins_of(spin)
    with errors_in_one_line(files, solver, superelement, view):
        files.require_no_input(target, [model_file], "the model file")
        model = solver.read_model(model_file)
        diagram = solver.campbell(model, spins, n, progress=True)
        for table in campbell_tables(model_file.stem, diagram):
            Console().print(table)
        for line in crossing_lines(diagram, wanted):
            typer.echo(one_line(line))
        if model.bearings:
            for line in threshold_lines(model, diagram, n):
                typer.echo(one_line(line))
        tell_validity(model, diagram.validity)
        write_output(
            target,
            campbell_rows(diagram),
            lambda: campbell_picture(model_file.stem, diagram, wanted),
        )


def spins_of(given: tuple[float, float, int]) -> list[float]:
    """The speeds [rad/s] of `--spin`."""
    import numpy as np

    first, last, count = given
    if not 0.0 <= first < last < float("inf") or count < 2:
        raise typer.BadParameter("--spin: expected 0 <= FROM < TO and COUNT >= 2")
    spins: list[float] = np.linspace(first, last, count).tolist()
    return spins
