"""One model or body for many values of its parameters."""

from .case import Case
from .errors import ClusterError, StudyError
from .study_file import Study, read_study
from .summary import Row
from .sweep import sweep

__all__ = ["Case", "ClusterError", "Row", "Study", "StudyError", "read_study", "sweep"]
