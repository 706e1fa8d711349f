"""`duhamel frf`."""

from typing import Annotated

import typer

from ..arguments import ModelFile, beside
from ..failures import errors_in_one_line
from ..linear import LinearOutput, linear_title, tell_validity, write_output

# Of the band of a superelement: there a response needs no remark.
TRUSTED_BAND_SHARE = 0.75

From = Annotated[
    list[str],
    typer.Option(
        "--from", metavar="INPUT", help="load:1, force:FRAME:y, torque:BODY:z, drive:JOINT, ..."
    ),
]
To = Annotated[list[str], typer.Option("--to", metavar="QUANTITY", help="As `plot` names them.")]
Band = Annotated[
    tuple[float, float] | None, typer.Option(metavar="FROM TO", help="Frequencies [Hz].")
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

    from ... import files, solver, superelement, view
    from ..linear_report import band_of, grid, response_csv, response_picture, static_table

    target = output or beside(model_file, ".png", "frf")
    with errors_in_one_line(files, solver, superelement, view):
        files.require_no_input(target, [model_file], "the model file")
        model = solver.read_model(model_file)
        linear = solver.linearize(model)
        if static:
            response = linear.static(inputs, outputs)
            Console().print(static_table(response))
            tell_validity(model, linear.validity())
            if output is not None:
                write_output(output, response_csv({"": response}), None)
            return
        if band is not None and not 0.0 < band[0] < band[1] < float("inf"):
            raise typer.BadParameter(f"--band: expected 0 < FROM < TO, found {band[0]} {band[1]}")
        known = linear.known_modes()
        if band is None and known is None:
            raise typer.BadParameter("--band: needed where a body is known by a kernel alone")
        bands = [body.superelement.kernel.band for body in model.flexible_bodies.values()]
        limit = min((TRUSTED_BAND_SHARE * width for width in bands if width), default=float("inf"))
        frequencies = grid(band or band_of(known, limit), points, known)  # type: ignore[arg-type]
        kinds = bodies or ["dynamic"]
        responses = {
            f", {kind}" if len(kinds) > 1 else "": linear.frf(inputs, outputs, frequencies, kind)  # type: ignore[arg-type]
            for kind in kinds
        }
        tell_validity(model, linear.validity(None, frequencies))
        title = linear_title(model_file, linear.spin)
        write_output(target, response_csv(responses), lambda: response_picture(title, responses))
