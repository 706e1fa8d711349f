"""What can go wrong before the cases of a study run; what goes wrong in a case is told of that
case.
"""


class StudyError(ValueError):
    """A study file, a table of cases or a base file at fault; the message names the file and the
    key.
    """


class ClusterError(RuntimeError):
    """Dask is not installed, or its scheduler or workers cannot be reached."""
