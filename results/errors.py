"""What can go wrong with results, one exception per kind of failure."""


class ResultsError(ValueError):
    """A results file that cannot be written or read, or that another run has taken over."""


class RecoveryError(ValueError):
    """A field that results cannot give: no modes on the surface, another superelement, a time
    outside the run.
    """


class QuantityError(LookupError):
    """A quantity, body, frame or joint that results do not have; the message lists those they
    have.
    """
