"""`duhamel init`: what a project starts with."""

import os
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from ..failures import errors_in_one_line, one_line
from .schema import schema_of

if TYPE_CHECKING:
    from ..starters import StarterKind

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
    tell_next(starter, target)


def tell_next(kind: "StarterKind", folder: Path) -> None:
    """What to do in a project that was just made: the first commands of its README."""
    from .. import starters

    typer.echo(one_line(f"{folder}: a project, with README.md. Next:"))
    typer.echo(one_line(f"  cd {shell_word(folder)}"))
    for command in starters.commands(kind)[:3]:
        typer.echo(f"  {command}")


def shell_word(path: Path) -> str:
    """A path as the shell of the system takes it in one piece."""
    text = str(path)
    if os.name == "nt":
        return f'"{text}"' if " " in text else text
    return shlex.quote(text)
