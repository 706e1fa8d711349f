"""`duhamel info`."""

from pathlib import Path
from typing import Annotated

from ..arguments import HDF5_SUFFIXES, file_argument
from ..failures import errors_in_one_line

SuperelementFile = Annotated[Path, file_argument("FILE.h5", "A superelement.", *HDF5_SUFFIXES)]


def info(file: SuperelementFile) -> None:
    """Show what a superelement holds."""
    from rich.console import Console

    from ... import superelement
    from ..description import describe

    with errors_in_one_line(superelement):
        element = superelement.read(file)
    Console().print(describe(element))
