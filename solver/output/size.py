"""The size of results, known before a run."""

import math
import shutil
from pathlib import Path

from ...files.memory import gigabytes, shortage
from ...results.schema import Contents
from ..errors import ModelError

NUMBER = 8
"""bytes"""


def row_bytes(contents: Contents) -> int:
    """Bytes of the results of one recorded step."""
    shapes = (quantity.shape(contents.axes) for quantity in contents.quantities)
    return NUMBER * sum(math.prod(shape) for shape in shapes)


def check_size(path: Path | None, contents: Contents, rows: int) -> None:
    """`ModelError` for results that the disk of the file, or without a file memory, cannot hold."""
    size = row_bytes(contents) * rows
    if path is None:
        lacking = shortage(size)
    else:
        free = shutil.disk_usage(path.parent).free
        lacking = f"need {gigabytes(size)}, the disk has {gigabytes(free)}" if size > free else ""
    if lacking:
        raise ModelError(
            f"output: results of {rows} steps with {size // (rows * NUMBER)} numbers each "
            f"{lacking}: record fewer by `every` and `quantities`"
        )
