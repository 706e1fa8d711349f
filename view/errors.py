"""The exceptions of pictures, one per kind of failure."""

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
