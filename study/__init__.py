"""One model or body for many values of its parameters."""

from .case import Case
from .errors import ClusterError, StudyError
from .study_file import Study, read_study, study_schema
from .summary import Row, Summary, read_summary
from .sweep import sweep

__all__ = [
    "Case",
    "ClusterError",
    "Row",
    "Study",
    "StudyError",
    "Summary",
    "read_study",
    "read_summary",
    "study_schema",
    "sweep",
]
