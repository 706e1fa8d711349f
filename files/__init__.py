"""Files of others, opened with care, and files of our own, written whole and over no input."""

from .columns import write_rows
from .outputs import OverwriteError, object_and_path, renamed_when_whole, require_no_input
from .regular import FileError, in_one_line, require_regular

__all__ = [
    "FileError",
    "OverwriteError",
    "in_one_line",
    "object_and_path",
    "renamed_when_whole",
    "require_no_input",
    "require_regular",
    "write_rows",
]
