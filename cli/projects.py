"""`duhamel init` and `duhamel schema`: what a project starts with, and what editors know of it."""

import shlex
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from .failures import errors_in_one_line, one_line

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
FileKind = Annotated[
    Literal["body", "model", "study"],
    typer.Argument(metavar="body|model|study", help="Of which files."),
]


def init(starter: Starter, folder: ProjectFolder = None) -> None:
    """Write a small commented project that runs: body, mesh, model, README, schemas for editors."""
    from . import starters

    target = folder or Path(starter)
    with errors_in_one_line(starters):
        starters.make(starter, target, {name: schema_of(name) for name in ("body", "model")})
    typer.echo(one_line(f"{target}: a project, with README.md. Next:"))
    typer.echo(one_line(f"  cd {shlex.quote(str(target))}"))
    for command in starters.commands(starter)[:3]:
        typer.echo(f"  {command}")


def schema(of: FileKind) -> None:
    """Print the JSON schema of body, model or study files: editors complete and check by it.

    Editors with Taplo (Even Better TOML) take it from the first line of a file,
    `#:schema PATH-OR-ADDRESS`.
    """
    import json

    typer.echo(json.dumps(schema_of(of), indent=2))


def schema_of(kind: str) -> dict[str, Any]:
    """The JSON schema of body, model or study files."""
    if kind == "body":
        from ..preprocess import body_schema

        return body_schema()
    if kind == "model":
        from ..solver import model_schema

        return model_schema()
    from ..study import study_schema

    return study_schema()
