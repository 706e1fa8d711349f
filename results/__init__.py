"""The results of a run: the contract between the solver, which writes them, and their readers."""

from .errors import QuantityError, RecoveryError, ResultsError
from .results import Results

__all__ = ["QuantityError", "RecoveryError", "Results", "ResultsError"]
