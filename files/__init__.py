"""Files of others, opened with care, and files of our own, written whole and over no input."""

from .outputs import OverwriteError, renamed_when_whole, require_no_input
from .regular import FileError, require_regular

__all__ = [
    "FileError",
    "OverwriteError",
    "renamed_when_whole",
    "require_no_input",
    "require_regular",
]
