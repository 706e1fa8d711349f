"""`duhamel schema`: what editors know of TOML files."""

from typing import Annotated, Any, Literal

import typer

FileKind = Annotated[
    Literal["body", "tested", "model", "study"],
    typer.Argument(
        metavar="body|tested|model|study",
        help="Of which files; tested: body files of parts that are known from their test alone.",
    ),
]


def schema(of: FileKind) -> None:
    """Print the JSON schema of body, model or study files: editors complete and check by it.

    Editors with Taplo (Even Better TOML) take it from the first line of a file,
    `#:schema PATH-OR-ADDRESS`.
    """
    import json

    typer.echo(json.dumps(schema_of(of), indent=2))


def schema_of(kind: str) -> dict[str, Any]:
    """The JSON schema of body, model or study files."""
    if kind in ("body", "tested"):
        from ...preprocess import body_schema

        return body_schema(tested=kind == "tested")
    if kind == "model":
        from ...solver import model_schema

        return model_schema()
    from ...study import study_schema

    return study_schema()
