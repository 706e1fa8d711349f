"""`duhamel tutorial`: the files of the tutorial."""

from pathlib import Path
from typing import Annotated

import typer

from ..failures import errors_in_one_line
from .init import tell_next
from .schema import schema_of

TutorialFolder = Annotated[Path, typer.Argument(metavar="FOLDER", help="A new or an empty one.")]


def tutorial(folder: TutorialFolder = Path("duhamel-tutorial")) -> None:
    """Write the files of the tutorial: a steel lever, its mesh, and a model that knocks it."""
    from .. import starters

    with errors_in_one_line(starters):
        starters.make("tutorial", folder, {name: schema_of(name) for name in ("body", "model")})
    tell_next("tutorial", folder)
