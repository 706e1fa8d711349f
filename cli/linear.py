"""What `duhamel modes`, `frf` and `campbell` have in common."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from .arguments import output_option
from .failures import one_line, tell_warning

LinearOutput = Annotated[Path | None, output_option("FILE", "A picture, or a table: FILE.csv.")]
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
        tell_warning(f"{model.path}: {warning}")


def linear_title(model_file: Path, spin: float) -> str:
    return f"{model_file.stem}, at {spin:.6g} rad/s" if spin else model_file.stem


def write_output(target: Path, rows: list[list[str]], picture: Callable[[], Any] | None) -> None:
    """A table where the suffix is .csv, else a picture."""
    from .. import files, view

    if target.suffix.lower() == ".csv":
        files.write_rows(target, rows, view.PictureError)
    elif picture is None:
        raise view.PictureError(f"{target}: expected a table, .csv")
    else:
        view.save(picture(), target)
    typer.echo(one_line(target))
