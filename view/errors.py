"""What can go wrong, one exception per kind of failure."""


class ResultsError(ValueError):
    """A results file that cannot be read; the message names the file, the dataset, and what was
    found.
    """


class QuantityError(LookupError):
    """A quantity, body, frame or joint that a results file does not have; the message lists those
    it has.
    """


class PictureError(ValueError):
    """A picture that cannot be written; the message names the file."""
