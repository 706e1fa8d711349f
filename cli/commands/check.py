"""`duhamel check`."""

from pathlib import Path
from typing import Annotated

import typer

from ..arguments import HDF5_SUFFIXES, TOML_SUFFIX, file_argument, results_of
from ..call import AsJson, give_record
from ..completion import files as files_of
from ..failures import errors_in_one_line, one_line, tell_error, tell_warning

CheckedFile = Annotated[
    Path,
    file_argument("FILE", "A superelement or a model, by its suffix.", *HDF5_SUFFIXES, TOML_SUFFIX),
]
CheckedBody = Annotated[
    Path | None,
    typer.Option(
        "--body",
        metavar="BODY.toml",
        help="The body file of a superelement, whose mesh its static solution is compared with.",
        autocompletion=files_of(TOML_SUFFIX),
    ),
]


def check(file: CheckedFile, body: CheckedBody = None, as_json: AsJson = False) -> None:
    """Recompute what must hold of a file, and say whether it does; exit with 1 if not.

    The suffix says what the file is: FILE.h5 a superelement, FILE.toml a model. The static
    compliance of a superelement is compared with a static solution of its mesh, where that lies
    beside it. A model is not run: what `run` would refuse is refused, and what it would take is
    told.
    """
    if file.suffix.lower() in HDF5_SUFFIXES:
        _check_superelement(file, body)
    elif file.suffix.lower() == TOML_SUFFIX:
        _check_model(file)
    else:
        raise typer.BadParameter(
            f"{file}: expected a superelement, {' or '.join(HDF5_SUFFIXES)}, "
            f"or a model, {TOML_SUFFIX}"
        )


def _check_model(file: Path) -> None:
    from ... import solver, superelement
    from ..records import model_record

    with errors_in_one_line(solver, superelement):
        checked = solver.check(solver.read_model(file), results_of(file))
    give_record(model_record(file, checked))
    for line in checked.lines():
        typer.echo(one_line(line))
    for warning in checked.warnings:
        tell_warning(f"{file}: {warning}")


def _check_superelement(file: Path, body_file: Path | None) -> None:
    from rich.console import Console

    from ... import preprocess, superelement
    from ...files.progress import Progress, Work
    from ..records import checks_record
    from ..tables import table

    with errors_in_one_line(superelement):
        element = superelement.read(file)
    checks = list(superelement.check(element))
    with errors_in_one_line(preprocess):
        if body_file is None:
            body = preprocess.body_of(element, file.parent)
        else:
            given = preprocess.read_body(body_file)
            body = given if isinstance(given, preprocess.Body) else None
        if body is not None:
            # The only check that reads the mesh: a file that is consistent in itself may be of
            # another one.
            with Progress(Work("static solution of the mesh")):
                checks.append(preprocess.static_check(element, body))
    give_record(checks_record(file, element.name, checks, with_mesh=body is not None))
    rows = [
        (
            one.where,
            one.expected,
            f"{one.found:.2g}",
            f"{one.limit:.2g}",
            "yes" if one.holds else "NO",
        )
        for one in checks
    ]
    Console().print(table(element.name, ("dataset", "expected", "found", "limit", "holds"), rows))
    failed = [one for one in checks if not one.holds]
    for one in failed:
        tell_error(f"{file}: {one}")
    if failed:
        raise typer.Exit(1)
    # A part that is known from its test alone has no mesh to be compared with.
    if body is None and not element.provenance.tested:
        typer.echo(
            one_line(
                f"{file}: not compared with its mesh, which is not beside it as it was: give the "
                "body file with --body"
            )
        )
    typer.echo(one_line(f"{file}: {len(checks)} checks hold"))
