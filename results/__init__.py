"""The results of a run: the contract between the solver, which writes them, and their readers.

`series` has what is made of time series, measured ones too: shock spectra, filters, densities;
`peaks` makes tables of the peaks of quantities. `write_csv`, `write_mat` and `write_vtk` write them
for other programs.
"""

from typing import TYPE_CHECKING

from ..files.lazy import lazily_loaded

if TYPE_CHECKING:
    from . import series
    from .errors import (
        ExportError,
        QuantityError,
        RecoveryError,
        ResultsError,
        SeriesError,
        SeriesWarning,
    )
    from .exports import load_set, write_csv, write_loads, write_mat, write_vtk
    from .peaks import Peak, peaks
    from .results import Results
    from .space import Connection

__all__ = [
    "Connection",
    "ExportError",
    "Peak",
    "QuantityError",
    "RecoveryError",
    "Results",
    "ResultsError",
    "SeriesError",
    "SeriesWarning",
    "load_set",
    "peaks",
    "series",
    "write_csv",
    "write_loads",
    "write_mat",
    "write_vtk",
]

if not TYPE_CHECKING:
    __getattr__, __dir__ = lazily_loaded(
        __name__,
        {
            ".errors": (
                "ExportError QuantityError RecoveryError ResultsError SeriesError SeriesWarning"
            ),
            ".exports": "load_set write_csv write_loads write_mat write_vtk",
            ".peaks": "Peak peaks",
            ".results": "Results",
            ".series": "series",
            ".space": "Connection",
        },
    )
