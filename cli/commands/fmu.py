"""`duhamel fmu`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..arguments import ModelFile, beside, output_option
from ..failures import errors_in_one_line, one_line

if TYPE_CHECKING:
    from ...fmu import ExportedModel

FMUOutput = Annotated[Path | None, output_option("MODEL.fmu")]
OutputNames = Annotated[
    list[str] | None,
    typer.Option(
        "--quantity",
        metavar="NAME",
        help="An output, as joints/elbow/angle; stars stand for anything. Unless given those that "
        "the model file requests, or of joints, motors, sensors and energies.",
    ),
]
Parameters = Annotated[
    list[str] | None,
    typer.Option(
        "--parameter",
        metavar="NAME",
        help="What importers may change, as motors/elbow/stiffness, joints/elbow/static_friction "
        "or gravity.",
    ),
]
Communication = Annotated[
    float | None,
    typer.Option(
        metavar="SECONDS", help="The step of importers, of which the internal one is a fraction."
    ),
]
PlatformNames = Annotated[
    list[str] | None,
    typer.Option(
        "--platform",
        metavar="NAME",
        help="x86_64-linux, aarch64-linux, x86_64-windows or aarch64-darwin; several, also as "
        "a,b. That of this machine unless given.",
    ),
]
FMIVersion = Annotated[int, typer.Option("--fmi", metavar="3|2", help="The version of FMI.")]
Processor = Annotated[
    str, typer.Option("--cpu", metavar="NAME", help="x86-64-v3, x86-64-v2 or native.")
]


def fmu(
    model_file: ModelFile,
    output: FMUOutput = None,
    quantities: OutputNames = None,
    parameters: Parameters = None,
    communication: Communication = None,
    platforms: PlatformNames = None,
    version: FMIVersion = 3,
    processor: Processor = "x86-64-v3",
) -> None:
    """A model as an FMU that other tools step without Python: MODEL.fmu, unless given."""
    from ... import files, fmu, solver, superelement

    target = output or beside(model_file, ".fmu")
    with errors_in_one_line(files, solver, superelement, fmu, about=model_file):
        made = fmu.export_fmu(
            solver.read_model(model_file),
            target,
            outputs=quantities or (),
            parameters=parameters or (),
            communication=communication,
            platforms=[name for given in platforms or () for name in given.split(",")],
            version=version,
            cpu=processor,
        )
        # After the file: where steps fail, it is there to be looked at.
        times = made.times()
    _tell(made)
    if times is not None:
        step = made.experiment.step
        median, most, longest = (1e6 * t for t in (times.median, times.most, times.longest))
        typer.echo(
            f"  a step of {1e6 * step:.4g} us takes {median:.3g} us here; 99.9 % of {times.n} take "
            f"at most {most:.3g} us, the longest {longest:.3g} us"
        )


def _tell(made: "ExportedModel") -> None:
    for note in made.notes:
        typer.echo(one_line(f"note: {note}"), err=True)
    # The time is a variable too, of which nothing is told.
    outputs = sum(one.is_output for one in made.variables)
    parameters = len(made.variables) - outputs - len(made.inputs) - 1
    typer.echo(
        one_line(
            f"{made.path}: FMI {made.version}, {made.path.stat().st_size / 1e3:.0f} kB: "
            f"{len(made.inputs)} inputs, {outputs} outputs, {parameters} parameters"
        )
    )
    for one in made.inputs:
        unit = f" [{one.unit}]" if one.unit else ""
        typer.echo(one_line(f"  input {one.name}{unit}, {one.start:g} at the start"))
    for name, size in made.sizes.items():
        typer.echo(f"  {name}: {size / 1e3:.0f} kB")
