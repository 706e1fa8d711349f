"""The exceptions of pictures, one per kind of failure."""

from ..results import QuantityError, ResultsError

__all__ = ["PictureError", "QuantityError", "ResultsError"]


class PictureError(ValueError):
    """A picture that cannot be written; the message names the file."""
