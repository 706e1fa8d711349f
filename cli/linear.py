"""What `duhamel modes`, `frf` and `campbell` have in common."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from .failures import one_line

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
ModeCount = Annotated[int, typer.Option("-n", "--modes", min=1, max=10_000, help="How many.")]


def tell_validity(model: Any, validity: Any) -> None:
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


def linear_title(model_file: Path, spin: float) -> str:
    return f"{model_file.stem}, at {spin:.6g} rad/s" if spin else model_file.stem


def require_no_model(target: Path | None, model_file: Path) -> None:
    from .. import view
    from ..files.outputs import clash

    if target is not None and (found := clash([target], {model_file: "the model file"})):
        raise view.PictureError(f"{found}, which the output would replace")


def write_output(target: Path, rows: list[list[str]], picture: Callable[[], Any] | None) -> None:
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
