"""Files of matrices and nodes with wrong bytes: one error, whatever a reader stumbles over."""

import codecs
import struct
import warnings
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from ...files import hdf5, in_one_line
from ...files.memory import shortage
from ...superelement.validation import Array
from ..errors import MatrixError, about
from ..mesh.mesh import IntArray
from ..mesh.numbering import is_whole

# Exceptions of numpy, scipy and zipfile.
MATRIX_DAMAGE = (
    *hdf5.DAMAGE_ERRORS,
    MemoryError,
    AttributeError,
    EOFError,
    struct.error,
    zipfile.BadZipFile,
    zlib.error,
)
BYTES_AT_ONCE = 1 << 24


def about_matrices(path: Path, what: str) -> AbstractContextManager[None]:
    """Errors name the file of `what`, which must be a regular one."""
    return about(path, MatrixError, f"file of {what}", f"expected {what}", MATRIX_DAMAGE)


@contextmanager
def arrays(path: Path, what: str) -> Iterator[None]:
    """For reading a .npz file, whose arrays must fit into memory; errors say what was expected."""
    try:
        with zipfile.ZipFile(path) as archive:
            # A small archive may unpack to more than the machine has; its directory says so before.
            if why := shortage(sum(entry.file_size for entry in archive.infolist())):
                raise MatrixError(f"{what} {why}")
        yield
    except MatrixError:
        raise
    except MATRIX_DAMAGE as error:
        raise MatrixError(f"expected {what}: {in_one_line(error)}") from error


def load_rows(source: Any, **form: Any) -> Array:
    """`numpy.loadtxt` of a table (n, k), without a warning where there are no rows."""
    with warnings.catch_warnings():
        # An empty table is an error with a message of its own, where it is used.
        warnings.simplefilter("ignore", UserWarning)
        return np.loadtxt(source, ndmin=2, **form)


def whole_numbers(values: Array, what: str) -> IntArray:
    """Numbers that must be whole, and exact as floats."""
    if not (whole := is_whole(values)).all():
        raise MatrixError(f"expected integers for {what}, found {values[~whole].flat[0]}")
    return np.asarray(values.astype(np.int64))


def require_text(path: Path) -> None:
    """`MatrixError` for bytes that are not UTF-8, or NUL."""
    decoder = codecs.getincrementaldecoder("utf-8")()
    try:
        with path.open("rb") as file:
            while block := file.read(BYTES_AT_ONCE):
                if b"\0" in block:
                    raise MatrixError("expected a file of text, found a byte NUL")
                decoder.decode(block)
        decoder.decode(b"", final=True)
    except UnicodeDecodeError as error:
        raise MatrixError(f"expected a file of text in UTF-8: {error}") from error
