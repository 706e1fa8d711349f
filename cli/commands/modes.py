"""`duhamel modes`."""

from typing import Annotated

import typer

from ..arguments import ModelFile
from ..call import AsJson, give_record
from ..failures import errors_in_one_line, one_line
from ..linear import (
    LinearOutput,
    linear_title,
    tell_validity,
    write_output,
)

USUAL_MODES = 12
MostModes = Annotated[
    int | None,
    typer.Option(
        "-n",
        "--modes",
        min=1,
        max=10_000,
        help=f"How many; unless given the first {USUAL_MODES}, as far as superelements are right.",
    ),
]
Spin = Annotated[
    float | None,
    typer.Option(
        "--spin", help="The spin of a rotor on bearings in rad/s; its modes are those in space."
    ),
]


def modes(
    model_file: ModelFile,
    n: MostModes = None,
    spin: Spin = None,
    output: LinearOutput = None,
    as_json: AsJson = False,
) -> None:
    """Modes of a model about its equilibrium: frequencies, damping, and shapes as a picture."""
    from rich.console import Console

    from ... import files, solver, superelement, view
    from ..linear_report import modes_csv, modes_picture, modes_table
    from ..records import modes_record

    with errors_in_one_line(files, solver, superelement, view):
        if output is not None:
            files.require_no_input(output, [model_file], "the model file")
        model = solver.read_model(model_file)
        linear = solver.linearize(model) if spin is None else solver.rotor_at(model, spin)
        found = linear.modes(n or USUAL_MODES)
        title = linear_title(model_file, linear.spin)
        validity = linear.validity(found)
        left = ""
        if n is None and validity.values("linear_band") and validity.warnings:
            band = min(body.superelement.band for body in model.flexible_bodies.values())
            within = int((found.frequencies <= band).sum())
            if 0 < within < len(found.frequencies):
                left = (
                    f"left out: {len(found.frequencies) - within} of the first {USUAL_MODES} modes "
                    f"are above {band:.5g} Hz, up to which superelements are right (-n shows them)"
                )
                found = linear.modes(within)
                validity = linear.validity(found)
        give_record(modes_record(model_file, linear.spin, found, validity))
        Console().print(modes_table(title, found))
        if left:
            typer.echo(one_line(left))
        tell_validity(model, validity)
        if output is not None:
            write_output(output, modes_csv(found), lambda: modes_picture(title, linear, found))
