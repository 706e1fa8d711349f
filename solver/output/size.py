"""The size of results, known before a run."""

import math
import shutil
from pathlib import Path

from ...files.memory import gigabytes, shortage
from ...results.contents import Contents
from ...results.file import chunks
from ..errors import ModelError

BYTES_OF_NUMBER = 8
# 16 MiB: to ask what is free takes as long as a hundred steps.
UNCHECKED_RESULT_BYTES = 1 << 24


def row_numbers(contents: Contents) -> int:
    """Numbers in the results of one recorded step."""
    return sum(math.prod(quantity.shape(contents.axes)) for quantity in contents.quantities)


def file_bytes(contents: Contents, rows: int) -> int:
    """Bytes of so many rows in a file, which keeps whole chunks."""
    size = 0
    for quantity in contents.quantities:
        shape = quantity.shape(contents.axes)
        # -(-n // chunk) rounds up: HDF5 stores the last chunk whole.
        whole = zip((rows, *shape), chunks(shape, rows), strict=True)
        size += BYTES_OF_NUMBER * math.prod(-(-n // chunk) * chunk for n, chunk in whole)
    return size


def check_memory(contents: Contents, rows: int) -> None:
    """`ModelError` for results that memory cannot hold."""
    size = BYTES_OF_NUMBER * row_numbers(contents) * rows
    if size > UNCHECKED_RESULT_BYTES and (lacking := shortage(size)):
        raise ModelError(
            f"output: results of {rows} steps with {row_numbers(contents)} numbers each {lacking}: "
            "record fewer by `every` and `quantities`, or write them to a file"
        )


def lack_of_disk(path: Path, contents: Contents, rows: int) -> str:
    """A message that the disk cannot hold the results; "" if it can."""
    size, free = file_bytes(contents, rows), shutil.disk_usage(path.parent).free
    if size <= free:
        return ""
    return (
        f"results of {rows} steps need {gigabytes(size)}, the disk has {gigabytes(free)}: "
        "record fewer by `every` and `quantities`"
    )
