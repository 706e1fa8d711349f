"""The exceptions of pictures, one per kind of failure."""

from collections.abc import Iterable
from pathlib import Path

from ..results import QuantityError, ResultsError, SeriesError, SeriesWarning

__all__ = [
    "PictureError",
    "PictureWarning",
    "QuantityError",
    "ResultsError",
    "SeriesError",
    "SeriesWarning",
]


class PictureError(ValueError):
    """A picture that cannot be written; the message names the file."""


class PictureWarning(UserWarning):
    """What is not in a picture that was asked for."""


def require_target(path: Path, suffixes: Iterable[str]) -> str:
    """The suffix of a file that is to be written; `PictureError` if it is none of these, or where
    there is no folder for it.
    """
    if (suffix := path.suffix.lower()) not in suffixes:
        expected = ", ".join(suffixes)
        raise PictureError(f"{path}: expected a suffix of {expected}, found {path.suffix!r}")
    if not path.parent.is_dir():
        raise PictureError(f"{path}: no folder {path.parent}")
    return suffix
