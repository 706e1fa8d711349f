"""`duhamel init`: what a project starts with."""

import shlex
from pathlib import Path
from typing import Annotated, Literal

import typer

from ..failures import errors_in_one_line, one_line
from .schema import schema_of

Starter = Annotated[
    Literal["beam", "solid", "mechanism"],
    typer.Argument(
        metavar="beam|solid|mechanism",
        help="An arm of lines on a motor, a bracket of hexahedra on a shock table, a slider-crank.",
    ),
]
ProjectFolder = Annotated[
    Path | None,
    typer.Argument(
        metavar="FOLDER",
        help="A new or an empty one: named as the starter, unless given.",
        show_default=False,
    ),
]


def init(starter: Starter, folder: ProjectFolder = None) -> None:
    """Write a small commented project that runs: body, mesh, model, README, schemas for editors."""
    from .. import starters

    target = folder or Path(starter)
    with errors_in_one_line(starters):
        starters.make(starter, target, {name: schema_of(name) for name in ("body", "model")})
    typer.echo(one_line(f"{target}: a project, with README.md. Next:"))
    typer.echo(one_line(f"  cd {shlex.quote(str(target))}"))
    for command in starters.commands(starter)[:3]:
        typer.echo(f"  {command}")
