"""The exceptions of results, one per kind of failure."""


class ResultsError(ValueError):
    """A results file that cannot be written or read, or that another run has taken over."""


class RecoveryError(ValueError):
    """A field that results cannot give.

    No modes on the surface, another superelement, or a time outside the run.
    """


class QuantityError(LookupError):
    """A quantity, body, frame or joint that results do not have; the message lists theirs."""


class ExportError(ValueError):
    """Results that cannot be written in the format of another program, or need a package for it."""


class SeriesError(ValueError):
    """A time series of which a spectrum, filter or peak cannot be made as asked for."""


class SeriesWarning(UserWarning):
    """A time series of which a spectrum says less than it seems to."""
