"""The results of a run: the contract between the solver, which writes them, and their readers.

`series` has what is made of time series, measured ones too: shock spectra, filters, densities;
`peaks` makes tables of the peaks of quantities.
"""

from . import series
from .errors import QuantityError, RecoveryError, ResultsError, SeriesError, SeriesWarning
from .peaks import Peak, peaks
from .results import Results
from .space import Connection

__all__ = [
    "Connection",
    "Peak",
    "QuantityError",
    "RecoveryError",
    "Results",
    "ResultsError",
    "SeriesError",
    "SeriesWarning",
    "peaks",
    "series",
]
