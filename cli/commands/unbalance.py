"""`duhamel unbalance`."""

import cmath
import math
from typing import Annotated

import typer

from ..arguments import ModelFile, beside
from ..failures import errors_in_one_line, one_line
from ..linear import LinearOutput, tell_validity, write_output
from .campbell import Spins, spins_of

Unbalances = Annotated[
    list[str],
    typer.Option(
        metavar="FRAME=U[@DEGREES]",
        help="Mass times eccentricity in kg m at a frame of the shaft, at an angle from e1 to e2.",
    ),
]
ShownPoints = Annotated[
    list[str] | None,
    typer.Option("--to", metavar="FRAME", help="Bodies and frames that are shown.",
                 show_default="those of --at"),
]  # fmt: skip


def unbalance(
    model_file: ModelFile,
    at: Unbalances,
    spin: Spins,
    to: ShownPoints = None,
    output: LinearOutput = None,
) -> None:
    """Orbits of a rotor on bearings by unbalance: MODEL-unbalance.png, unless given."""
    from ... import files, solver, superelement, view
    from ..linear_report import peak_lines, unbalance_picture, unbalance_rows

    target = output or beside(model_file, ".png", "unbalance")
    given: dict[str, complex] = {}
    for name, value in map(_parsed, at):
        # Several masses on one disk act as one.
        given[name] = given.get(name, 0.0) + value
    spins = spins_of(spin)
    with errors_in_one_line(files, solver, superelement, view):
        files.require_no_input(target, [model_file], "the model file")
        model = solver.read_model(model_file)
        # At rest nothing turns, and nothing answers.
        response = solver.unbalance_response(
            model, given, [s for s in spins if s > 0.0], progress=True
        )
        points = to or list(given)
        for line in peak_lines(response, points):
            typer.echo(one_line(line))
        tell_validity(model, solver.rotor_at(model, spins[-1]).validity())
        write_output(
            target,
            unbalance_rows(response, points),
            lambda: unbalance_picture(model_file.stem, response, points),
        )


def _parsed(text: str) -> tuple[str, complex]:
    """A frame and its unbalance, of FRAME=U or FRAME=U@DEGREES."""
    name, _, value = text.partition("=")
    size, _, angle = value.partition("@")
    try:
        found = name, cmath.rect(float(size), math.radians(float(angle or 0.0)))
    except ValueError:
        found = "", complex(math.nan)
    if not name or not cmath.isfinite(found[1]):
        raise typer.BadParameter(f"--at: expected FRAME=U or FRAME=U@DEGREES, found {text!r}")
    return found
