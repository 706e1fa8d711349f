"""Results as a pandas.DataFrame: a row for each step, a column for each number of a quantity."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from ..errors import ExportError
from ..results import Results
from .tables import named_series, of_axes


def to_pandas(results: Results, quantities: Iterable[str]) -> Any:
    """Quantities as a pandas.DataFrame, with the headings of `write_csv`.

    Its index is the time [s], or the frequency [Hz] where all of them are spectra over the same
    frequencies.

    Raises
    ------
    ExportError
        Without pandas, and for quantities over different times or frequencies.
    QuantityError
        For a quantity that there is not.

    Examples
    --------
    >>> import duhamel as du
    >>> m = du.Mechanism()
    >>> ball = m.add(du.RigidBody(1.0, [0.1, 0.1, 0.1]), name="ball", velocity=[2.0, 0.0, 0.0])
    >>> to_pandas(m.simulate(1.0, step=0.5).results, ["position:ball:x"])  # doctest: +SKIP
              position:ball:x [m]
    time [s]
    0.0                       0.0
    0.5                       1.0
    1.0                       2.0
    """
    try:
        import pandas
    except ImportError as error:
        raise ExportError(f"to_pandas needs {error.name}: pip install pandas") from error
    found = [pair for quantity in quantities for pair in named_series(results, quantity)]
    if not found:
        raise ExportError("to_pandas: expected one or more quantities, found none")
    (_, first), columns = found[0], dict[str, Any]()
    for text, series in found:
        if not np.array_equal(series.abscissa, first.abscissa) or series.base != first.base:
            raise ExportError(
                f"to_pandas: {text} is over other times or frequencies than {found[0][0]}: ask "
                "for it alone"
            )
        values = series.values.reshape(len(series.values), -1)
        names = of_axes(text, series)
        columns |= {f"{n} [{series.unit}]": v for n, v in zip(names, values.T, strict=True)}
    heading = "time [s]" if first.base == "s" else "frequency [Hz]"
    return pandas.DataFrame(columns, index=pandas.Index(first.abscissa, name=heading))
