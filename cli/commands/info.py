"""`duhamel info`."""

from pathlib import Path
from typing import Annotated

import typer

from ..arguments import HDF5
from ..completion import files as files_of
from ..failures import errors_in_one_line

SuperelementFile = Annotated[
    Path,
    typer.Argument(metavar="FILE.h5", help="A superelement.", autocompletion=files_of(*HDF5)),
]


def info(file: SuperelementFile) -> None:
    """Show what a superelement holds."""
    from rich.console import Console

    from ... import superelement
    from ..description import describe

    with errors_in_one_line(superelement):
        element = superelement.read(file)
    Console().print(describe(element))
