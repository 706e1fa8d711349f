"""One model or body for many values of its parameters."""

from .case import Case
from .errors import ClusterError, StudyError
from .fit import fit
from .model_fit import FittedParameter, ModelFit
from .sensitivity import Sensitivities, SeriesDerivative, sensitivities, sensitivities_of
from .study_file import Study, read_study, study_schema
from .summary import Row, Summary, read_summary
from .sweep import sweep

__all__ = [
    "Case",
    "ClusterError",
    "FittedParameter",
    "ModelFit",
    "Row",
    "Sensitivities",
    "SeriesDerivative",
    "Study",
    "StudyError",
    "Summary",
    "fit",
    "read_study",
    "read_summary",
    "sensitivities",
    "sensitivities_of",
    "study_schema",
    "sweep",
]
