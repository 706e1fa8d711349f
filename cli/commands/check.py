"""`duhamel check`."""

from pathlib import Path
from typing import Annotated

import typer

from ..arguments import HDF5, TOML, results_of
from ..completion import files as files_of
from ..failures import errors_in_one_line, one_line

CheckedFile = Annotated[
    Path,
    typer.Argument(
        metavar="FILE",
        help="A superelement or a model, by its suffix.",
        show_default=False,
        autocompletion=files_of(*HDF5, TOML),
    ),
]
CheckedBody = Annotated[
    Path | None,
    typer.Option(
        "--body",
        metavar="BODY.toml",
        help="The body file of a superelement, whose mesh its static solution is compared with.",
        show_default=False,
        autocompletion=files_of(TOML),
    ),
]


def check(file: CheckedFile, body: CheckedBody = None) -> None:
    """Recompute what must hold of a file, and say whether it does; exit with 1 if not.

    The suffix says what the file is: FILE.h5 a superelement, FILE.toml a model. The static
    compliance of a superelement is compared with a static solution of its mesh, where that lies
    beside it. A model is not run: what `run` would refuse is refused, and what it would take is
    told.
    """
    if file.suffix.lower() in HDF5:
        _check_superelement(file, body)
    elif file.suffix.lower() == TOML:
        _check_model(file)
    else:
        raise typer.BadParameter(
            f"{file}: expected a superelement, {' or '.join(HDF5)}, or a model, {TOML}"
        )


def _check_model(file: Path) -> None:
    from ... import solver, superelement

    with errors_in_one_line(solver, superelement):
        checked = solver.check(solver.read_model(file), results_of(file))
    for line in checked.lines():
        typer.echo(one_line(line))
    for warning in checked.warnings:
        typer.echo(one_line(f"warning: {file}: {warning}"), err=True)


def _check_superelement(file: Path, body_file: Path | None) -> None:
    from rich.console import Console

    from ... import preprocess, superelement
    from ...files.progress import Progress, Work
    from ..checked import checks_table, failures

    with errors_in_one_line(superelement):
        element = superelement.read(file)
    checks = list(superelement.check(element))
    with errors_in_one_line(preprocess):
        if body_file is None:
            body = preprocess.body_of(element, file.parent)
        else:
            body = preprocess.read_body(body_file)
        if body is not None:
            with Progress(Work("static solution of the mesh")):
                checks.append(preprocess.static_check(element, body))
    Console().print(checks_table(element.name, checks))
    failed = failures(checks)
    for line in failed:
        typer.echo(one_line(f"error: {file}: {line}"), err=True)
    if failed:
        raise typer.Exit(1)
    if body is None:
        typer.echo(
            one_line(
                f"{file}: not compared with its mesh, which is not beside it as it was: give the "
                "body file with --body"
            )
        )
    typer.echo(one_line(f"{file}: {len(checks)} checks hold"))
