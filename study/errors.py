"""Failures before the cases of a study run; a failure in a case stands in its row."""


class StudyError(ValueError):
    """A study file, a table of cases or a base file at fault; the message names file and key."""


class ClusterError(RuntimeError):
    """Dask is not installed, or its scheduler or workers cannot be reached."""
