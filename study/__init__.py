"""One model or body for many values of its parameters."""

from .case import Case
from .errors import ClusterError, StudyError
from .fit import fit, fit_model
from .model_fit import FittedParameter, ModelFit
from .optimize import optimize, optimize_model
from .optimum import OptimizedConstraint, OptimizedParameter, Optimum
from .parameter import Parameter
from .sensitivity import Sensitivities, SeriesDerivative, sensitivities, sensitivities_of
from .study_file import Study, read_study, study_schema
from .summary import Row, Summary, read_summary
from .sweep import sweep

__all__ = [
    "Case",
    "ClusterError",
    "FittedParameter",
    "ModelFit",
    "OptimizedConstraint",
    "OptimizedParameter",
    "Optimum",
    "Parameter",
    "Row",
    "Sensitivities",
    "SeriesDerivative",
    "Study",
    "StudyError",
    "Summary",
    "fit",
    "fit_model",
    "optimize",
    "optimize_model",
    "read_study",
    "read_summary",
    "sensitivities",
    "sensitivities_of",
    "study_schema",
    "sweep",
]
