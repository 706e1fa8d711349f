"""`duhamel modes`."""

from typing import Annotated

import typer

from ..arguments import ModelFile
from ..call import AsJson, give_record
from ..failures import errors_in_one_line
from ..linear import (
    LinearOutput,
    ModeCount,
    linear_title,
    tell_validity,
    write_output,
)

Spin = Annotated[
    float | None,
    typer.Option(
        "--spin", help="The spin of a rotor on bearings in rad/s; its modes are those in space."
    ),
]


def modes(
    model_file: ModelFile,
    n: ModeCount = 12,
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
        found = linear.modes(n)
        title = linear_title(model_file, linear.spin)
        validity = linear.validity(found)
        give_record(modes_record(model_file, linear.spin, found, validity))
        Console().print(modes_table(title, found))
        tell_validity(model, validity)
        if output is not None:
            write_output(output, modes_csv(found), lambda: modes_picture(title, linear, found))
