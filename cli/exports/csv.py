"""Tables: `duhamel export --to csv`."""

from collections.abc import Sequence
from pathlib import Path

from .export import Asked, export_format


@export_format(
    "csv",
    ".csv",
    "tables, of all that was recorded or of the quantities that are named",
    takes=("window", "quantities"),
)
def csv(asked: Asked) -> Sequence[Path]:
    from ...results import write_csv

    return write_csv(asked.results, asked.folder, asked.quantities, asked.rows)
