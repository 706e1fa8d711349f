"""`duhamel info`."""

from pathlib import Path
from typing import Annotated

from ..arguments import HDF5_SUFFIXES, file_argument
from ..call import AsJson, give_record
from ..failures import errors_in_one_line

SuperelementFile = Annotated[Path, file_argument("FILE.h5", "A superelement.", *HDF5_SUFFIXES)]


def info(file: SuperelementFile, as_json: AsJson = False) -> None:
    """Show what a superelement holds."""
    from rich.console import Console

    from ... import superelement
    from ..description import describe
    from ..records import superelement_record

    with errors_in_one_line(superelement):
        element = superelement.read(file)
    give_record(superelement_record(file, element))
    Console().print(describe(element))
